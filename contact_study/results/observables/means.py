"""Mean pressure and mean distances."""

import math

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, float]:
    found = {
        "mean_pressure": float(np.mean(state.pressure)),
        "mean_gap": float(np.mean(state.gap)) - state.equilibrium_distance,
        "mean_separation": state.mean_separation,
    }
    if state.spacing is not None:
        found["total_force"] = found["mean_pressure"] * state.pressure.size * math.prod(state.spacing)
    return found


MEANS = Observable(
    {
        "mean_pressure": Variable("Pa", "mean normal pressure at the interface, compression positive"),
        "total_force": Variable("N", "mean pressure times the area of the cell, compression positive"),
        "mean_gap": Variable("m", "mean of the local gap, less the law's equilibrium distance"),
        "mean_separation": Variable(
            "m",
            "distance of the mean planes of block and surface, less the equilibrium distance; conjugate to the "
            "pressure. Of a layer the plane of its undeformed surface, which moves with its base",
        ),
    },
    _read,
)
