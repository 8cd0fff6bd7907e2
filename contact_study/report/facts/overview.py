"""The first screen of a report as facts, and what happens along the paths and along the sweep."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr

from contact_study.physics.process_zone import resolving_shape
from contact_study.plots.curves import dissipated_energy
from contact_study.plots.selection import UNLOADING
from contact_study.report.align import cases
from contact_study.report.align.cases import Models, SweepPoint, select, sweep_points
from contact_study.report.align.deviations import COMPARED, split_pair
from contact_study.report.facts.ranking import AREA, TRAPPING, Ranking, mean_and_error
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.load_steps import swept_dims
from contact_study.results.schema import RESOLUTION_ERROR
from contact_study.results.state import usable

_NOISE = 1e-6  # of the work of adhesion: an energy that is the solver's tolerance


def lead_model(inputs: Inputs) -> str:
    """The model whose results stand for the contact: the continuum, else another simulation, else the first."""
    continuum = [name for name in inputs.simulations if entry_of(name).feels_law]
    return next(iter([*continuum, *inputs.simulations, *inputs.models]))


@dataclass(frozen=True)
class At:
    """A value at a state: point of the sweep and prescribed value."""

    value: float
    point: SweepPoint
    prescribed: float


def extent(models: Models, model: str, name: str) -> tuple[At, At] | None:
    """Least and largest mean over samples of a quantity of one model; None without a state in contact."""
    found = []
    for point, _, part in cases.parts_of({model: models[model]}, sweep_points(models)):
        if name in part:
            own = cases.series(part, name)
            states = zip(cases.case_points(part), own.values, own.fit, strict=True)
            found += [At(float(x), point, float(at[0])) for at, x, fit in states if at and fit and np.isfinite(x)]
    return (min(found, key=lambda at: at.value), max(found, key=lambda at: at.value)) if found else None


def constants_of(models: Models, name: str) -> list[float]:
    """Different values of a constant over the sweep, in its order."""
    values = (cases.first_constant(models, point, name) for point in sweep_points(models))
    return list(dict.fromkeys(float(f"{value:.4g}") for value in values if np.isfinite(value)))


@dataclass(frozen=True)
class Agreement:
    """Deviation of the contact area of one model from the reference over all states, relative; signs are left out."""

    model: str
    reference: str
    mean: float
    worst: At
    states: int


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
    for point, _, part in cases.parts_of({"": values.to_dataset(name="found")}, sweep_points(inputs.models)):
        both = zip(part["found"].values.ravel(), part[f"applied_{inputs.control}"].values.ravel(), strict=True)
        found += [At(abs(float(value)), point, float(at)) for value, at in both if np.isfinite(value)]
    if not found:
        return None
    worst = max(found, key=lambda at: (at.value, at.point.label, at.prescribed))
    return Agreement(*pair, float(np.mean([at.value for at in found])), worst, len(found))


def mean_distances(rankings: Sequence[Ranking]) -> dict[str, float]:
    """Distance of each model from the reference in contact area, the mean over the sweep; the nearest first."""
    found: dict[str, list[float]] = {}
    for one in (one for ranking in rankings for one in ranking.distances):
        found.setdefault(one.model, []).append(one.area)
    return dict(sorted(((name, float(np.mean(own))) for name, own in found.items()), key=lambda item: item[1]))


def effort(*datasets: xr.Dataset) -> tuple[int, int, int]:
    """Steps of some models, those that did not converge in contact, those that detached."""
    counts = []
    for dataset in datasets:
        solved = dataset["relative_contact_area"].notnull()
        detached = dataset.get("detached", xr.zeros_like(solved)) == 1
        failed = dataset.get("converged", xr.ones_like(solved)) == 0
        counts.append([int(states.sum()) for states in (solved, failed & ~detached, detached)])
    total, unconverged, apart = (sum(own) for own in zip(*counts, strict=True))
    return total, unconverged, apart


@dataclass(frozen=True)
class GridCheck:
    """Whether the grid of the continuum resolves contact edges."""

    coarse: dict[str, float]  # spacing over process zone where it may trap edges, by label of the point of the sweep
    points: int  # of the sweep with a process zone
    finest: float  # largest grid spacing over process zone
    shape: tuple[int, int]  # points along y and x that resolve every process zone
    edge: float  # without a process zone: largest share of the area that counting points adds at edges, NaN if unknown


def grid_check(inputs: Inputs, regime: xr.Dataset) -> GridCheck | None:
    """Whether the continuum's grid is fine enough; None without a continuum."""
    continuum = next((name for name in inputs.simulations if entry_of(name).feels_law), None)
    if continuum is None:
        return None
    own, ratios, shapes = inputs.models[continuum], {}, [(0, 0)]
    for point, _, setting in cases.parts_of({"": regime}, sweep_points(inputs.models)):
        ratio, zone = float(setting["pixel_over_process_zone"]), float(setting["process_zone"])
        if np.isfinite(ratio):
            ratios[point.label] = ratio
            y, x = (cases.first_constant(inputs.models, point, f"surface_size_{axis}") for axis in ("y", "x"))
            shapes.append(resolving_shape((y, x), zone) if np.isfinite(y * x) else (0, 0))
    coarse = {label: ratio for label, ratio in ratios.items() if ratio >= TRAPPING}
    edge = np.nan
    if not ratios and "corrected_contact_area" in own:
        counted = own["relative_contact_area"].where(own["relative_contact_area"] > 0)
        edge = float(np.abs(own["corrected_contact_area"] / counted - 1).max())
    y, x = map(max, zip(*shapes, strict=True))
    return GridCheck(coarse, len(ratios), max(ratios.values(), default=np.nan), (y, x), edge)


