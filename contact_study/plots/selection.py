"""Selection of the part of a dataset that a picture shows: one state, or lines over the sweep."""

import itertools
import tomllib
from collections.abc import Iterator

import numpy as np
import xarray as xr

from contact_study.results.observables.atoms import ATOMS, SURROUNDINGS
from contact_study.results.state import usable

LOADING, UNLOADING = 0, 1


def require(dataset: xr.Dataset, *names: str) -> None:
    """Raise ValueError unless a dataset has the variables to show."""
    for name in names:
        if name not in dataset:
            hint = "; fields are kept with output.fields = true" if name in ("gap", "pressure", "height") else ""
            hint = '; atoms are kept with output.atoms = "surface"' if name in (*ATOMS, *SURROUNDINGS) else hint
            raise ValueError(f"the dataset has no variable {name!r}{hint}")


def one_state(dataset: xr.Dataset, *names: str) -> xr.Dataset:
    """The one state of a dataset; ValueError if a variable is missing, or there are several states."""
    require(dataset, *names)
    squeezed = dataset.squeeze()
    for dim in squeezed[names[0]].dims:
        if dim not in ("y", "x"):
            values = squeezed[dim].values
            raise ValueError(
                f"the dataset holds {values.size} states along {dim!r}: select one first, for example "
                f"dataset.sel({dim}={values[-1]!s})"
            )
    # Smaller cells of a sweep are padded to the points of the largest.
    state = squeezed.isel(
        {axis: np.flatnonzero(np.isfinite(squeezed[axis].values)) for axis in ("y", "x") if axis in squeezed.dims}
    )
    for name in names:
        if state[name].isnull().all():
            raise ValueError(f"the dataset keeps no {name} of this point of the path; output.field_steps chose others")
    return state


def extent(state: xr.Dataset) -> tuple[float, float]:
    """Lateral periods along y and x (m): a grid's last point is one spacing before its end."""
    periods = []
    for axis in ("y", "x"):
        values = state[axis].values
        periods.append(values.size * float(values[1] - values[0]) if values.size > 1 else float(state["pixel"]))
    return periods[0], periods[1]


def touching(state: xr.Dataset) -> np.ndarray:
    """Whether each point (y, x) counts as contact, as simulations count it: by the contact distance, zero at a wall.

    At a bare wall the highest point of surfaces that are just apart has no gap either, but carries nothing.
    """
    distance = float(state["contact_distance"])
    near = state["gap"].values <= distance
    return near & (state["pressure"].values != 0) if distance == 0 and "pressure" in state else near


def is_periodic(state: xr.Dataset) -> bool:
    """Whether the surface is periodic, by the study that a dataset carries; without one it is."""
    study = tomllib.loads(state.attrs.get("study_toml", ""))
    swept = state.coords.get("boundary", study.get("elasticity", {}).get("boundary", "periodic"))
    return str(np.asarray(swept)) == "periodic"


def lines(dataset: xr.Dataset, name: str, *along: str) -> Iterator[tuple[str, xr.Dataset]]:
    """One dataset for each line of a picture, and a label that distinguishes it from the others."""
    dims = [str(dim) for dim in dataset[name].dims if dim not in along]
    for values in itertools.product(*(dataset[dim].values for dim in dims)):
        words = [label(dataset[dim], value) for dim, value in zip(dims, values, strict=True)]
        yield ", ".join(words), dataset.sel(dict(zip(dims, values, strict=True)))


def label(coordinate: xr.DataArray, value: object) -> str:
    """One coordinate in words."""
    if isinstance(value, str):
        return value.replace("_", " ")
    units = coordinate.attrs.get("units", "1").replace(" m-2", "/m²")
    return f"{str(coordinate.name).replace('_', ' ')} = {value:.6g}{'' if units == '1' else f' {units}'}"


def fit_states(part: xr.Dataset) -> np.ndarray:
    """Which points of the path have converged in contact, in the shape of its pressures."""
    flags = {name: part[name] for name in ("relative_contact_area", "converged", "detached") if name in part}
    fit = xr.ones_like(part["mean_pressure"], bool) & usable(flags)
    return np.isfinite(part["mean_pressure"].values) & fit.transpose(*part["mean_pressure"].dims).values


def largest(dataset: xr.Dataset, name: str) -> float:
    """The largest finite magnitude of a variable, zero without one."""
    require(dataset, name)
    values = np.abs(dataset[name].values)
    return float(values[np.isfinite(values)].max(initial=0.0))
