"""Mean pressure, mean distances and contact stiffness of a state, and of the states passed on the way to it."""

import math

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import PASSED, InterfaceState, Observable, Value, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    pressure = float(np.mean(state.pressure))
    values: dict[str, Value] = {
        "mean_pressure": pressure,
        "mean_gap": float(np.mean(state.gap)) - state.equilibrium_distance,
        "mean_separation": state.mean_separation,
    }
    if state.spacing is not None:
        values["total_force"] = pressure * state.pressure.size * math.prod(state.spacing)
    if state.contact_stiffness is not None:
        values["contact_stiffness"] = state.contact_stiffness
    if state.passed is not None:
        values |= {f"passed_{name}": column for name, column in zip(PASSED, state.passed.T, strict=True)}
    return values


MEANS = Observable(
    {
        "mean_pressure": Variable("Pa", "mean normal pressure at the interface, compression positive"),
        "total_force": Variable("N", "mean pressure times the area of the cell, compression positive"),
        "mean_gap": Variable("m", "mean local gap minus the law's equilibrium distance"),
        "mean_separation": Variable(
            "m",
            "distance of the mean planes of block and surface minus the equilibrium distance",
            attrs={"comment": "conjugate to the pressure; layer: plane of its undeformed surface"},
        ),
        "contact_stiffness": Variable(
            "Pa m-1",
            "contact stiffness -dp/du of the linearised problem",
            attrs={"comment": "u: mean gap; free boundaries: position of the undeformed surface"},
        ),
        "passed_pressure": Variable(
            "Pa", "mean pressure of each state passed since the last point; detached: the load", ("step", "passed")
        ),
        "passed_separation": Variable(
            "m", "mean separation of each state passed since the last point; detached: infinite", ("step", "passed")
        ),
        "passed_energy": Variable(
            "J m-2", "elastic and interaction energy per nominal area of each state passed", ("step", "passed")
        ),
    },
    _read,
)
