"""The file of a dataset, and beside it ``bem.nc.restart``, the state after each last point to lengthen from."""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import netCDF4
import numpy as np
import xarray as xr
from xarray.backends import NetCDF4DataStore

from contact_study.campaign.engines import CampaignError
from contact_study.campaign.store.case_file import RecordFile, write_records
from contact_study.campaign.store.files import engine_of, is_dataset, is_zarr, readable, write_aside
from contact_study.inputs.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.results.observables import FIXED_COORDINATES
from contact_study.results.schema import COORDINATES, LABELS, TRAJECTORY, variable_of
from contact_study.study.study import Study

# Group of the restart states in datasets of earlier versions: variables such as ``case_12_state``.
_RESTART = "restart"
_OWNER, _STATE = b"ownr", b"stat"  # records of the restart states

_CHUNK_POINTS = 2**18
# Largest number of values per state of a quantity that is read for all cases at once.
_SMALL = 4096


def write_dataset(path: Path, groups: Mapping[str, xr.Dataset]) -> None:
    """Write the groups of one dataset; a file by rename, a folder of Zarr directly."""
    if is_zarr(path):
        _write_zarr(path, groups)
        return

    def write(partial: Path) -> None:
        # ``to_netcdf`` would look for a Dask scheduler, and import Dask where that is installed.
        with netCDF4.Dataset(partial, "w") as file:
            for group, dataset in groups.items():
                encoding = {str(name): _encoding(str(name), variable) for name, variable in dataset.variables.items()}
                dataset.dump_to_store(NetCDF4DataStore(file, group or None, mode="a"), encoding=encoding)

    write_aside(path, write)


def _write_zarr(path: Path, groups: Mapping[str, xr.Dataset]) -> None:
    import zarr  # an extra

    for group, dataset in groups.items():
        encoding: dict[str, dict[str, Any]] = {}
        for name, variable in dataset.variables.items():  # Zarr compresses by default, and writes one file per chunk
            own = _encoding(str(name), variable)
            encoding[str(name)] = {key: own[key] for key in ("_FillValue", "dtype") if key in own}
            encoding[str(name)] |= {"chunks": chunks_of(variable.shape)} if variable.size else {}
        # Format 2 specifies how text is stored; the index of all groups is written at the end.
        mode: Any = "a" if group else "w"
        dataset.to_zarr(path, mode=mode, group=group or None, encoding=encoding, zarr_format=2, consolidated=False)
    zarr.consolidate_metadata(str(path), zarr_format=2)


def _encoding(name: str, variable: xr.Variable) -> dict[str, Any]:
    if variable.dtype.kind not in "fiu":
        return {}
    if variable.dims == (name,):  # CF: a coordinate has no missing values
        return {"_FillValue": None}
    encoding = variable_of(name).encoding
    return encoding | ({"chunksizes": chunks_of(variable.shape)} if encoding.get("zlib") else {})


