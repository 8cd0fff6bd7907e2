"""Selection of the part of a dataset that a picture shows: one state, or lines over the sweep."""

import itertools
import tomllib
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr

from contact_study.plots.style import force_unit, length_unit, pressure_unit
from contact_study.results.schema import BY_ATOM
from contact_study.results.state import usable

LOADING, UNLOADING = 0, 1
_UNITS = {"m": length_unit, "N": force_unit, "Pa": pressure_unit}


def require(dataset: xr.Dataset, *names: str) -> None:
    """Raise ValueError unless a dataset has the variables to show."""
    hints = dict.fromkeys(("gap", "pressure", "height"), "; fields are kept with output.fields = true")
    hints |= dict.fromkeys(BY_ATOM, '; atoms are kept with output.atoms = "surface"')
    hints["pressure_pdf_at"] = "; it is kept with theory.magnifications = 48"
    hints |= dict.fromkeys(("hydraulic_gap_x", "hydraulic_gap_y"), "; it is kept with output.leakage = true")
    for name in names:
        if name not in dataset:
            raise ValueError(f"the dataset has no variable {name!r}{hints.get(name, '')}")


def single(part: xr.Dataset, name: str, dims: Sequence[str], what: str) -> None:
    """Raise ValueError if a variable has further dimensions: more than one of what is shown."""
    others = [dim for dim in part[name].dims if dim not in dims]
    if others:
        raise ValueError(f"the dataset has more than one {what}: select one along {others[0]!r} first")


def on_axes(case: xr.Dataset) -> xr.Dataset:
    """A case whose maps have the dimensions y and x, where a sweep over sizes numbers their points."""
    numbered = {f"{axis}_index": axis for axis in "yx" if f"{axis}_index" in case.dims}
    return case.swap_dims({number: axis for number, axis in numbered.items() if case[axis].dims == (number,)})


def one_state(dataset: xr.Dataset, *names: str) -> xr.Dataset:
    """The one state of a dataset; ValueError if a variable is missing, or there are several states."""
    require(dataset, *names)
    squeezed = on_axes(dataset.squeeze())
    for dim in squeezed[names[0]].dims:
        if dim not in ("y", "x"):
            values = squeezed[dim].values
            raise ValueError(
                f"the dataset holds {values.size} states along {dim!r}: select one first, for example "
                f"dataset.sel({dim}={values[-1]!s})"
            )
    axes = [axis for axis in ("y", "x") if axis in squeezed.dims]
    # Smaller cells of a sweep are padded to the points of the largest.
    there = {axis: np.isfinite(squeezed[axis].values) for axis in axes}
    state = squeezed.isel({axis: np.flatnonzero(known) for axis, known in there.items() if not known.all()})
    for name in names:
        if state[name].isnull().all():
            raise ValueError(f"the dataset keeps no {name} of this point of the path; output.field_steps chose others")
    return state


def extent(state: xr.Dataset) -> tuple[float, float]:
    """Lateral periods along y and x (m): a grid's last point is one spacing before its end."""
    y, x = (state[axis].values for axis in ("y", "x"))
    height, width = (a.size * float(a[1] - a[0]) if a.size > 1 else float(state["pixel"]) for a in (y, x))
    return height, width


def touching(state: xr.Dataset) -> np.ndarray:
    """Whether each point (y, x) counts as contact, as simulations count it: by the contact distance, zero at a wall.

    At a bare wall the highest point of surfaces that are just apart has no gap either, but carries nothing.
    """
    distance = float(state["contact_distance"])
    near = state["gap"].values <= distance
    return near & (state["pressure"].values != 0) if distance == 0 and "pressure" in state else near


def is_periodic(state: xr.Dataset) -> bool:
    """Whether the cell of a simulation repeats, by its swept key ``boundary`` or its study."""
    study = tomllib.loads(state.attrs.get("study_toml", ""))
    boundary = state.coords.get("boundary", study.get("elasticity", {}).get("boundary", "periodic"))
    return str(np.asarray(boundary)) == "periodic"


def highest_row(state: xr.Dataset) -> int:
    """Number of the line of points through the highest point of the surface."""
    height = state["height"].values
    return int(np.unravel_index(height.argmax(), height.shape)[0])


def along_line(
    state: xr.Dataset, start: tuple[float, float], end: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Distance, height, gap (m) and whether in contact, along a straight line between points (y, x) of a state.

    Heights and gaps are bilinear between grid points; contact is that of the nearest one. A line may leave a periodic
    cell; beyond the edge of another one all is as at the edge. As many points as the line is grid spacings long.
    """
    from scipy.ndimage import map_coordinates  # slow to import

    shape, size = state["gap"].shape, extent(state)
    ends = np.array([start, end])
    spacing = np.array(size) / shape
    count = max(2, int(np.ceil(np.abs((ends[1] - ends[0]) / spacing).max())) + 1)
    part = np.linspace(0.0, 1.0, count)
    origin = np.array([state[axis].values[0] for axis in ("y", "x")])
    at = ((ends[0] - origin) / spacing)[:, None] + ((ends[1] - ends[0]) / spacing)[:, None] * part
    mode = "grid-wrap" if is_periodic(state) else "nearest"
    height, gap = (map_coordinates(state[name].values, at, order=1, mode=mode) for name in ("height", "gap"))
    contact = map_coordinates(touching(state).astype(np.uint8), at, order=0, mode=mode) > 0
    return part * float(np.hypot(*(ends[1] - ends[0]))), height, gap, contact


def lines(dataset: xr.Dataset, name: str, *along: str) -> Iterator[tuple[str, xr.Dataset]]:
    """One dataset for each line of a picture, and a label that distinguishes it from the others."""
    dims = [str(dim) for dim in dataset[name].dims if dim not in along]
    for values in itertools.product(*(dataset[dim].values for dim in dims)):
        words = [label(dataset[dim], value) for dim, value in zip(dims, values, strict=True)]
        yield ", ".join(words), dataset.sel(dict(zip(dims, values, strict=True)))


def label(coordinate: xr.DataArray, value: Any) -> str:
    """One coordinate in words; lengths, forces and pressures in the unit that suits the smallest."""
    if isinstance(value, str):
        return value.replace("_", " ")
    units, size = coordinate.attrs.get("units", "1").replace(" m-2", "/m²").replace(" m-1", "/m"), 1.0
    magnitudes = np.abs(coordinate.values[coordinate.values != 0]) if units in _UNITS else np.array([])
    if magnitudes.size:
        unit = _UNITS[units](float(magnitudes.min()))
        units, size = unit.name, unit.size
    return f"{str(coordinate.name).replace('_', ' ')} = {value / size:.6g}{'' if units == '1' else f' {units}'}"


def fit_states(part: xr.Dataset) -> np.ndarray:
    """Which points of the path have converged in contact, in the shape of its pressures."""
    flags = {name: part[name] for name in ("relative_contact_area", "converged", "detached") if name in part}
    fit = xr.ones_like(part["mean_pressure"], bool) & usable(flags)
    return np.isfinite(part["mean_pressure"].values) & fit.transpose(*part["mean_pressure"].dims).values