def overall(regime: xr.Dataset, name: str) -> list[float]:
    """Least and largest regime number over the sweep; empty where there is none."""
    values = regime[name].values[np.isfinite(regime[name].values)]
    return list(dict.fromkeys(float(end) for end in (values.min(), values.max()))) if values.size else []


@dataclass(frozen=True)
class Loop:
    """Events of adhesion along the path of one model at one point of the sweep; means over samples, NaN for none."""

    model: str
    at: SweepPoint
    pull_off: float  # lowest mean pressure in contact (Pa)
    below: float  # the pressure that the contact no longer carried (Pa)
    force: float  # pull-off force on the cell (N)
    lowest: float  # lowest mean pressure of the path in contact (Pa), below which a pull-off that was not reached lies
    jump_in: float  # mean pressure before the first jump into contact (Pa)
    dissipated: float  # energy between loading and unloading (J/m²)
    separation: float  # work of separation (J/m²)

    @property
    def reached(self) -> bool:
        """Whether the path passes the pull-off."""
        return bool(np.isfinite(self.pull_off))


def loops(inputs: Inputs) -> list[Loop]:
    """Loops of simulations that unload or pull where the law attracts, and pull-off of the theories beside them."""
    found = []
    for point, model, part in cases.parts_of(inputs.models):
        if not any(case.law.attracts for case in inputs.cases_at(point.selection)):
            continue
        pressure = part["mean_pressure"].where(usable(part))
        pulled = bool((part["branch"] == UNLOADING).any() or (pressure < 0).any())
        if "pull_off_pressure" not in part and not (pulled and entry_of(model).simulation):
            continue
        pull_off, error = (cases.constant(part, f"pull_off_pressure{name}") for name in ("", RESOLUTION_ERROR))
        names = "surface_size_y", "surface_size_x", "work_of_adhesion"
        y, x, work = (cases.first_constant(inputs.models, point, name) for name in names)
        lowest, jump_in = float(pressure.min()), cases.constant(part, "jump_in_pressure")
        energies = _dissipated(part, _NOISE * work), cases.constant(part, "work_of_separation")
        found.append(Loop(model, point, pull_off, pull_off - error, pull_off * y * x, lowest, jump_in, *energies))
    return found


def cycles(inputs: Inputs) -> dict[str, xr.Dataset]:
    """The cycles of the first simulation that has some, by point of the sweep, the strongest adhesion last."""
    for model in inputs.simulations:
        parts = cases.parts_of({model: inputs.models[model]}, sweep_points(inputs.models))
        first = {point.label: part.isel(dict.fromkeys(swept_dims(part), 0)) for point, _, part in parts}
        if found := {label: part for label, part in first.items() if np.isfinite(_dissipated(part))}:
            return found
    return {}


def _dissipated(part: xr.Dataset, noise: float = 0.0) -> float:
    """Energy of the cycle, of the first sample, zero below the noise; NaN where the path has none."""
    try:
        found = dissipated_energy(part.isel(dict.fromkeys(swept_dims(part), 0)))
    except ValueError:
        return np.nan
    return found if abs(found) > noise else 0.0


@dataclass(frozen=True)
class Difference:
    """Change of one model from one point of the sweep to the next along one key, the mean over shared states."""

    model: str
    before: SweepPoint
    after: SweepPoint
    states: int  # averaged over
    samples: int  # paired
    area: tuple[float, float]  # change of A/A₀ with its standard error over samples, NaN for none
    gap: tuple[float, float]  # change of the mean gap with its standard error (m), NaN for none


def differences(models: Models) -> list[Difference]:
    """Differences of every model along every swept key; empty without a sweep."""
    found = []
    for one, other in _neighbours(sweep_points(models)):
        for model, dataset in models.items():
            before, after = select(dataset, one), select(dataset, other)
            if before is None or after is None or before.identical(after):
                continue
            area, gap = (_change(before, after, name) for name in ("relative_contact_area", "mean_gap"))
            if area.size:
                means = (own.mean(axis=1) if own.size else np.full(1, np.nan) for own in (area, gap))
                found.append(Difference(model, one, other, *area.shape[::-1], *map(mean_and_error, means)))
    return found


def _neighbours(points: Sequence[SweepPoint]) -> Iterator[tuple[SweepPoint, SweepPoint]]:
    """Points that follow one another along one key, the others the same."""
    for key in points[0].selection:
        following = dict(pairwise(dict.fromkeys(point.selection[key] for point in points)))
        for one in points:
            wanted = {**one.selection, key: following.get(one.selection[key])}
            yield from ((one, other) for other in points if other.selection == wanted)


def _change(one: xr.Dataset, other: xr.Dataset, name: str) -> np.ndarray:
    """Differences at the states of the path that every sample has at both points, a sample a row."""
    if name not in one:
        return np.empty((1, 0))
    paths = [cases.case_points(part) for part in (one, other)]
    shared = [named for named in paths[0] if named is not None and named in paths[1]]
    rows = []
    for part, path in zip((one, other), paths, strict=True):
        values = part[name].where(usable(part))
        row = values.transpose(*swept_dims(values), "step").values.reshape(-1, part.sizes["step"])
        rows.append(row[:, [path.index(named) for named in shared]])
    change: np.ndarray = rows[1] - rows[0]
    return change[:, np.isfinite(change).all(axis=0)]
