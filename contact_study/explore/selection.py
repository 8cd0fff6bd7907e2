"""The part of datasets that a page shows: a case of each model, a state on its path, a field on few cells.

Datasets are read lazily: a page shows one state of thousands. Nothing here needs a browser.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.dataset.unfinished import read_unfinished
from contact_study.campaign.store.files import engine_of, is_dataset, readable, require_dataset
from contact_study.inputs import units
from contact_study.inputs.errors import InputError
from contact_study.plots.selection import UNLOADING, fit_states, label, one_state, touching
from contact_study.report.models import ShownModel, entry_of, known, of_file
from contact_study.report.read.datasets import tails
from contact_study.report.read.files import require_own
from contact_study.report.read.load_steps import positions, swept_dims
from contact_study.results.schema import LABELS

_PRESCRIBED = ("applied_pressure", "applied_gap", "applied_approach")
_PLANE = {"y", "x", "y_index", "x_index", "node", "site_y", "site_x"}  # dimensions of what is read state by state
FIELDS = ("gap", "pressure", "height", "contact", "clusters")
"""What a map can show: fields of a dataset, and two that follow from the gap."""


@dataclass(frozen=True)
class Model:
    """One model of one file."""

    name: str  # of its entry
    path: Path
    dataset: xr.Dataset  # read lazily

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
        part = self.dataset.isel(places)
        part = part.swap_dims({f"{axis}_index": axis for axis in ("y", "x") if f"{axis}_index" in part.dims})
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
            found[name] = Model(name, path, root)
            continue
        for one in filter(known, map(str, np.atleast_1d(root[theory].values))):
            own = root.sel({theory: one}) if theory in root.dims else root
            found[of_file(one, ends[path])] = Model(of_file(one, ends[path]), path, own.drop_vars(theory))
    return found


def _open(path: Path) -> xr.Dataset:
    if not is_dataset(path) and (growing := read_unfinished(path)) is not None:
        return growing
    require_dataset(path)
    with readable(path):
        root = xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False)
    require_own(path, root.attrs)
    if "step" not in root.dims:
        raise InputError(f"{path}: holds no load steps; give the dataset of a run")
    return root


def sweep_menus(models: Mapping[str, Model]) -> dict[str, dict[str, Any]]:
    """The swept keys with more than one value over all models: values by the words of a menu."""
    menus: dict[str, dict[str, Any]] = {}
    for model in models.values():
        for dim in swept_dims(model.dataset):
            coordinate = model.dataset[dim]
            words = {label(coordinate, one).rpartition("= ")[2]: one for one in coordinate.values}
            menus[dim] = menus.get(dim, {}) | words
    return {dim: words for dim, words in menus.items() if len(words) > 1}


@dataclass(frozen=True)
class LoadPath:
    """The states of one case along its path, as far as there are any."""

    steps: np.ndarray  # their numbers
    prescribed: np.ndarray  # pressure (Pa) or distance (m)
    unloading: np.ndarray  # whether each is on the way back
    fit: np.ndarray  # whether each converged in contact
    words: tuple[str, ...]  # each for a slider

    def nearest(self, other: "LoadPath", place: int) -> int:
        """Place of the state nearest in load to one of another path, on the same branch if there is one."""
        same = self.unloading == other.unloading[place]
        same = same if same.any() else np.ones(same.shape, bool)
        distance = np.abs(self.prescribed - other.prescribed[place])
        return int(np.argmin(np.where(same, distance, np.inf)))


def load_path(case: xr.Dataset) -> LoadPath:
    """The path of one case; states that a growing dataset lacks are left out."""
    name = next(name for name in _PRESCRIBED if name in case.coords)
    prescribed = case[name].values
    steps = np.flatnonzero(np.isfinite(prescribed))
    back = case["branch"].values[steps] == UNLOADING if "branch" in case else np.zeros(steps.shape, bool)
    what = name.removeprefix("applied_")
    write = units.stress if what == "pressure" else units.length
    head = "" if what == "pressure" else f"{what} "
    words = tuple(
        f"{head}{'−' if value < 0 else ''}{write(abs(value)) if value else 0}, {'unloading' if way else 'loading'}"
        for value, way in zip(prescribed[steps], back, strict=True)
    )
    return LoadPath(steps, prescribed[steps], back, fit_states(case)[steps], words)


def fields_of(case: xr.Dataset) -> list[str]:
    """The fields of a case that maps can show."""
    there = {"contact": "gap", "clusters": "gap"}
    return [name for name in FIELDS if there.get(name, name) in case and "y" in case.dims]


def state_of(case: xr.Dataset, step: int, field: str) -> xr.Dataset:
    """One state in memory with what a map of a field needs; ValueError where the dataset does not keep it."""
    needs = {"gap": ["gap"], "contact": ["gap"], "clusters": ["gap"]}.get(field, [field])
    if needs == ["gap"] and float(case["contact_distance"].values) == 0 and "pressure" in case:
        needs.append("pressure")  # tells contact from surfaces that are just apart
    if field == "section":
        needs += ["gap", "height"]
        needs.remove("section")
    scalars = [str(name) for name, variable in case.data_vars.items() if not {*variable.dims} - {"step"}]
    kept = [name for name in needs if name in case]
    return one_state(case[[*kept, *scalars]].isel(step=step).load(), *needs)


def field_of(state: xr.Dataset, name: str) -> np.ndarray:
    """A field of a state (SI) for a map; contact is one and the rest zero."""
    return touching(state).astype(np.float32) if name == "contact" else state[name].values


def reduced(field: np.ndarray, shape: tuple[int, int], of: Any = np.add) -> np.ndarray:
    """A field on at most ``shape`` cells: the mean of the points of each, or another reduction ``of`` them."""
    for axis, most in enumerate(shape):
        size = field.shape[axis]
        if size > most:
            edges = np.linspace(0, size, most, endpoint=False).astype(int)
            field = of.reduceat(field, edges, axis=axis)
            if of is np.add:
                counts = np.diff([*edges, size])
                field = field / (counts[:, None] if axis == 0 else counts)
    return field


def difference(one: xr.Dataset, other: xr.Dataset, name: str) -> np.ndarray:
    """A field of one state minus that of another; ValueError if they are not on the same points."""
    first, second = (field_of(state, name) for state in (one, other))
    if first.shape != second.shape:
        sizes = " and ".join(" × ".join(map(str, field.shape)) for field in (first, second))
        raise ValueError(f"the states have {sizes} points: their difference needs the same")
    return first - second


def nearest_point(x: np.ndarray, y: np.ndarray, at: tuple[float, float], spans: tuple[float, float]) -> int | None:
    """Number of the point of a curve nearest to a place on a screen that shows these spans; None without points."""
    distance = np.hypot((x - at[0]) / spans[0], (y - at[1]) / spans[1])
    return int(np.nanargmin(distance)) if np.isfinite(distance).any() else None
