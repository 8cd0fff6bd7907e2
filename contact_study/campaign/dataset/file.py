"""The dataset's file: written by rename, and taken apart into its cases again."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.dataset.formats import engine_of, is_zarr
from contact_study.campaign.files import write_aside
from contact_study.campaign.schema import COORDINATES, LABELS, TRAJECTORY, variable_of
from contact_study.problem.sweep import SweptKey

# Group of the states from which paths can be gone on with; no quantity, and nothing for a reader.
RESTART = "restart"

_CHUNK_POINTS = 2**19


def write_dataset(path: Path, groups: Mapping[str, xr.Dataset]) -> None:
    """Write the groups of one dataset; a file by rename, a folder of Zarr as it is."""
    if is_zarr(path):
        _write_zarr(path, groups)
        return

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


def _write_zarr(path: Path, groups: Mapping[str, xr.Dataset]) -> None:
    import zarr  # an extra

    for group, dataset in groups.items():
        encoding = (
            {} if group == RESTART else {str(name): _of_zarr(str(name), v) for name, v in dataset.variables.items()}
        )
        # Format 2 is the one that says how text is kept; an index of all groups is made at the end.
        mode: Any = "a" if group else "w"
        dataset.to_zarr(path, mode=mode, group=group or None, encoding=encoding, zarr_format=2, consolidated=False)
    zarr.consolidate_metadata(str(path), zarr_format=2)


def _of_zarr(name: str, variable: xr.Variable) -> dict[str, Any]:
    """The encoding in the words of Zarr, which compresses of itself."""
    known = _encoding(name, variable)
    kept = {key: value for key, value in known.items() if key in ("_FillValue", "dtype")}
    return {**kept, "chunks": known["chunksizes"]} if "chunksizes" in known else kept


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
        self._tree = xr.open_datatree(path, engine=engine_of(path), mask_and_scale=False, decode_timedelta=False)

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
        """Quantities of all groups at a position of the sweep as a model names them, those of the whole study apart."""
        whole = {*self._sweep, *LABELS, "step", "pressure_bin", "gap_bin", "relative_distance"}
        for node in self._tree.subtree:
            group = node.path.strip("/")
            if group == RESTART:
                continue
            dataset = node.to_dataset(inherit=False)
            for name, variable in dataset.variables.items():
                if name in whole or (group and name in COORDINATES):
                    continue
                chosen = {dim: i for dim, i in zip(self._sweep, index, strict=True) if dim in variable.dims}
                dims = [dim for dim in LABELS if dim in variable.dims]
                above = [TRAJECTORY] if group == TRAJECTORY else []
                for place in np.ndindex(*(variable.sizes[dim] for dim in dims)):
                    labelled = dict(zip(dims, place, strict=True))
                    # A group inherits the labels that the root has, too.
                    labels = [str(node[dim].values[i]) for dim, i in labelled.items()]
                    yield "/".join([*above, *labels, str(name)]), variable.isel(chosen | labelled)


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
