"""What is kept of each point of a loading path."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.observables import observed
from contact_study.results.schema import quantity_of
from contact_study.results.state import InterfaceState


@dataclass(frozen=True)
class Step:
    """One finished point of a loading path.

    Attributes
    ----------
    values : mapping
        Quantities under the names of the schema; labels before a name, ``"label/name"``, put theories side by side. A
        theory gives its distributions as functions, from the edges of bins, shape (n + 1,), to the means in them.
    fields : mapping
        Fields over the lateral plane (y, x), and atoms, only where the study asks for them.
    restart : mapping
        All that the next step needs, nothing else.
    bins : Bins or None
        Those of its distributions; the campaign's to set.
    """

    values: Mapping[str, Any]
    fields: Mapping[str, np.ndarray] = field(default_factory=dict)
    restart: Mapping[str, np.ndarray] = field(default_factory=dict)
    bins: Bins | None = None


def recorded(point: InterfaceState | Step, bins: Bins, fields: bool = False) -> Step:
    """What is kept of a point of the path: the observables of a state, every distribution on the bins.

    Parameters
    ----------
    point : InterfaceState or Step
        A simulation's state, or a theory's quantities.
    bins : Bins
        Those of the study.
    fields : bool, optional
        Whether the fields of a state are kept; its atoms are if it has them.
    """
    if isinstance(point, InterfaceState):
        kept = {"gap": point.gap, "pressure": point.pressure} if fields else {}
        if fields and point.plasticity is not None:
            kept["plastic_indentation"] = point.plasticity.indentation
        return Step(observed(point, bins), {**kept, **point.atoms}, point.restart, bins)
    edges = bins.edges_of
    values = {
        key: value(edges[quantity_of(key)[1]]) if callable(value) else value for key, value in point.values.items()
    }
    return replace(point, values=values, bins=bins)
