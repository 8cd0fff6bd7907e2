"""What has given way for good under a hardness: how much of the area, how far, and the work it took."""

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    if state.plasticity is None:
        return {}
    indentation = state.plasticity.indentation
    mean = float(np.mean(indentation))
    return {
        "relative_plastic_area": float(np.mean(indentation > 0)),
        "mean_plastic_indentation": mean,
        # A point gives way under the hardness from beginning to end.
        "plastic_work": state.plasticity.hardness * mean,
    }


PLASTICITY = Observable(
    {
        "relative_plastic_area": Variable("1", "area that has given way for good up to this point over nominal area"),
        "mean_plastic_indentation": Variable("m", "mean of what has given way for good up to this point"),
        "plastic_work": Variable("J m-2", "work done at the hardness up to this point per nominal area"),
    },
    _read,
)
