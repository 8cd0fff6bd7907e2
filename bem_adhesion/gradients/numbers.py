"""Numbers of a state with their derivatives by displacement and pressure, and the explicit ones by parameters."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.special import expit

from bem_adhesion.gradients.linearised import LinearisedState
from contact_study.numerics.arguments import field, positive

AREA_WIDTH = 0.05  # of the smoothed contact area, over the law's length


class Number(NamedTuple):
    """A number J: its value, J_u on the solver's grid, J_P, and its explicit derivatives."""

    value: float
    by_displacement: np.ndarray | float = 0.0
    by_pressure: float = 0.0
    heights: np.ndarray | float = 0.0
    work: np.ndarray | float = 0.0
    scale: float = 0.0
    modulus: float = 0.0  # by the logarithm of the modulus, without what K of the waves gives
    bending: float = 0.0  # share of ½<u, K u> in J, for the derivatives by K


def number_of(state: LinearisedState, of: str | np.ndarray, width: float | None = None) -> Number:
    """Return a number of a state, by its name or by its derivative with respect to the gap."""
    if not isinstance(of, str):
        by_gap = field("of", of)
        if by_gap.shape != state.height.shape:
            raise ValueError(f"of: has the shape {by_gap.shape}, the heights {state.height.shape}")
        return _of_gaps(state, np.nan, by_gap)
    if of == "target":
        of = {"pressure": "pressure", "gap": "mean_gap", "approach": "approach"}[state.control]
    if of == "contact_area":
        return _contact_area(state, width)
    if of not in _NUMBERS:
        raise ValueError(f"of = {of!r}: expected one of {', '.join(_NUMBERS)}, contact_area, or dJ/dgap as an array")
    return _NUMBERS[of](state)


def _pressure(state: LinearisedState) -> Number:
    return Number(state.pressure / state.share, by_pressure=1 / state.share)


def _total_force(state: LinearisedState) -> Number:
    return Number(state.pressure / state.share * state.area, by_pressure=state.area / state.share)


def _of_gaps(state: LinearisedState, value: float, by_gap: np.ndarray) -> Number:
    by_displacement = np.zeros(state.grid.shape)
    by_displacement[state.inside] = by_gap
    return Number(value, by_displacement, heights=-by_gap)


def _mean_gap(state: LinearisedState) -> Number:
    found = _of_gaps(state, state.solution.mean_gap, np.full(state.height.shape, 1 / state.height.size))
    return found._replace(scale=-state.law.equilibrium_distance)


def _approach(state: LinearisedState) -> Number:
    mean = float(np.mean(state.solution.displacement))
    if state.solution.plane is not None:
        mean = state.solution.plane + state.pressure * state.solid_compliance
    touch = float(state.height.max()) + state.law.equilibrium_distance
    heights = np.zeros(state.height.shape)
    heights.reshape(-1)[int(np.argmax(state.height))] = 1.0
    return Number(
        touch - mean + state.pressure * state.compliance,
        -1 / state.grid.points,
        state.compliance,
        heights,
        scale=state.law.equilibrium_distance,
        modulus=-state.pressure * state.solid_compliance,
    )


def _elastic_energy(state: LinearisedState) -> Number:
    compression = 0.5 * state.pressure**2 * state.solid_compliance / state.share
    return Number(
        state.solution.elastic_energy,
        state.flexure / (state.grid.points * state.share),
        state.pressure * state.solid_compliance / state.share,
        modulus=-compression,
        bending=1 / state.share,
    )


def _interaction_energy(state: LinearisedState) -> Number:
    if state.law.bare_wall:
        return Number(0.0)
    points = state.height.size
    found = _of_gaps(state, state.solution.interaction_energy, state.traction / points)
    scale = -float(np.mean(state.gap * state.traction))
    if not state.law.attracts:
        return found._replace(scale=scale)
    return found._replace(work=state.law.potential(state.gap) / (state.law.work_of_adhesion * points), scale=scale)


def _contact_area(state: LinearisedState, width: float | None) -> Number:
    if state.law.bare_wall:
        raise ValueError("of = 'contact_area': of a hard wall it changes by jumps of single points")
    width = AREA_WIDTH * state.law.length if width is None else positive("width", width, "m")
    near = expit((state.law.contact_distance - state.gap) / width)
    slope = -near * (1 - near) / width
    found = _of_gaps(state, float(np.mean(near)), slope / state.gap.size)
    # The contact distance follows the law's length, unlike the width.
    return found._replace(scale=-float(np.mean(slope)) * state.law.contact_distance)


def _energy(state: LinearisedState) -> Number:
    sums: list[Any] = [
        one + other for one, other in zip(_elastic_energy(state), _interaction_energy(state), strict=True)
    ]
    return Number(*sums)


_NUMBERS: dict[str, Callable[[LinearisedState], Number]] = {
    "pressure": _pressure,
    "total_force": _total_force,
    "approach": _approach,
    "mean_gap": _mean_gap,
    "elastic_energy": _elastic_energy,
    "interaction_energy": _interaction_energy,
    "energy": _energy,
}
