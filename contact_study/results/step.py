"""A finished point of a loading path, as it goes to disk."""

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
    """A finished point of a loading path.

    Parameters
    ----------
    values : mapping
        Quantities by the keys of the schema, ``"name"`` or ``"label/name"``. A theory gives a distribution as a
        function of the bins' edges, shape (n + 1,), that returns the densities, shape (n,).
    fields : mapping
        Fields over the lateral plane (y, x), and atoms, if the study keeps them.
    restart : mapping
        State that the next step starts from.
    bins : Bins or None
        Bins of its distributions, set by the campaign.
    """

    values: Mapping[str, Any]
    fields: Mapping[str, np.ndarray] = field(default_factory=dict)
    restart: Mapping[str, np.ndarray] = field(default_factory=dict)
    bins: Bins | None = None


def recorded(point: InterfaceState | Step, bins: Bins, fields: bool = False) -> Step:
    """Evaluate the observables of a point, every distribution on the bins.

    Parameters
    ----------
    point : InterfaceState or Step
        State of a simulation, or quantities of theories.
    bins : Bins
        Bins of the study.
    fields : bool, optional
        Whether to keep the fields of a state; its atoms are always kept.
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
