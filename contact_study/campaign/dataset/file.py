"""Write the file of a dataset by rename; read it case by case."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.dataset.states import States, states_file
from contact_study.campaign.store.files import write_aside
from contact_study.campaign.store.formats import engine_of, is_dataset, is_zarr, readable
from contact_study.inputs.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.results.schema import COORDINATES, LABELS, TRAJECTORY, variable_of
from contact_study.study.study import Study

# Group of the restart states in datasets of earlier versions; now a file beside the dataset, see :mod:`.states`.
_RESTART = "restart"

_CHUNK_POINTS = 2**18
# Largest number of values per state of a quantity that is read for all cases at once.
_SMALL = 4096


def write_dataset(path: Path, groups: Mapping[str, xr.Dataset]) -> None:
    """Write the groups of one dataset; a file by rename, a folder of Zarr directly."""
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
        # Format 2 specifies how text is stored; the index of all groups is written at the end.
        mode: Any = "a" if group else "w"
        dataset.to_zarr(path, mode=mode, group=group or None, encoding=encoding, zarr_format=2, consolidated=False)
    zarr.consolidate_metadata(str(path), zarr_format=2)


def _of_zarr(name: str, variable: xr.Variable) -> dict[str, Any]:
    """Encoding for Zarr, which compresses by default and writes one file per chunk."""
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
    """Choose chunks of about 2 MB: one state, or part of it, of a large field; many states and cases of a distribution.

    Reading one field then reads no other, and a distribution of a thousand cases takes a hundred chunks.
    """
    chunks: list[int] = []
    points = 1
    for size in reversed(shape):
        chunks.insert(0, min(size, max(1, _CHUNK_POINTS // points)))
        points *= chunks[0]
    return tuple(chunks)


def attributes_of(path: Path) -> dict[str, Any] | None:
    """Global attributes of a dataset; None if there is no readable one."""
    if not is_dataset(path):
        return None
    try:
        with readable(path), xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False) as dataset:
            return dict(dataset.attrs)
    except InputError:
        return None


def history_of(path: Path) -> str | None:
    """History attribute of a dataset; None if there is no readable one."""
    attributes = attributes_of(path)
    return None if attributes is None else str(attributes.get("history", ""))


@dataclass(frozen=True)
class ExistingDataset:
    """A finished dataset.

    Attributes
    ----------
    path : pathlib.Path
        Its file, or folder of Zarr.
    attributes : dict
        Its global attributes.
    """

    path: Path
    attributes: Mapping[str, Any]


@dataclass(frozen=True)
class _Quantity:
    """A quantity of all cases: an array in memory, or a variable that is read piece by piece."""

    name: str
    dims: tuple[str, ...]
    values: Any

    def at(self, place: Mapping[str, int]) -> Any:
        chosen = self.values[tuple(place.get(dim, slice(None)) for dim in self.dims)]
        return chosen.values if isinstance(self.values, xr.Variable) else chosen


class DatasetReader:
    """Reader of the cases of a dataset that :func:`write_dataset` wrote; a context.

    Parameters
    ----------
    path : pathlib.Path
        The dataset.
    study : Study
        Its study.

    Raises
    ------
    InputError
        If it cannot be read; the methods raise it, too.
    """

    def __init__(self, path: Path, study: Study):
        self.path = path
        self._study = study
        with readable(path):
            self._tree = xr.open_datatree(path, engine=engine_of(path), mask_and_scale=False, decode_timedelta=False)
            self._quantities = list(self._read_quantities())
        self._states = States(states_file(path))

    def __enter__(self) -> "DatasetReader":
        return self

    def __exit__(self, *_: Any) -> None:
        self._tree.close()

    def bins(self, own: Bins) -> Bins:
        """Bins of the distributions, from their centres; those of ``own`` for a distribution that is missing."""
        nodes = list(self._tree.subtree)
        edges = []
        for name, default in (("pressure_bin", own.pressure_edges), ("gap_bin", own.gap_edges)):
            with readable(self.path):
                centres = next((node[name].values for node in nodes if name in node.coords), None)
            if centres is None:
                edges.append(default)
            else:
                width = (centres[-1] - centres[0]) / (centres.size - 1)
                edges.append(np.linspace(centres[0] - width / 2, centres[-1] + width / 2, centres.size + 1))
        return replace(own, pressure_edges=edges[0], gap_edges=edges[1])

    def case(self, number: int, bins: Bins) -> "StoredCase":
        """One case, by its number in the study; ``bins`` are those of the dataset."""
        return StoredCase(self, number, bins)

    def constants(self, number: int) -> dict[str, Any]:
        """Quantities of a case that do not change along its path."""
        return self._read(number, (one for one in self._quantities if "step" not in one.dims))

    def step(self, number: int, step: int) -> dict[str, Any]:
        """Quantities and fields of one step of a case."""
        return self._read(number, (one for one in self._quantities if "step" in one.dims), step)

    def text(self, name: str, number: int, step: int) -> str | None:
        """A text of one step of a case; None if the dataset has no such quantity."""
        found = self._read(number, (one for one in self._quantities if one.name == name), step)
        return str(found[name]) if found else None

    def _read(self, number: int, quantities: Iterable[_Quantity], step: int = 0) -> dict[str, Any]:
        place = {**dict(zip(self._study.sweep, self._study.cases[number].index, strict=True)), "step": step}
        with readable(self.path):
            return {one.name: one.at(place) for one in quantities}

    def state(self, number: int, step: int) -> dict[str, np.ndarray]:
        """Restart state after a step of a case; empty unless it is the last one and was kept."""
        if step != len(self._study.cases[number].path) - 1:
            return {}
        if _RESTART not in self._tree.children:
            return self._states.state(number) if self._states.history == self._tree.attrs.get("history") else {}
        with readable(self.path):
            return {name: variable.values for name, variable in self._grouped_states.get(number, {}).items()}

    @cached_property
    def _grouped_states(self) -> dict[int, dict[str, xr.DataArray]]:
        """States in a dataset of an earlier version: variables such as ``case_12_state``."""
        found: dict[int, dict[str, xr.DataArray]] = {}
        for name, variable in self._tree[_RESTART].to_dataset(inherit=False).data_vars.items():
            _, number, own = str(name).split("_", 2)
            found.setdefault(int(number), {})[own] = variable
        return found

    def _read_quantities(self) -> Iterator[_Quantity]:
        """Yield the quantities of all groups; those larger than a distribution stay in the file."""
        sweep = self._study.sweep
        whole_study = {*sweep, *LABELS, "step", "pressure_bin", "gap_bin", "relative_distance"}
        for node in self._tree.subtree:
            group = node.path.strip("/")
            if group == _RESTART:
                continue
            for name, variable in node.to_dataset(inherit=False).variables.items():
                if name in whole_study or (group and name in COORDINATES):
                    continue
                own = [size for dim, size in variable.sizes.items() if dim not in (*sweep, *LABELS, "step")]
                small = math.prod(own) <= _SMALL
                if small:
                    variable.load()
                dims = [dim for dim in LABELS if dim in variable.dims]
                above = [TRAJECTORY] if group == TRAJECTORY else []
                for place in np.ndindex(*(variable.sizes[dim] for dim in dims)):
                    labelled = dict(zip(dims, place, strict=True))
                    # A group inherits the labels of the root.
                    labels = [str(node[dim].values[i]) for dim, i in labelled.items()]
                    chosen = variable.isel(labelled)
                    key = "/".join([*above, *labels, str(name)])
                    yield _Quantity(key, chosen.dims, chosen.values if small else chosen)


class StoredCase:
    """A case in a finished dataset; it is read in place.

    Parameters
    ----------
    dataset : DatasetReader
        The dataset.
    number : int
        Number of the case in it.
    bins : Bins
        Bins of the dataset.
    """

    def __init__(self, dataset: DatasetReader, number: int, bins: Bins):
        self._dataset, self._number, self._bins = dataset, number, bins

    @property
    def constants(self) -> dict[str, Any]:
        """Quantities that do not change along the path."""
        return self._dataset.constants(self._number)

    def step(self, number: int) -> tuple[dict[str, Any], Bins]:
        """Quantities and fields of one step, and the bins of its distributions."""
        return self._dataset.step(self._number, number), self._bins

    def state(self, number: int) -> dict[str, np.ndarray]:
        """Restart state after a step; empty unless it is the last one and was kept."""
        return self._dataset.state(self._number, number)
