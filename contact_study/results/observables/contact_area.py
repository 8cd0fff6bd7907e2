"""Shares of the nominal area that are in contact, and that press."""

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, float]:
    return {
        "relative_contact_area": float(np.mean(state.contact)),
        "relative_repulsive_area": float(np.mean(state.pressure > 0)),
    }


CONTACT_AREA = Observable(
    {
        "relative_contact_area": Variable("1", "contact area over nominal area"),
        "relative_repulsive_area": Variable("1", "area under positive pressure over nominal area"),
    },
    _read,
)
