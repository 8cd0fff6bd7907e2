"""Points of the sweep as a reader sees them: one colour, one name and one set of units each, seeds averaged."""

import itertools
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from contact_study.plots.style import Unit, largest, length_unit, pressure_unit
from contact_study.report.models import entry_of
from contact_study.report.read.load_steps import averaged, swept_dims
from contact_study.report.text.wording import PRESCRIBED, coordinate_label
from contact_study.results.schema import REALISED
from contact_study.results.state import usable
from contact_study.study.case import PathPoint, path_points

_AREA = "relative_contact_area"

Models = Mapping[str, xr.Dataset]
"""Datasets by the names of their models."""


@dataclass(frozen=True)
class SweepPoint:
    """One point of the sweep, all its seeds together."""

    selection: dict[str, Any]  # swept coordinates but the seed
    label: str  # the coordinates in words
    colour: int = 0  # number of its colour


def sweep_points(models: Models) -> list[SweepPoint]:
    """Points of the sweep that some model has, in their order."""
    lead = max(models.values(), key=lambda dataset: len(swept_dims(dataset)))
    dims = [dim for dim in swept_dims(lead) if dim != averaged(lead)]
    values = [
        list(dict.fromkeys(v for dataset in models.values() if dim in dataset.dims for v in dataset[dim].values))
        for dim in dims
    ]
    several = [dim for dim, own in zip(dims, values, strict=True) if len(own) > 1] or dims
    points: list[SweepPoint] = []
    for combination in itertools.product(*values):
        selection = dict(zip(dims, combination, strict=True))
        names = [coordinate_label(dim, selection[dim], lead[dim].attrs.get("units", "1")) for dim in several]
        points.append(SweepPoint(selection, ", ".join(names), len(points)))
    return points


def select(dataset: xr.Dataset, point: SweepPoint) -> xr.Dataset | None:
    """The part of a dataset at one point of the sweep, or None where it has none."""
    chosen = {dim: value for dim, value in point.selection.items() if dim in dataset.dims}
    if any(value not in dataset[dim].values for dim, value in chosen.items()):
        return None
    return dataset.sel(chosen)


def parts_of(models: Models, points: list[SweepPoint] | None = None) -> Iterator[tuple[SweepPoint, str, xr.Dataset]]:
    """Part of each model at each point of the sweep, theirs unless others are given."""
    for point in points or sweep_points(models):
        for model, dataset in models.items():
            if (part := select(dataset, point)) is not None:
                yield point, model, part


def strongest(points: list[SweepPoint]) -> SweepPoint:
    """The point of the strongest adhesion, or the last one of another sweep."""
    for key in ("well_depth_ratio", "work_of_adhesion"):
        if all(key in point.selection for point in points):
            return max(points, key=lambda point: point.selection[key])
    return points[-1]


@dataclass(frozen=True)
class Series:
    """One quantity at each step of the path of one point of the sweep, averaged over the seeds that may be compared."""

    values: np.ndarray  # mean over seeds, or what the solver left where none converged; NaN where surfaces detached
    standard_error: np.ndarray  # NaN with fewer than two seeds or without scatter
    fit: np.ndarray  # whether some seed converged in contact
    samples: np.ndarray  # seeds averaged


def series(part: xr.Dataset, name: str) -> Series:
    """A quantity on ``step`` of a part that :func:`select` gave."""
    steps = part.sizes["step"]
    flags = {name: _by_seed(part, name, steps) for name in (_AREA, "converged", "detached") if name in part}
    values: np.ndarray = np.where(flags.get("detached", 0) == 1, np.nan, _by_seed(part, name, steps))
    good = usable(flags) & ~np.isnan(values)
    samples: np.ndarray = good.sum(axis=0)
    if not swept_dims(part[name]):
        return Series(values[0], np.full(steps, np.nan), good[0], samples)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a point without any seed has no mean
        mean: np.ndarray = np.nanmean(np.where(good, values, np.nan), axis=0)
        scatter = np.nanstd(np.where(good, values, np.nan), axis=0, ddof=1)
        left: np.ndarray = np.nanmean(values, axis=0)
    # A theory of the ensemble gives every seed the same number up to rounding: no error, rather than one of zero.
    known = (samples > 1) & (scatter > 1e-12 * np.abs(mean))
    error = np.where(known, scatter, np.nan) / np.sqrt(np.maximum(samples, 1))
    return Series(np.where(samples > 0, mean, left), error, samples > 0, samples)


def _by_seed(part: xr.Dataset, name: str, steps: int) -> np.ndarray:
    """A variable on seed and step; a variable without seeds is one for all."""
    return part[name].transpose(*swept_dims(part[name]), "step").values.astype(float).reshape(-1, steps)


def control_of(part: xr.Dataset) -> str:
    """The quantity that the path of a dataset prescribes."""
    return next(control for control in PRESCRIBED if f"applied_{control}" in part.coords)


def case_points(part: xr.Dataset) -> list[PathPoint | None]:
    """Points of the path of a part that :func:`select` gave; all its seeds walk the same."""
    prescribed, branch = part[f"applied_{control_of(part)}"], part["branch"]
    first = (variable.isel(dict.fromkeys(swept_dims(variable), 0)).values for variable in (prescribed, branch))
    return path_points(*first)


def state_at(dataset: xr.Dataset, point: SweepPoint, named: PathPoint) -> xr.Dataset | None:
    """One state of the path of one point of the sweep; None where the dataset has none."""
    part = select(dataset, point)
    if part is None or named not in (path := case_points(part)):
        return None
    return part.isel(step=path.index(named))


def constant(part: xr.Dataset, name: str) -> float:
    """A number of the whole path, its mean over seeds; NaN where the dataset has none.

    Where its key is swept, it is what the model has, not what was asked for.
    """
    own = next((known for known in (f"{REALISED}{name}", name) if known in part), None)
    return float("nan") if own is None else float(part[own].mean())


def first_constant(models: Models, point: SweepPoint, name: str) -> float:
    """A number from the first model that has it; what was given comes before what a model measured on itself."""
    for model in sorted(models, key=lambda model: entry_of(model).measured):
        part = select(models[model], point)
        if part is not None and np.isfinite(value := constant(part, name)):
            return value
    return float("nan")


@dataclass(frozen=True)
class Scales:
    """Units of the axes at one point of the sweep, the same for every model."""

    contact_modulus: float  # E* (Pa)
    rms_height: float  # h_rms (m), or one nanometre for a surface without roughness
    rough: bool = True

    @property
    def height_symbol(self) -> str:
        """Unit of gaps in words."""
        return "h_rms" if self.rough else "nm"


def scales(models: Models, point: SweepPoint) -> Scales:
    """E* and h_rms of a point of the sweep, as the continuum was given them."""
    rms_height = first_constant(models, point, "rms_height")
    rough = bool(np.isfinite(rms_height) and rms_height > 0)
    return Scales(first_constant(models, point, "contact_modulus"), rms_height if rough else 1e-9, rough)


def mean_unit(models: Models, name: str) -> Unit:
    """The unit of mean pressures, or of mean gaps."""
    most = max((largest(dataset[name]) for dataset in models.values() if name in dataset), default=0.0)
    return pressure_unit(most) if name == "mean_pressure" else length_unit(most)
