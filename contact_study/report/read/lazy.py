"""Datasets whose fields stay in their files, and runs that are not finished: for views of one state of thousands."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.dataset.unfinished import read_unfinished
from contact_study.campaign.store.files import engine_of, is_dataset, mark_of, readable, require_dataset
from contact_study.inputs.errors import InputError
from contact_study.plots.selection import on_axes
from contact_study.report.models import ShownModel, entry_of, known, of_file
from contact_study.report.read.datasets import tails
from contact_study.report.read.files import require_own
from contact_study.report.read.load_steps import positions, swept_dims
from contact_study.results.schema import LABELS

_PLANE = {"y", "x", "y_index", "x_index", "node", "site_y", "site_x"}  # dimensions of what is read state by state


@dataclass(frozen=True)
class Model:
    """One model of one file."""

    name: str  # of its entry
    path: Path
    dataset: xr.Dataset  # read lazily
    root: xr.Dataset  # that of the file, with all its theories

    @property
    def entry(self) -> ShownModel:
        return entry_of(self.name)

    def case(self, chosen: Mapping[str, Any]) -> xr.Dataset | None:
        """The case at a point of the sweep, its fields still in the file; None where the model has no such point.

        Keys that the model does not sweep do not count; one that is not chosen has its first value.
        """
        dims = {dim: self.dataset[dim].values for dim in swept_dims(self.dataset)}
        try:
            places = dict.fromkeys(dims, 0) | positions(dims, chosen)
        except KeyError:
            return None
        part = on_axes(self.dataset.isel(places))
        for variable in part.variables.values():
            if not _PLANE.intersection(variable.dims):
                variable.load()
        return part


def open_models(paths: Sequence[Path]) -> dict[str, Model]:
    """Open the models of one or several datasets, or of runs that are not finished, by name in the order given.

    Raises
    ------
    InputError
        If a path leads to no dataset of this project.
    """
    roots = {path: _open(path) for path in dict.fromkeys(paths)}
    ends = tails({path: str(root.attrs["model"]) for path, root in roots.items()})
    found: dict[str, Model] = {}
    theory = LABELS[0]
    for path, root in roots.items():
        if theory not in root.coords:
            name = of_file(str(root.attrs["model"]), ends[path])
            found[name] = Model(name, path, root, root)
            continue
        for one in filter(known, map(str, np.atleast_1d(root[theory].values))):
            own, name = root.sel({theory: one}) if theory in root.dims else root, of_file(one, ends[path])
            found[name] = Model(name, path, own.drop_vars(theory), root)
    return found


def _open(path: Path) -> xr.Dataset:
    if not is_dataset(path) and (growing := read_unfinished(path)) is not None:
        return growing
    require_dataset(path)
    return _opened(path.resolve(), mark_of(path))


# The netCDF library (4.10, HDF5 2.2) crashes after one of two openings of a file in a process is closed.
@lru_cache(maxsize=256)
def _opened(path: Path, _: tuple[int, ...] | None) -> xr.Dataset:
    """The root of a dataset, opened once for all as long as the file there is the same."""
    with readable(path):
        root = xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False)
    require_own(path, root.attrs)
    if "step" not in root.dims:
        raise InputError(f"{path}: holds no load steps; give the dataset of a run")
    return root
