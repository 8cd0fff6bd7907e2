"""The part of datasets that a page shows: a case of each model, a state on its path, a field on few cells.

Datasets are read lazily: a page shows one state of thousands. Nothing here needs a browser.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from contact_study.inputs import units
from contact_study.plots.selection import UNLOADING, fit_states, label, one_state, touching
from contact_study.report.read.lazy import Model
from contact_study.report.read.load_steps import swept_dims

_PRESCRIBED = ("applied_pressure", "applied_gap", "applied_approach")
_NEEDS = {"contact": ("gap",), "clusters": ("gap",), "section": ("gap", "height")}
FIELDS = ("gap", "pressure", "height", "contact", "clusters")
"""What a map can show: fields of a dataset, and two that follow from the gap."""


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
    return [name for name in FIELDS if "y" in case.dims and all(need in case for need in _NEEDS.get(name, (name,)))]


def state_of(case: xr.Dataset, step: int, *fields: str) -> xr.Dataset:
    """One state in memory with what maps of fields, or a ``"section"``, need; ValueError where it is not kept.

    A section is left out where the dataset has no heights.
    """
    needs = [name for field in fields for name in _NEEDS.get(field, (field,)) if field != "section" or name in case]
    if "height" in needs:
        case["height"].load()  # once for all states
    if "gap" in needs and float(case["contact_distance"].values) == 0 and "pressure" in case:
        needs.append("pressure")  # tells contact from surfaces that are just apart
    scalars = [str(name) for name, variable in case.data_vars.items() if not {*variable.dims} - {"step"}]
    kept = [name for name in needs if name in case]
    return one_state(case[[*kept, *scalars]].isel(step=step).load(), *needs)


def field_of(state: xr.Dataset, name: str) -> np.ndarray:
    """A field of a state (SI) for a map; contact is one and the rest zero."""
    return touching(state).astype(np.float32) if name == "contact" else state[name].values


def block_of(size: int, most: int) -> int:
    """How many points a cell of a map is wide, for ``most`` cells at most."""
    return -(-size // most)


def reduced(field: np.ndarray, most: int, of: Any = np.add) -> np.ndarray:
    """A field on at most ``most`` cells a side, the last of each side perhaps smaller: means, or a reduction ``of``."""
    for axis in (0, 1):
        block = block_of(field.shape[axis], most)
        if block > 1:
            field = np.moveaxis(field, axis, 0)
            whole = len(field) // block * block
            cells = of.reduce(field[:whole].reshape(-1, block, field.shape[1]), axis=1) / (block if of is np.add else 1)
            if whole < len(field):
                rest = of.reduce(field[whole:], axis=0) / (len(field) - whole if of is np.add else 1)
                cells = np.concatenate([cells, rest[None]])
            field = np.moveaxis(cells, 0, axis)
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


def in_words(model: Model, case: xr.Dataset, path: LoadPath, place: int) -> str:
    """One state in a line of text, for everyone and for readers of screens."""
    step = int(path.steps[place])
    words = [f"{model.entry.label}, {path.words[place]}"]
    if "relative_contact_area" in case:
        words.append(f"contact area {float(case['relative_contact_area'][step]):.3g} A₀")
    if "mean_gap" in case and np.isfinite(gap := float(case["mean_gap"][step])):
        words.append(f"mean gap {'−' if gap < 0 else ''}{units.length(abs(gap))}")
    if not path.fit[place]:
        words.append("not converged, or detached")
    return " · ".join(words)
