"""Height maps from files: NetCDF, npy or text, as one array in metres."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.problem import units
from contact_study.problem.errors import InputError

# Largest distance of a coordinate from its place on an even grid, in steps: what rounded decimals and single
# precision leave, and far less than the height changes over.
_UNEVEN = 0.01


@dataclass(frozen=True)
class HeightMap:
    """Heights (y, x) and the lateral size of the cell, both in metres; y and x increase along the axes."""

    heights: np.ndarray
    size: tuple[float, float]

    @property
    def shape(self) -> tuple[int, int]:
        """Points along y and x."""
        return self.heights.shape[0], self.heights.shape[1]


def read_height_map(path: Path, height_unit: str | None, size: tuple[float, float] | None) -> HeightMap:
    """Read a height map.

    Parameters
    ----------
    path : pathlib.Path
        ``.nc`` (variable ``height``, or the only two-dimensional one), ``.npy``, or a text table. The axes of a
        NetCDF variable are told by their names ``y`` and ``x`` (or the attribute ``axis`` of their coordinates), in
        whatever order and direction; those of all else are (y, x), both increasing.
    height_unit : str, optional
        Unit of the numbers; default the NetCDF variable's ``units``, else metres.
    size : tuple of float, optional
        Lateral periods (m); default from the NetCDF's coordinates ``y`` and ``x`` (m).

    Raises
    ------
    InputError
        If the file is missing or damaged, is no table of at least 4 × 4 finite numbers, its coordinates are not evenly
        spaced, or its size is unknown.
    """
    if not path.is_file():
        raise InputError(f"surface.path: {path} {'is no file' if path.exists() else 'does not exist'}")
    try:
        heights, unit, own_size = _read(path)
    except InputError:
        raise
    except Exception as error:  # each format raises its own types on a damaged file
        raise InputError(f"surface.path: {path} cannot be read ({error})") from None
    if heights.ndim != 2 or min(heights.shape) < 4:
        raise InputError(
            f"surface.path: {path} holds an array of shape {heights.shape}; expected at least 4 x 4 heights"
        )
    bad = np.argwhere(~np.isfinite(heights))
    if bad.size:
        raise InputError(
            f"surface.path: {path} holds {len(bad)} heights that are no finite numbers, the first at "
            f"row {bad[0][0]}, column {bad[0][1]}; fill or crop them"
        )
    size = size or own_size
    if size is None:
        raise InputError(f"missing key surface.size: {path} does not tell its lateral size")
    factor = units.quantity(f"1 {height_unit or unit}", "m", "surface.height_unit")
    return HeightMap(np.ascontiguousarray(heights, dtype=float) * factor, size)


def _read(path: Path) -> tuple[np.ndarray, str, tuple[float, float] | None]:
    if path.suffix == ".npy":
        return np.load(path, allow_pickle=False), "m", None
    if path.suffix in (".nc", ".nc4", ".netcdf"):
        return _read_netcdf(path)
    return np.loadtxt(path, ndmin=2), "m", None


def _read_netcdf(path: Path) -> tuple[np.ndarray, str, tuple[float, float] | None]:
    import xarray as xr

    with xr.open_dataset(path) as dataset:
        names = [str(name) for name, variable in dataset.items() if variable.ndim == 2]
        name = "height" if "height" in dataset else (names[0] if len(names) == 1 else None)
        if name is None:
            raise InputError(f"surface.path: {path} has no variable height and {len(names)} two-dimensional ones")
        heights = dataset[name].load()
        axes = {_axis(dataset, str(dimension)): dimension for dimension in heights.dims}
        if set(axes) == {"y", "x"}:
            heights = heights.transpose(axes["y"], axes["x"])
        steps = []
        for dimension in map(str, heights.dims):
            step = _step(path, dataset, dimension)
            if step is not None and step < 0:
                heights = heights.isel({dimension: slice(None, None, -1)})
            steps.append(step)
        size = None
        if len(steps) == 2 and steps[0] and steps[1]:
            size = abs(steps[0]) * heights.shape[0], abs(steps[1]) * heights.shape[1]
        return heights.values, str(heights.attrs.get("units", "m")), size


def _axis(dataset: Any, dimension: str) -> str:
    """``y`` or ``x`` as the coordinate's attribute or else the dimension's name says; another name as it is."""
    attribute = dataset[dimension].attrs.get("axis") if dimension in dataset.coords else None
    return str(attribute or dimension).lower()


def _step(path: Path, dataset: Any, dimension: str) -> float | None:
    """Distance of neighbouring points (m), negative where the coordinate decreases; None without a coordinate."""
    if dimension not in dataset.coords or dataset[dimension].size < 2:
        return None
    coordinate = dataset[dimension]
    values = coordinate.values.astype(float)
    step = (values[-1] - values[0]) / (values.size - 1)
    even = values[0] + step * np.arange(values.size)
    if not np.all(np.abs(values - even) <= _UNEVEN * abs(step)) or step == 0:
        lengths = np.abs(np.diff(values))
        raise InputError(
            f"surface.path: the coordinate {dimension} of {path} is not evenly spaced (steps from "
            f"{lengths.min():.6g} to {lengths.max():.6g}); resample the map on an even grid"
        )
    unit = str(coordinate.attrs.get("units", "m"))
    return float(step) * units.quantity(f"1 {unit}", "m", f"units of {dimension}")