def chunks_of(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Choose chunks of about 2 MB: one state, or part of it, of a large field; many cases of a distribution."""
    chunks: list[int] = []
    points = 1
    for size in reversed(shape):
        chunks.insert(0, min(size, max(1, _CHUNK_POINTS // points)))
        points *= chunks[0]
    return tuple(chunks)


@contextmanager
def opened(path: Path, option: str = "") -> Iterator[xr.Dataset]:
    """Open the root of a dataset, given by an ``option`` or not; any error is an InputError."""
    with readable(path, option), xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False) as dataset:
        yield dataset


def attributes_of(path: Path) -> dict[str, Any] | None:
    """Global attributes of a dataset; None if there is no readable one."""
    with suppress(InputError):
        if not is_dataset(path):
            return None
        if is_zarr(path):
            with opened(path) as dataset:
                return dict(dataset.attrs)
        with readable(path), netCDF4.Dataset(path) as file:  # without its variables, which xarray would decode
            return {name: file.getncattr(name) for name in file.ncattrs()}
    return None


def history_of(path: Path) -> str:
    """History of a dataset; empty if there is no readable one."""
    return str((attributes_of(path) or {}).get("history", ""))


def states_file(dataset: Path) -> Path:
    """Path of the restart states of a dataset."""
    return dataset.with_name(dataset.name + ".restart")


def write_states(path: Path, history: str, states: Iterable[Mapping[str, Any]]) -> None:
    """Write the states of the cases of a dataset, in their order; no file if all are empty."""
    kept = ((_STATE, number, state, None) for number, state in enumerate(states) if state)
    first = next(kept, None)
    if first is not None:
        write_records(path, itertools.chain([(_OWNER, 0, {}, history), first], kept))


class States(RecordFile):
    """Reader of restart states, and the history of their dataset; None without a readable file."""

    def __init__(self, path: Path):
        self.history: str | None = None
        with suppress(KeyError, OSError, CampaignError):
            super().__init__(path)
            self.history = self._read((_OWNER, 0))[1]

    def state(self, number: int) -> dict[str, np.ndarray]:
        """State after the last step of a case; empty if it was not kept, or is damaged."""
        with suppress(KeyError, OSError, CampaignError):
            return self._read((_STATE, number))[0]
        return {}


def read_flags(path: Path) -> dict[str, xr.Dataset]:
    """Flags ``converged`` in each group of a dataset."""
    with readable(path), xr.open_datatree(path, engine=engine_of(path), decode_timedelta=False) as tree:
        nodes = {node.path.strip("/"): node for node in tree.subtree if "converged" in node.data_vars}
        return {group: node.to_dataset()[["converged"]].load() for group, node in nodes.items()}


def unconverged(groups: Mapping[str, xr.Dataset]) -> Iterator[str]:
    """Yield a sentence for each theory and metastable branch with steps that did not converge."""
    for group, dataset in groups.items():
        if "converged" not in dataset:
            continue
        flags = dataset["converged"]
        labels = [dim for dim in LABELS if dim in flags.dims]
        for place in itertools.product(*(flags[dim].values for dim in labels)):
            chosen = dict(zip(labels, place, strict=True))
            own = flags.sel(chosen)
            failed, total = int((own == 0).sum()), int((own >= 0).sum())
            if failed:
                where = ", ".join(f'{dim}="{label}"' for dim, label in chosen.items())
                where = (f" at {where}" if where else "") + (f" in the group {group}" if group else "")
                yield (
                    f"{failed} of {total} steps did not converge{where}; see the variables converged and residual there"
                )


class _Quantity(NamedTuple):
    """A quantity of all cases: an array in memory, or a variable that is read piece by piece."""

    name: str
    dims: tuple[str, ...]
    values: Any


class DatasetReader:
    """Reader of the dataset of a study; a context. It and its cases raise InputError if it cannot be read."""

    def __init__(self, path: Path, study: Study):
        self.path = path
        self.study = study
        with readable(path):
            self.tree = xr.open_datatree(path, engine=engine_of(path), mask_and_scale=False, decode_timedelta=False)
            self.quantities = list(self._read_quantities())
        self.states = States(states_file(path))

    def __enter__(self) -> "DatasetReader":
        return self

    def __exit__(self, *_: Any) -> None:
        self.tree.close()

    def bins(self, own: Bins) -> Bins:
        """Bins of the distributions, from their centres; those of ``own`` for a distribution that is missing."""
        edges = {}
        for name in ("pressure", "gap"):
            with readable(self.path):
                there = (node[f"{name}_bin"].values for node in self.tree.subtree if f"{name}_bin" in node.coords)
                centres = next(there, None)
            if centres is not None:
                width = (centres[-1] - centres[0]) / (centres.size - 1)
                edges[f"{name}_edges"] = np.linspace(centres[0] - width / 2, centres[-1] + width / 2, centres.size + 1)
        return replace(own, **edges)

    def _read_quantities(self) -> Iterator[_Quantity]:
        """Yield the quantities of all groups; those larger than a distribution stay in the file."""
        sweep = self.study.sweep
        whole_study = {*sweep, *LABELS, "step", "pressure_bin", "gap_bin", *FIXED_COORDINATES}
        for node in self.tree.subtree:
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
    """A case in a finished dataset with these bins; it is read in place."""

    def __init__(self, dataset: DatasetReader, number: int, bins: Bins):
        self._dataset, self._number, self._bins = dataset, number, bins

    def _read(self, chosen: Callable[[_Quantity], bool], step: int = 0) -> dict[str, Any]:
        study = self._dataset.study
        place = {**dict(zip(study.sweep, study.cases[self._number].index, strict=True)), "step": step}
        with readable(self._dataset.path):
            found = {
                one.name: one.values[tuple(place.get(dim, slice(None)) for dim in one.dims)]
                for one in self._dataset.quantities
                if chosen(one)
            }
            return {name: own.values if isinstance(own, xr.Variable) else own for name, own in found.items()}

    @property
    def constants(self) -> dict[str, Any]:
        return self._read(lambda one: "step" not in one.dims)

    def step(self, number: int) -> tuple[dict[str, Any], Bins]:
        return self._read(lambda one: "step" in one.dims, number), self._bins

    def step_text(self, number: int, name: str) -> str | None:
        """A text of one step; None if the dataset has no such quantity."""
        found = self._read(lambda one: one.name == name, number)
        return str(found[name]) if found else None

    def state(self, number: int) -> dict[str, np.ndarray]:
        """Restart state after a step; empty unless it is the last one and was kept."""
        dataset = self._dataset
        if number != len(dataset.study.cases[self._number].path) - 1:
            return {}
        if _RESTART not in dataset.tree.children:
            current = dataset.states.history == dataset.tree.attrs.get("history")
            return dataset.states.state(self._number) if current else {}
        prefix = f"case_{self._number}_"
        with readable(dataset.path):
            kept = dataset.tree[_RESTART].data_vars.items()
            return {name[len(prefix) :]: state.values for name, state in kept if name.startswith(prefix)}
