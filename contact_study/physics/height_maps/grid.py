"""Coordinates that a height map brings, and whether they are those of an even grid."""

from pathlib import Path

import numpy as np

from contact_study.inputs.errors import InputError

# Largest distance of a coordinate from its place on an even grid, in steps: what rounded decimals and single
# precision leave, and far less than the height changes over.
_UNEVEN = 0.01
# Grid points for each point given, beyond which points are scattered and no grid with holes.
_SPARSEST = 4


def line_scan(path: Path, points: int) -> InputError:
    """Make the error for a file that holds a line."""
    return InputError(f"surface.path: {path} holds a line scan ({points} points); a map (rows x columns) is needed")


def step_of(path: Path, name: str, values: np.ndarray) -> float:
    """Find the step of evenly spaced coordinates, negative where they decrease; raise InputError for others."""
    step = (values[-1] - values[0]) / (values.size - 1)
    even = values[0] + step * np.arange(values.size)
    if not np.all(np.abs(values - even) <= _UNEVEN * abs(step)) or step == 0:
        lengths = np.abs(np.diff(values))
        raise InputError(
            f"surface.path: the coordinate {name} of {path} is not evenly spaced (steps from "
            f"{lengths.min():.6g} to {lengths.max():.6g}); resample the map on an even grid"
        )
    return float(step)


def gridded(path: Path, points: np.ndarray) -> tuple[np.ndarray, tuple[float, float]]:
    """Arrange points (x, y, height) in any order on their grid, NaN where there is none.

    Returns
    -------
    heights : numpy.ndarray, shape (ny, nx)
    size : tuple of float
        Periods along y and x, points times spacing.

    Raises InputError if the points are not on an even grid, or a place is given twice.
    """
    if len(points) < 4 or not np.all(np.isfinite(points[:, :2])):
        raise InputError(f"surface.path: {path} holds {len(points)} points; expected a grid with finite x and y")
    columns, dx = _places(path, "x", points[:, 0])
    rows, dy = _places(path, "y", points[:, 1])
    shape = (int(rows.max()) + 1, int(columns.max()) + 1)
    if shape[0] * shape[1] > _SPARSEST * len(points):
        raise InputError(
            f"surface.path: the {len(points)} points of {path} are scattered, on no grid; interpolate them onto one"
        )
    if np.unique(rows * shape[1] + columns).size < len(points):
        raise InputError(f"surface.path: {path} holds two heights for one place")
    heights = np.full(shape, np.nan)
    heights[rows, columns] = points[:, 2]
    return heights, (shape[0] * dy, shape[1] * dx)


def _places(path: Path, name: str, values: np.ndarray) -> tuple[np.ndarray, float]:
    """Number of each coordinate along its axis, and the spacing."""
    lowest, reach = float(values.min()), float(np.ptp(values))
    gaps = np.diff(np.unique(values))
    if gaps.size == 0:
        raise InputError(f"surface.path: the points of {path} have one {name} only; expected at least 4")
    gaps = gaps[gaps > 0.1 * np.median(gaps[gaps >= 0.5 * gaps.max()])]  # smaller ones are one place, rounded
    steps = round(reach / float(np.median(gaps)))
    if np.all(gaps < 1.5 * np.median(gaps)):  # no line is missing as a whole: their number is exact
        steps = gaps.size
    spacing = reach / steps
    places = np.rint((values - lowest) / spacing).astype(int)
    off = np.abs(values - lowest - spacing * places).max() / spacing
    if off > _UNEVEN:
        raise InputError(
            f"surface.path: the coordinate {name} of {path} is not evenly spaced (off its place by {off:.2g} of a "
            "step); resample the map on an even grid"
        )
    return places, spacing
