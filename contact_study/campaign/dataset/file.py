"""The dataset's file: written by rename, and read case by case again."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.dataset.formats import engine_of, is_dataset, is_zarr, readable
from contact_study.campaign.dataset.states import States, states_file
from contact_study.campaign.store.files import write_aside
from contact_study.errors import InputError
from contact_study.results.schema import COORDINATES, LABELS, TRAJECTORY, variable_of
from contact_study.study.sweep import SweptKey

# Group in which datasets of earlier versions have what stands beside them now, see :mod:`.states`.
_RESTART = "restart"

_CHUNK_POINTS = 2**18
# Numbers of one state up to which a quantity is read for all cases at once.
_SMALL = 4096


def write_dataset(path: Path, groups: Mapping[str, xr.Dataset]) -> None:
    """Write the groups of one dataset; a file by rename, a folder of Zarr as it is."""
    if is_zarr(path):
        _write_zarr(path, groups)
        return

    def write(partial: Path) -> None:
        for group, dataset in groups.items():
            encoding = {str(name): _encoding(str(name), variable) for name, variable in dataset.variables.items()}
            dataset.to_netcdf(
                partial, mode="a" if group else "w", group=group or None, encoding=encoding, engine="netcdf4"
            )

    write_aside(path, write)


def _write_zarr(path: Path, groups: Mapping[str, xr.Dataset]) -> None:
    import zarr  # an extra

    for group, dataset in groups.items():
        encoding = {str(name): _of_zarr(str(name), variable) for name, variable in dataset.variables.items()}
        # Format 2 is the one that says how text is kept; an index of all groups is made at the end.
        mode: Any = "a" if group else "w"
        dataset.to_zarr(path, mode=mode, group=group or None, encoding=encoding, zarr_format=2, consolidated=False)
    zarr.consolidate_metadata(str(path), zarr_format=2)


def _of_zarr(name: str, variable: xr.Variable) -> dict[str, Any]:
    """The encoding in the words of Zarr, which compresses of itself, and has a file for each chunk."""
    kept = {key: value for key, value in _encoding(name, variable).items() if key in ("_FillValue", "dtype")}
    return {**kept, "chunks": chunks_of(variable.shape)} if variable.size else kept


def _encoding(name: str, variable: xr.Variable) -> dict[str, Any]:
    if variable.dtype.kind not in "fiu":
        return {}
    if variable.dims == (name,):  # CF: a coordinate has no missing values
        return {"_FillValue": None}
    encoding = variable_of(name).encoding
    return encoding | ({"chunksizes": chunks_of(variable.shape)} if encoding.get("zlib") else {})


def chunks_of(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Chunks of about 2 MB: of large fields one state or part of it, of distributions those of many states and cases.

    A reader of one field reads no other, and a reader of a distribution of a thousand cases a hundred chunks.
    """
    chunks: list[int] = []
    points = 1
    for size in reversed(shape):
        chunks.insert(0, min(size, max(1, _CHUNK_POINTS // points)))
        points *= chunks[0]
    return tuple(chunks)


def attributes_of(path: Path) -> dict[str, Any] | None:
    """Global attributes of the dataset at a place; None where there is none that can be read."""
    if not is_dataset(path):
        return None
    try:
        with readable(path), xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False) as dataset:
            return dict(dataset.attrs)
    except InputError:
        return None


def history_of(path: Path) -> str | None:
    """What was asked for the dataset at a place, and when; None where there is none that can be read."""
    attributes = attributes_of(path)
    return None if attributes is None else str(attributes.get("history", ""))


@dataclass(frozen=True)
class _Quantity:
    """A quantity of all cases as a model names it: an array in memory, or a variable that is read piece by piece."""

    name: str
    dims: tuple[str, ...]
    values: Any

    def at(self, place: Mapping[str, int]) -> Any:
        chosen = self.values[tuple(place.get(dim, slice(None)) for dim in self.dims)]
        return chosen.values if isinstance(self.values, xr.Variable) else chosen


class DatasetReader:
    """The cases of a dataset that :func:`write_dataset` wrote.

    Parameters
    ----------
    path : pathlib.Path
        The dataset.
    sweep : mapping
        The swept keys of its study.

    Attributes
    ----------
    path : pathlib.Path
        The dataset.

    Raises
    ------
    InputError
        If it cannot be read; so do the methods.
    """

    def __init__(self, path: Path, sweep: Mapping[str, SweptKey]):
        self.path = path
        self._sweep = sweep
        with readable(path):
            self._tree = xr.open_datatree(path, engine=engine_of(path), mask_and_scale=False, decode_timedelta=False)
            self._quantities = list(self._read_quantities())
        self._states = States(states_file(path))

    def __enter__(self) -> "DatasetReader":
        return self

    def __exit__(self, *_: Any) -> None:
        self._tree.close()

    @property
    def bin_centres(self) -> tuple[np.ndarray | None, np.ndarray | None]:
        """Centres of the bins of pressure (Pa) and gap (m); None where there is no such distribution."""
        names = ("pressure_bin", "gap_bin")
        nodes = list(self._tree.subtree)
        with readable(self.path):
            found = [next((node[name].values for node in nodes if name in node.coords), None) for name in names]
        return found[0], found[1]

    def constants(self, index: tuple[int, ...]) -> dict[str, Any]:
        """What does not change along the path of the case at a position of the sweep."""
        return self._at(index, (one for one in self._quantities if "step" not in one.dims))

    def step(self, index: tuple[int, ...], number: int) -> dict[str, Any]:
        """Quantities and fields of one step of a case."""
        return self._at(index, (one for one in self._quantities if "step" in one.dims), number)

    def text(self, name: str, index: tuple[int, ...], number: int) -> str | None:
        """A text at one step of a case; None if the dataset has no such quantity."""
        found = self._at(index, (one for one in self._quantities if one.name == name), number)
        return str(found[name]) if found else None

    def _at(self, index: tuple[int, ...], quantities: Iterable[_Quantity], number: int = 0) -> dict[str, Any]:
        place = {**dict(zip(self._sweep, index, strict=True)), "step": number}
        with readable(self.path):
            return {one.name: one.at(place) for one in quantities}

    def state(self, number: int) -> dict[str, np.ndarray]:
        """State after the last step of the case of that number; empty if it was not kept."""
        if _RESTART not in self._tree.children:
            return self._states.state(number) if self._states.history == self._tree.attrs.get("history") else {}
        with readable(self.path):
            return {name: variable.values for name, variable in self._grouped_states.get(number, {}).items()}

    @cached_property
    def _grouped_states(self) -> dict[int, dict[str, xr.DataArray]]:
        """The states of a dataset of an earlier version: variables such as ``case_12_state``."""
        found: dict[int, dict[str, xr.DataArray]] = {}
        for name, variable in self._tree[_RESTART].to_dataset(inherit=False).data_vars.items():
            _, number, own = str(name).split("_", 2)
            found.setdefault(int(number), {})[own] = variable
        return found

    def _read_quantities(self) -> Iterator[_Quantity]:
        """Quantities of all groups but those of the whole study; larger ones than a distribution stay in the file."""
        whole = {*self._sweep, *LABELS, "step", "pressure_bin", "gap_bin", "relative_distance"}
        for node in self._tree.subtree:
            group = node.path.strip("/")
            if group == _RESTART:
                continue
            for name, variable in node.to_dataset(inherit=False).variables.items():
                if name in whole or (group and name in COORDINATES):
                    continue
                own = [size for dim, size in variable.sizes.items() if dim not in (*self._sweep, *LABELS, "step")]
                small = math.prod(own) <= _SMALL
                if small:
                    variable.load()
                dims = [dim for dim in LABELS if dim in variable.dims]
                above = [TRAJECTORY] if group == TRAJECTORY else []
                for place in np.ndindex(*(variable.sizes[dim] for dim in dims)):
                    labelled = dict(zip(dims, place, strict=True))
                    # A group inherits the labels that the root has, too.
                    labels = [str(node[dim].values[i]) for dim, i in labelled.items()]
                    chosen = variable.isel(labelled)
                    key = "/".join([*above, *labels, str(name)])
                    yield _Quantity(key, chosen.dims, chosen.values if small else chosen)
