"""Height maps from files: NetCDF, npy or text, as one array in metres."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.problem import units
from contact_study.problem.errors import InputError


@dataclass(frozen=True)
class HeightMap:
    """Heights (y, x) and the lateral size of the cell, both in metres."""

    heights: np.ndarray
    size: tuple[float, float]


def read_height_map(path: Path, height_unit: str | None, size: tuple[float, float] | None) -> HeightMap:
    """Read a height map.

    Parameters
    ----------
    path : pathlib.Path
        ``.nc`` (variable ``height``, or the only two-dimensional one), ``.npy``, or a text table.
    height_unit : str, optional
        Unit of the numbers; default the NetCDF variable's ``units``, else metres.
    size : tuple of float, optional
        Lateral periods (m); default from the NetCDF's coordinates ``y`` and ``x`` (m).

    Raises
    ------
    InputError
        If the file is missing or damaged, is no table of at least 4 × 4 finite numbers, or its size is unknown.
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
        steps = [_step(dataset, str(dimension)) for dimension in heights.dims]
        size = None
        if len(steps) == 2 and steps[0] and steps[1]:
            size = steps[0] * heights.shape[0], steps[1] * heights.shape[1]
        return heights.values, str(heights.attrs.get("units", "m")), size


def _step(dataset: Any, dimension: str) -> float | None:
    if dimension not in dataset.coords or dataset[dimension].size < 2:
        return None
    coordinate = dataset[dimension]
    unit = str(coordinate.attrs.get("units", "m"))
    return float(coordinate[1] - coordinate[0]) * units.quantity(f"1 {unit}", "m", f"units of {dimension}")
