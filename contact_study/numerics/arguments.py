"""Checks of arguments that a person gives the solvers from Python; each message names the argument."""

import math
from collections.abc import Sequence
from numbers import Real
from typing import Any

import numpy as np

from contact_study.numerics.grid import Grid


def finite(name: str, value: object, unit: str) -> float:
    """Return a finite number; raise ValueError otherwise. Text with a unit is for study files."""
    if isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    raise ValueError(f"{name} = {value!r}: must be a finite number, in {unit}")


def positive(name: str, value: object, unit: str) -> float:
    """Return a positive finite number; raise ValueError otherwise."""
    number = finite(name, value, unit)
    if number <= 0:
        raise ValueError(f"{name} = {value!r}: must be a positive finite number, in {unit}")
    return number


def check_control(
    control: str, tolerance: float, max_iterations: int, controls: Sequence[str] = ("pressure", "gap")
) -> None:
    """Raise ValueError unless these can be the control and the limits of a solver."""
    if control not in controls:
        raise ValueError(f"control = {control!r}: must be {' or '.join(map(repr, controls))}")
    positive("tolerance", tolerance, "units of the scale that the solver names")
    positive("max_iterations", max_iterations, "iterations")


def step_arguments(control: str, target: float, state: Any, shape: tuple[int, ...]) -> tuple[np.ndarray, float]:
    """Check the state, an array of a shape or a solution, and the target of a load step, in Pa or m; return both."""
    try:
        number = math.nan if isinstance(target, str | bool) else float(target)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        meant = {"pressure": "mean pressure", "gap": "mean gap"}.get(control, control)
        unit = "Pa" if control == "pressure" else "m"
        raise ValueError(f"target = {target!r}: the {meant} must be a finite number, in {unit}")
    start = getattr(state, "state", state)
    if not isinstance(start, np.ndarray):
        given = "None" if state is None else f"a {type(state).__name__}"
        raise ValueError(f"state is {given}: give contact.separated(), or the solution of an earlier step")
    if start.shape != shape:
        raise ValueError(f"state has shape {start.shape}, this contact needs {shape}")
    return start, number


def field(name: str, values: object) -> np.ndarray:
    """Copy a field (y, x) of finite numbers; raise ValueError otherwise."""
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be an array (y, x) of numbers") from None
    if array.ndim != 2 or not array.size:
        raise ValueError(f"{name} has shape {array.shape}: must be an array (y, x)")
    if not np.all(np.isfinite(array)):
        count = np.count_nonzero(~np.isfinite(array))
        raise ValueError(f"{name} is not finite everywhere: {count} {'point is' if count == 1 else 'points are'} not")
    return array


def grid_of(height: np.ndarray, size: float | Sequence[float]) -> Grid:
    """Make the periodic grid of a height array; ``size`` is one period or two, along y and x (m)."""
    pair = (size, size) if np.ndim(size) == 0 else tuple(size)  # type: ignore[arg-type]
    if len(pair) != 2:
        raise ValueError(f"size = {size!r}: must be one period or two, along y and x, in m")
    periods = (positive("size", pair[0], "m"), positive("size", pair[1], "m"))
    return Grid((height.shape[0], height.shape[1]), periods)
