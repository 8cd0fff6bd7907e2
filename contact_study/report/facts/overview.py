"""The first screen of a report as facts: the problem in numbers and its tiles."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from contact_study.report.align.cases import SweepPoint, case_points, first_constant, select, series, sweep_points
from contact_study.report.align.deviations import COMPARED, split_pair
from contact_study.report.facts.ranking import AREA, TRAPPING, Ranking
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs

_POINTS = 4  # of a grid that resolves a process zone


@dataclass(frozen=True)
class Extent:
    """Least and largest value over states, each with where it is: point of the sweep and prescribed value."""

    low: float
    high: float
    low_at: tuple[SweepPoint, float]
    high_at: tuple[SweepPoint, float]


@dataclass(frozen=True)
class Agreement:
    """Deviation of the contact area of one model from the reference over all states, relative; signs are left out."""

    model: str
    reference: str
    mean: float
    worst: float
    at: str  # point of the sweep of the worst
    prescribed: float  # pressure or gap of the worst
    states: int


@dataclass(frozen=True)
class Steps:
    """How the steps of all models ended."""

    total: int
    unconverged: int
    detached: int
    models: int


@dataclass(frozen=True)
class GridCheck:
    """Whether the grid of the continuum resolves contact edges.

    Attributes
    ----------
    coarse : dict
        Grid spacing over process zone where it may trap edges, by label of the point of the sweep.
    points : int
        Points of the sweep with a process zone.
    finest : float
        Largest grid spacing over process zone.
    shape : tuple of int
        Points along y and x that resolve every process zone.
    edge : float
        Without a process zone: largest share of the area that counting points adds at contact edges, NaN if unknown.
    """

    coarse: dict[str, float]
    points: int
    finest: float
    shape: tuple[int, int]
    edge: float


def lead_model(inputs: Inputs) -> str:
    """The model whose results stand for the contact: the continuum, else another simulation, else the first."""
    continuum = [name for name in inputs.simulations if entry_of(name).feels_law]
    return next(iter([*continuum, *inputs.simulations, *inputs.models]))


def extent(models: Mapping[str, xr.Dataset], model: str, name: str, control: str) -> Extent | None:
    """Least and largest mean over samples of a quantity of one model; None without a state in contact."""
    found = []
    for point in sweep_points(models):
        part = select(models[model], point)
        if part is None or name not in part:
            continue
        own = series(part, name)
        for named, value, fit in zip(case_points(part, control), own.values, own.fit, strict=True):
            if named is not None and fit and np.isfinite(value):
                found.append((float(value), (point, float(named[0]))))
    if not found:
        return None
    (low, low_at), (high, high_at) = (choose(found, key=lambda state: state[0]) for choose in (min, max))
    return Extent(low, high, low_at, high_at)


def constants_of(models: Mapping[str, xr.Dataset], name: str) -> list[float]:
    """Different values of a constant over the sweep, in its order."""
    values = (first_constant(models, point, name) for point in sweep_points(models))
    return list(dict.fromkeys(float(f"{value:.4g}") for value in values if np.isfinite(value)))


def agreement(inputs: Inputs, deviations: xr.Dataset | None) -> Agreement | None:
    """How two simulations agree in contact area, by the means over samples; None without two."""
    if deviations is None or AREA not in deviations:
        return None
    pairs = [split_pair(str(pair)) for pair in deviations["pair"].values]
    pair = next((pair for pair in pairs if set(pair) <= {*inputs.simulations}), None)
    if pair is None:
        return None
    own = deviations.sel(pair=" - ".join(pair))
    values = own[f"{AREA}_mean"] if f"{AREA}_mean" in own else own[AREA].where(own["state"] == COMPARED)
    found = []
    for point in sweep_points(inputs.models):
        part = select(values.to_dataset(name="found"), point)
        if part is None:
            continue
        applied = part["found"][f"applied_{inputs.control}"]
        found += [
            (abs(float(value)), point.label, float(at))
            for value, at in zip(part["found"].values.ravel(), applied.values.ravel(), strict=True)
            if np.isfinite(value)
        ]
    if not found:
        return None
    worst, at, prescribed = max(found)
    return Agreement(*pair, float(np.mean([value for value, _, _ in found])), worst, at, prescribed, len(found))


def mean_distances(rankings: Sequence[Ranking]) -> dict[str, float]:
    """Distance of each model from the reference in contact area, the mean over the sweep; the nearest first."""
    found: dict[str, list[float]] = {}
    for ranking in rankings:
        for one in ranking.distances:
            found.setdefault(one.model, []).append(one.area)
    return dict(sorted(((name, float(np.mean(own))) for name, own in found.items()), key=lambda item: item[1]))


def steps(models: Mapping[str, xr.Dataset]) -> Steps:
    """Count the steps of all models by how they ended."""
    total, unconverged, detached = (sum(own) for own in zip(*(effort(one) for one in models.values()), strict=True))
    return Steps(total, unconverged, detached, len(models))


def effort(dataset: xr.Dataset) -> tuple[int, int, int]:
    """Steps of one model, those that did not converge in contact, those that detached."""
    solved = dataset["relative_contact_area"].notnull()
    detached = dataset["detached"] == 1 if "detached" in dataset else xr.zeros_like(solved)
    unconverged = (dataset["converged"] == 0) & ~detached if "converged" in dataset else xr.zeros_like(solved)
    return int(solved.sum()), int(unconverged.sum()), int(detached.sum())


def grid_check(inputs: Inputs, regime: xr.Dataset) -> GridCheck | None:
    """Whether the continuum's grid is fine enough; None without a continuum."""
    continuum = next((name for name in inputs.simulations if entry_of(name).feels_law), None)
    if continuum is None:
        return None
    own, ratios, shapes = inputs.models[continuum], {}, [(0, 0)]
    for point in sweep_points(inputs.models):
        setting = select(regime, point)
        ratio = float(setting["pixel_over_process_zone"]) if setting is not None else np.nan
        if np.isfinite(ratio):
            ratios[point.label] = ratio
            zone = float(setting["process_zone"]) if setting is not None else np.nan
            y, x = (first_constant(inputs.models, point, f"surface_size_{axis}") for axis in ("y", "x"))
            shapes.append((_points(y / zone), _points(x / zone)))
    coarse = {label: ratio for label, ratio in ratios.items() if ratio >= TRAPPING}
    shape = max(y for y, _ in shapes), max(x for _, x in shapes)
    edge = np.nan
    if not ratios and "corrected_contact_area" in own:
        counted = own["relative_contact_area"].where(own["relative_contact_area"] > 0)
        edge = float(np.abs(own["corrected_contact_area"] / counted - 1).max())
    return GridCheck(coarse, len(ratios), max(ratios.values(), default=np.nan), shape, edge)


def _points(zones: float) -> int:
    """Points along a side of so many process zones: even, with small prime factors."""
    from scipy.fft import next_fast_len  # slow to import

    return 2 * int(next_fast_len(math.ceil(_POINTS * zones / 2), real=True)) if np.isfinite(zones) else 0


def overall(regime: xr.Dataset, name: str) -> list[float]:
    """Least and largest regime number over the sweep; empty where there is none."""
    values = regime[name].values[np.isfinite(regime[name].values)]
    ends: tuple[Callable[..., float], ...] = (np.min, np.max)
    return list(dict.fromkeys(float(end(values)) for end in ends)) if values.size else []
