"""Points of the sweep as a reader sees them: one colour and one name each, seeds averaged."""

import itertools
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from contact_study.report.models import entry_of
from contact_study.report.read.load_steps import averaged, samples_in, swept_dims
from contact_study.report.text.wording import coordinate_label
from contact_study.results.schema import REALISED
from contact_study.results.state import usable
from contact_study.study.load_steps import PathPoint, path_points

_AREA = "relative_contact_area"


@dataclass(frozen=True)
class SweepPoint:
    """One point of the sweep, all its seeds together."""

    selection: dict[str, Any]  # swept coordinates but the seed
    label: str  # the coordinates in words


def sweep_points(models: Mapping[str, xr.Dataset]) -> list[SweepPoint]:
    """Points of the sweep that some model has, in their order."""
    lead = max(models.values(), key=lambda dataset: len(swept_dims(dataset)))
    dims = [dim for dim in swept_dims(lead) if dim != averaged(lead)]
    values = [
        list(dict.fromkeys(v for dataset in models.values() if dim in dataset.dims for v in dataset[dim].values))
        for dim in dims
    ]
    several = [dim for dim, own in zip(dims, values, strict=True) if len(own) > 1] or dims
    points = []
    for combination in itertools.product(*values):
        selection = dict(zip(dims, combination, strict=True))
        names = [coordinate_label(dim, selection[dim], lead[dim].attrs.get("units", "1")) for dim in several]
        points.append(SweepPoint(selection, ", ".join(names)))
    return points


def select(dataset: xr.Dataset, point: SweepPoint) -> xr.Dataset | None:
    """The part of a dataset at one point of the sweep, or None where it has none."""
    chosen = {dim: value for dim, value in point.selection.items() if dim in dataset.dims}
    if any(value not in dataset[dim].values for dim, value in chosen.items()):
        return None
    return dataset.sel(chosen)


def strongest(points: list[SweepPoint]) -> SweepPoint:
    """The point of the strongest adhesion, or the last one of another sweep."""
    for key in ("well_depth_ratio", "work_of_adhesion"):
        if all(key in point.selection for point in points):
            return max(points, key=lambda point: point.selection[key])
    return points[-1]


@dataclass(frozen=True)
class Series:
    """One quantity along the path of one point of the sweep, averaged over the seeds that may be compared.

    Attributes
    ----------
    values, standard_error : numpy.ndarray, shape (steps,)
        Mean over seeds and its standard error, NaN with fewer than two or without scatter; both NaN where the
        surfaces have detached. A point none of whose seeds converged keeps what the solver left and is not ``fit``.
    fit : numpy.ndarray of bool, shape (steps,)
        Whether some seed converged in contact.
    samples : numpy.ndarray of int, shape (steps,)
        Seeds averaged.
    """

    values: np.ndarray
    standard_error: np.ndarray
    fit: np.ndarray
    samples: np.ndarray


def series(part: xr.Dataset, name: str) -> Series:
    """A quantity on ``step`` of a part that :func:`select` gave."""
    steps = part.sizes["step"]
    flags = {name: _by_seed(part, name, steps) for name in (_AREA, "converged", "detached") if name in part}
    values: np.ndarray = np.where(flags.get("detached", 0) == 1, np.nan, _by_seed(part, name, steps))
    good = usable(flags) & ~np.isnan(values)
    samples: np.ndarray = good.sum(axis=0)
    if not samples_in(part[name]):
        return Series(values[0], np.full(steps, np.nan), good[0], samples)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a point without any seed has no mean
        mean: np.ndarray = np.nanmean(np.where(good, values, np.nan), axis=0)
        scatter = np.nanstd(np.where(good, values, np.nan), axis=0, ddof=1)
        left: np.ndarray = np.nanmean(values, axis=0)
    # A theory of the ensemble gives every seed the same number up to rounding: no error, rather than one of zero.
    error = np.where((samples > 1) & (scatter > 1e-12 * np.abs(mean)), scatter, np.nan) / np.sqrt(
        np.maximum(samples, 1)
    )
    return Series(np.where(samples > 0, mean, left), error, samples > 0, samples)


def _by_seed(part: xr.Dataset, name: str, steps: int) -> np.ndarray:
    """A variable on seed and step; a variable without seeds is one for all."""
    return part[name].transpose(*samples_in(part[name]), "step").values.astype(float).reshape(-1, steps)


def case_points(part: xr.Dataset, control: str) -> list[PathPoint | None]:
    """Points of the path of a part that :func:`select` gave; all its seeds walk the same."""
    prescribed, branch = part[f"applied_{control}"], part["branch"]
    first = (variable.isel(dict.fromkeys(samples_in(variable), 0)).values for variable in (prescribed, branch))
    return path_points(*first)


def constant(part: xr.Dataset, name: str) -> float:
    """A number of the whole path, its mean over seeds; NaN where the dataset has none.

    Where its key is swept, it is what the model has, not what was asked for.
    """
    own = next((known for known in (f"{REALISED}{name}", name) if known in part), None)
    return float("nan") if own is None else float(part[own].mean())


def first_constant(models: Mapping[str, xr.Dataset], point: SweepPoint, name: str) -> float:
    """A number from the first model that has it; what was given comes before what a model measured on itself."""
    for model in sorted(models, key=lambda model: entry_of(model).measured):
        part = select(models[model], point)
        if part is not None and np.isfinite(value := constant(part, name)):
            return value
    return float("nan")
