"""The one dataset of a study: assembled from its cases, written by rename, and taken apart into its cases again."""

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.schema import COORDINATES, variable_of
from contact_study.problem.errors import InputError
from contact_study.problem.study import SweptKey

# Group of the states from which paths can be gone on with; no quantity, and nothing for a reader.
RESTART = "restart"

_CHUNK_POINTS = 2**19


def writable_output(path: Path) -> None:
    """Make sure that a file can be written at ``path``, creating its folder.

    Raises
    ------
    InputError
        If the folder cannot be made or written.
    """
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file")
    if path.exists() and not path.is_file():
        raise InputError(f"{path}: is a device, not a file; choose another output")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        probe = path.parent / f".{path.name}.{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); choose another output") from None


def write_aside(path: Path, write: Any) -> None:
    """Call ``write(temporary_path)`` and rename the result to ``path``: readers see all of it or nothing.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    partial = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        write(partial)
        partial.replace(path)
    except RuntimeError as error:  # what the NetCDF library makes of a failed write
        raise OSError(f"{path}: cannot be written; is the disk full? ({error})") from None
    finally:
        partial.unlink(missing_ok=True)


def assemble(
    sweep: Mapping[str, SweptKey],
    steps: int,
    cases: Iterable[tuple[tuple[int, ...], dict[str, Any], list[dict[str, Any]]]],
    coordinates: Mapping[str, np.ndarray],
) -> dict[str, xr.Dataset]:
    """Datasets by group ("" for the root) from the values of every case.

    Where cases differ in the number of points of an array, such as the atoms of cells of different sizes, the shorter
    ones are padded at their ends.

    Parameters
    ----------
    sweep : mapping
        Swept keys: the leading dimensions.
    steps : int
        Points of the longest loading path.
    cases : iterable
        Position in the sweep, constants, and values of each step.
    coordinates : mapping
        One-dimensional coordinates of the whole study.
    """
    lengths = tuple(len(swept.values) for swept in sweep.values())
    arrays: dict[str, np.ndarray] = {}
    for index, constants, path in cases:
        for name, value in constants.items():
            _place(arrays, name, value, lengths, index)
        for number, values in enumerate(path):
            for name, value in values.items():
                _place(arrays, name, value, (*lengths, steps), (*index, number))
    groups: dict[str, dict[str, np.ndarray]] = {"": {}}
    for name, array in arrays.items():
        group, _, short = name.rpartition("/")
        groups.setdefault(group, {})[short] = array
    on_step = {
        name: groups[""][name] for name in groups[""] if name in COORDINATES and variable_of(name).dims == ("step",)
    }
    return {group: _dataset({**on_step, **content}, sweep, coordinates, steps) for group, content in groups.items()}


def restart_group(states: Iterable[Mapping[str, np.ndarray]]) -> xr.Dataset:
    """The states after the last step of each case, in the order of the cases; empty where one was not kept."""
    content = {}
    for number, arrays in enumerate(states):
        for name, array in arrays.items():
            key = f"case_{number}_{name}"
            attrs = {"long_name": f"{name} after the last point of case {number}, to continue its path from"}
            content[key] = xr.Variable([f"{key}_{axis}" for axis in range(array.ndim)], array, attrs)
    return xr.Dataset(content)


def write_dataset(path: Path, groups: Mapping[str, xr.Dataset]) -> None:
    """Write the groups of one dataset, by rename."""

    def write(partial: Path) -> None:
        for group, dataset in groups.items():
            encoding = (
                {name: {"zlib": True, "complevel": 1, "shuffle": True} for name, array in dataset.items() if array.ndim}
                if group == RESTART
                else {str(name): _encoding(str(name), variable) for name, variable in dataset.variables.items()}
            )
            dataset.to_netcdf(
                partial, mode="a" if group else "w", group=group or None, encoding=encoding, engine="netcdf4"
            )

    write_aside(path, write)


class Earlier:
    """The cases of a dataset that :func:`write_dataset` wrote.

    Parameters
    ----------
    path : pathlib.Path
        The dataset.
    sweep : mapping
        The swept keys of its study.

    Raises
    ------
    OSError, ValueError
        If it cannot be read.
    """

    def __init__(self, path: Path, sweep: Mapping[str, SweptKey]):
        self._sweep = sweep
        self._tree = xr.open_datatree(path, engine="netcdf4", mask_and_scale=False, decode_timedelta=False)

    def __enter__(self) -> "Earlier":
        return self

    def __exit__(self, *_: Any) -> None:
        self._tree.close()

    @property
    def bin_centres(self) -> tuple[np.ndarray | None, np.ndarray | None]:
        """Centres of the bins of pressure (Pa) and gap (m); None where there is no such distribution."""
        names = ("pressure_bin", "gap_bin")
        nodes = list(self._tree.subtree)
        found = [next((node[name].values for node in nodes if name in node.coords), None) for name in names]
        return found[0], found[1]

    def constants(self, index: tuple[int, ...]) -> dict[str, Any]:
        """What does not change along the path of the case at a position of the sweep."""
        found = {}
        for name, variable in self._variables(index):
            if "step" not in variable.dims:
                found[name] = variable.values
        return found

    def step(self, index: tuple[int, ...], number: int) -> dict[str, Any]:
        """Quantities and fields of one step of a case."""
        return {
            name: variable.isel(step=number).values
            for name, variable in self._variables(index)
            if "step" in variable.dims
        }

    def text(self, name: str, index: tuple[int, ...], number: int) -> str | None:
        """A text at one step of a case; None if the dataset has no such quantity."""
        for other, variable in self._variables(index):
            if other == name:
                return str(variable.isel(step=number).values)
        return None

    def state(self, number: int) -> dict[str, np.ndarray]:
        """State after the last step of the case of that number; empty if it was not kept."""
        if RESTART not in self._tree.children:
            return {}
        states, prefix = self._tree[RESTART], f"case_{number}_"
        return {str(name)[len(prefix) :]: states[name].values for name in states if str(name).startswith(prefix)}

    def _variables(self, index: tuple[int, ...]) -> Iterator[tuple[str, xr.Variable]]:
        """Quantities of all groups at a position of the sweep, those of the whole study apart."""
        whole = {*self._sweep, "step", "pressure_bin", "gap_bin"}
        for node in self._tree.subtree:
            group = node.path.strip("/")
            if group == RESTART:
                continue
            dataset = node.to_dataset(inherit=False)
            for name, variable in dataset.variables.items():
                if name in whole or (group and name in COORDINATES):
                    continue
                chosen = {dim: i for dim, i in zip(self._sweep, index, strict=True) if dim in variable.dims}
                yield f"{group}/{name}" if group else str(name), variable.isel(chosen)


def _encoding(name: str, variable: xr.Variable) -> dict[str, Any]:
    if variable.dtype.kind not in "fiu":
        return {}
    if variable.dims == (name,):  # CF: a coordinate has no missing values
        return {"_FillValue": None}
    encoding = variable_of(name).encoding
    if encoding.get("zlib"):  # one state a chunk, and no more than a few MB: a reader of one field reads no other
        rows, columns = variable.shape[-2:]
        whole_rows = max(1, min(rows, _CHUNK_POINTS // columns)) if variable.dims[-2] != "step" else 1
        encoding |= {"chunksizes": (*(1,) * (variable.ndim - 2), whole_rows, columns)}
    return encoding


def _place(
    arrays: dict[str, np.ndarray], name: str, value: Any, lengths: tuple[int, ...], index: tuple[int, ...]
) -> None:
    variable = variable_of(name.rpartition("/")[2])
    value = np.asarray(value)
    there = arrays[name].shape[len(lengths) :] if name in arrays else ()
    if name not in arrays or any(new > old for new, old in zip(value.shape, there, strict=True)):
        shape = tuple(map(max, value.shape, there)) if name in arrays else value.shape
        larger = np.full((*lengths, *shape), variable.empty, dtype=variable.dtype)
        if name in arrays:
            larger[_corner(arrays[name].shape)] = arrays[name]
        arrays[name] = larger
    if value.shape:
        arrays[name][index][_corner(value.shape)] = value
    else:
        arrays[name][index] = value.item()


def _corner(shape: tuple[int, ...]) -> tuple[slice, ...]:
    return tuple(slice(count) for count in shape)


def _dataset(
    content: Mapping[str, np.ndarray],
    sweep: Mapping[str, SweptKey],
    coordinates: Mapping[str, np.ndarray],
    steps: int,
) -> xr.Dataset:
    data: dict[str, xr.Variable] = {}
    coords: dict[str, xr.Variable] = {}
    for name, array in content.items():
        dims = (*sweep, *variable_of(name).dims)
        target = coords if name in COORDINATES else data
        if name in COORDINATES or not variable_of(name).dims or variable_of(name).dims[0] != "step":
            array, dims = _drop_constant_sweep(array, dims, len(sweep))
        target[name] = xr.Variable(dims, array, _attributes(name))
    # A coordinate that changes over the sweep cannot index its own dimension, which then counts points only.
    indices = {
        name: f"{name}_index" for name, variable in coords.items() if name in variable.dims and variable.ndim > 1
    }
    for variable in [*data.values(), *coords.values()]:
        variable.dims = tuple(indices.get(str(dim), dim) for dim in variable.dims)
    used = {dim for variable in [*data.values(), *coords.values()] for dim in variable.dims}
    for name, values in {**coordinates, "step": np.arange(steps, dtype=np.int32)}.items():
        if name in used and name not in coords:
            coords[name] = xr.Variable((name,), values, _attributes(name))
    for name, swept in sweep.items():
        coords[name] = xr.Variable(
            (name,), np.asarray(swept.values), {"units": swept.units, "long_name": swept.description}
        )
    return xr.Dataset(data, coords)


def _drop_constant_sweep(array: np.ndarray, dims: tuple[str, ...], swept: int) -> tuple[np.ndarray, tuple[str, ...]]:
    """Leave out a swept dimension along which a coordinate or constant does not change."""
    for axis in reversed(range(swept)):
        first = np.take(array, [0], axis=axis)
        same = array == first
        if array.dtype.kind == "f":
            same |= np.isnan(array) & np.isnan(first)
        if np.all(same):
            array, dims = np.take(array, 0, axis=axis), (*dims[:axis], *dims[axis + 1 :])
    return array, dims


def _attributes(name: str) -> dict[str, Any]:
    variable = variable_of(name)
    return {"units": variable.units, "long_name": variable.long_name, **variable.attrs}
