"""Checks of what a person hands to the solvers from Python: the name of what is wrong, and what it should be."""

import math
from collections.abc import Sequence
from numbers import Real

import numpy as np

from contact_study.fields.grid import Grid


def finite(name: str, value: object, unit: str) -> float:
    """A finite number.

    Raises
    ------
    ValueError
        If it is none; text with a unit is for study files.
    """
    if isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    raise ValueError(f"{name} = {value!r}: must be a finite number, in {unit}")


def positive(name: str, value: object, unit: str) -> float:
    """A positive finite number; raises ValueError otherwise."""
    number = finite(name, value, unit)
    if number <= 0:
        raise ValueError(f"{name} = {value!r}: must be a positive finite number, in {unit}")
    return number


def check_control(
    control: str, tolerance: float, max_iterations: int, controls: Sequence[str] = ("pressure", "gap")
) -> None:
    """Make sure that a solver knows what it is to hold and when to stop; raises ValueError otherwise."""
    if control not in controls:
        raise ValueError(f"control = {control!r}: must be {' or '.join(map(repr, controls))}")
    positive("tolerance", tolerance, "units of the scale that the solver names")
    positive("max_iterations", max_iterations, "iterations")


def check_step(control: str, target: float, state: np.ndarray, shape: tuple[int, ...]) -> None:
    """Make sure that a load step has a finite target and a state of this shape; raises ValueError otherwise."""
    if not np.isfinite(target):
        raise ValueError(f"target = {target:g}: a mean {control} must be finite")
    if state.shape != shape:
        raise ValueError(f"state has shape {state.shape}, this contact needs {shape}")


def field(name: str, values: object) -> np.ndarray:
    """A field (y, x) of finite numbers; raises ValueError otherwise."""
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be an array (y, x) of numbers") from None
    if array.ndim != 2 or not array.size:
        raise ValueError(f"{name} has shape {array.shape}: must be an array (y, x)")
    if not np.all(np.isfinite(array)):
        count = np.count_nonzero(~np.isfinite(array))
        raise ValueError(f"{name} is not finite everywhere: {count} {'point is' if count == 1 else 'points are'} not")
    return array


def grid_of(height: np.ndarray, size: float | Sequence[float]) -> Grid:
    """The periodic grid of a height array.

    Parameters
    ----------
    height : numpy.ndarray, shape (y, x)
        Heights, one a point.
    size : float or pair of float
        Periods along y and x; one number is both (m).

    Raises
    ------
    ValueError
        If a period is not a positive number, or there are not two.
    """
    pair = (size, size) if np.ndim(size) == 0 else tuple(size)  # type: ignore[arg-type]
    if len(pair) != 2:
        raise ValueError(f"size = {size!r}: must be one period or two, along y and x, in m")
    periods = (positive("size", pair[0], "m"), positive("size", pair[1], "m"))
    return Grid((height.shape[0], height.shape[1]), periods)
