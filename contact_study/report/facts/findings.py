"""Findings of a comparison: rankings, extremes of each pair, ranges of each model, scatter."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from contact_study.plots.style import length_unit, pressure_unit
from contact_study.report.align.cases import SweepPoint, case_points, select, sweep_points
from contact_study.report.align.deviations import COMPARED, compute_deviations, split_pair
from contact_study.report.align.scales import scales
from contact_study.report.facts.ranking import AREA, GAP, Ranking, rank_models
from contact_study.report.models import TARGET, entry_of, kind_of, spectrum_of
from contact_study.report.read.load_steps import averaged, on_common_path, samples_in
from contact_study.report.text.rendering import paragraphs
from contact_study.report.text.wording import PRESCRIBED, number
from contact_study.results.state import usable
from contact_study.study.load_steps import PathPoint


@dataclass(frozen=True)
class Spread:
    """One quantity over a set of states: how many, mean magnitude, extremes with their sign and where they are."""

    count: int
    mean: float
    low: float
    high: float
    low_at: str
    high_at: str

    @property
    def worst(self) -> float:
        """The larger extreme, with sign."""
        return self.low if abs(self.low) > abs(self.high) else self.high


@dataclass(frozen=True)
class Pair:
    """Deviations of a model from a reference over all states; None for a quantity that has none."""

    model: str
    reference: str
    area: Spread | None
    gap: Spread | None


@dataclass(frozen=True)
class Range:
    """Contact area and mean gap of one model over all states; None for a quantity that has none."""

    model: str
    area: Spread | None
    gap: Spread | None


@dataclass(frozen=True)
class SurfaceScatter:
    """Scatter of a simulation's contact area between surfaces, and the theories beside its mean.

    Attributes
    ----------
    model : str
        Name of the simulation's entry.
    surfaces : int
        How many it has.
    relative : dict of Spread
        Standard deviation over mean, by label of the point of the sweep.
    rankings : list of Ranking
        Theories by their distance from each surface.
    within : tuple of int
        States in which the compared surface lies within one standard deviation of the mean, and states compared.
    """

    model: str
    surfaces: int
    relative: dict[str, Spread]
    rankings: list[Ranking]
    within: tuple[int, int]


@dataclass(frozen=True)
class Findings:
    """All that a comparison, or a report on one dataset, amounts to."""

    unit: str  # unit of mean gaps
    averaged: str  # what the values of an ensemble are called
    rankings: list[Ranking]  # at each point of the sweep
    pairs: list[Pair]  # models and their references
    ranges: list[Range]  # of each model where nothing is compared
    scatter: list[SurfaceScatter]  # of each simulation over several surfaces beside the comparison

    @property
    def ordered(self) -> bool:
        """Whether an ensemble orders some models."""
        every = [*self.rankings, *(ranking for found in self.scatter for ranking in found.rankings)]
        return any(ranking.relations for ranking in every)

    @property
    def statuses(self) -> dict[str, list[str]]:
        """Theories that are ranked, by whether they are published."""
        every = [*self.rankings, *(ranking for found in self.scatter for ranking in found.rankings)]
        found: dict[str, list[str]] = {}
        for model in dict.fromkeys(one.model for ranking in every for one in ranking.distances):
            if entry_of(model).status and kind_of(model) not in found.setdefault(entry_of(model).status, []):
                found[entry_of(model).status].append(kind_of(model))
        return found

    @property
    def unranked(self) -> bool:
        """Whether several models stand beside the first reference without a state that all of them share."""
        beside = [pair for pair in self.pairs if pair.reference == self.pairs[0].reference]
        return len([pair for pair in beside if pair.area]) > 1 and not self.rankings

    def sentences(self, brief: bool = False) -> list[str]:
        """The findings in words; the rankings alone if ``brief``."""
        return paragraphs("findings.j2", facts=self, brief=brief)


def find(
    models: Mapping[str, xr.Dataset],
    deviations: xr.Dataset | None,
    regime: xr.Dataset,
    statistics: Mapping[str, xr.Dataset] | None = None,
    from_surfaces: xr.Dataset | None = None,
) -> Findings:
    """Compute the findings."""
    points = sweep_points(models)
    heights = {point.label: scales(models, point).rms_height for point in points}
    pairs: list[Pair] = []
    if deviations is not None:
        shown = [pair for pair in deviations["pair"].values if set(split_pair(pair)) <= {*models}]
        deviations = deviations.sel(pair=shown)
        pairs = [_pair(deviations, pair, points, heights) for pair in shown]
    return Findings(
        unit=scales(models, points[0]).height_symbol,
        averaged=averaged(next(iter(models.values()))).replace("_", " "),
        rankings=[] if deviations is None else rank_models(models, deviations, regime),
        pairs=pairs,
        ranges=[_range(name, dataset, points, heights) for name, dataset in models.items()]
        if deviations is None
        else [],
        scatter=[
            found
            for name, found_there in (statistics or {}).items()
            if (found := _scatter(models, name, found_there, from_surfaces, regime)) is not None
        ],
    )


def pair_spread(
    deviations: xr.Dataset, pair: str, name: str, points: Sequence[SweepPoint], scale: Mapping[str, float]
) -> Spread | None:
    """Deviations of one pair over the given points of the sweep, each divided by ``scale`` of its label."""
    own = deviations.sel(pair=pair)
    return over_states(own.where(own["state"] == COMPARED), name, points, scale) if name in own else None


def over_states(
    dataset: xr.Dataset, name: str, points: Sequence[SweepPoint], scale: Mapping[str, float]
) -> Spread | None:
    """A quantity over all states where it is a number; None if it is none anywhere."""
    values: list[float] = []
    places: list[str] = []
    for point in points:
        part = select(dataset, point)
        if part is None:
            continue
        lead = samples_in(part[name])
        array = part[name].transpose(*lead, "step").values / scale[point.label]
        path = case_points(part, control_of(part))
        for index in zip(*np.nonzero(np.isfinite(array)), strict=True):
            seed = [f"{dim.replace('_', ' ')} {part[dim].values[index[0]]}" for dim in lead]
            values.append(float(array[index]))
            places.append(", ".join(filter(None, (point.label, *seed, _point_words(part, path[index[-1]])))))
    if not values:
        return None
    low, high = int(np.argmin(values)), int(np.argmax(values))
    mean = float(np.mean(np.abs(values)))
    return Spread(len(values), mean, values[low], values[high], places[low], places[high])


def control_of(part: xr.Dataset) -> str:
    """The quantity that the path of a dataset prescribes."""
    return next(control for control in PRESCRIBED if f"applied_{control}" in part.coords)


def _point_words(part: xr.Dataset, named: PathPoint | None) -> str:
    """A point of the path: its prescribed value, and its branch and visit where the value occurs several times."""
    assert named is not None
    value, branch, visits = float(named[0]), named[1], named[2]
    control = control_of(part)
    largest = float(np.abs(part[f"applied_{control}"]).max())
    unit = pressure_unit(largest) if control == "pressure" else length_unit(largest)
    again = f", visit {visits + 1}" if visits else ""
    return (
        f"{PRESCRIBED[control]} = {number(value / unit.size, 5)} {unit.name}{' on unloading' if branch else ''}{again}"
    )


def _pair(deviations: xr.Dataset, pair: str, points: Sequence[SweepPoint], heights: Mapping[str, float]) -> Pair:
    area = pair_spread(deviations, pair, AREA, points, dict.fromkeys(heights, 1.0))
    return Pair(*split_pair(pair), area, pair_spread(deviations, pair, GAP, points, heights))


def _range(model: str, dataset: xr.Dataset, points: Sequence[SweepPoint], heights: Mapping[str, float]) -> Range:
    fit = dataset.where(usable(dataset))
    area, gap = (
        over_states(fit, name, points, scale) if name in dataset else None
        for name, scale in (("relative_contact_area", dict.fromkeys(heights, 1.0)), ("mean_gap", heights))
    )
    return Range(model, area, gap)


def surface_deviations(models: Mapping[str, xr.Dataset], name: str, realisations: xr.Dataset) -> xr.Dataset | None:
    """Deviations of the theories from each surface of a simulation; None with fewer than two theories.

    Other surfaces of one spectrum share its target: theories that are fed with the target are taken where there are
    some.
    """
    theories = {model: own for model, own in models.items() if not entry_of(model).simulation}
    theories = {model: own for model, own in theories.items() if spectrum_of(model) == TARGET} or theories
    if len(theories) < 2:
        return None
    table = compute_deviations({name: realisations, **theories}, control_of(realisations))
    return table.sel(pair=[pair for pair in table["pair"].values if split_pair(pair)[1] == name])


def _scatter(
    models: Mapping[str, xr.Dataset],
    name: str,
    statistics: xr.Dataset,
    deviations: xr.Dataset | None,
    regime: xr.Dataset,
) -> SurfaceScatter | None:
    relative = {}
    share = (_standard_deviation(statistics) / statistics[_AREA]).to_dataset(name="share")
    for point in sweep_points({name: statistics}):
        found = over_states(share, "share", [point], {point.label: 1.0})
        if found is not None:
            relative[point.label] = found
    if not relative:
        return None
    return SurfaceScatter(
        name,
        int(statistics["samples"].max()),
        relative,
        [] if deviations is None else rank_models(models, deviations, regime),
        _count_within(models[name], statistics) if name in models else (0, 0),
    )


_AREA = "relative_contact_area"


def _standard_deviation(statistics: xr.Dataset) -> xr.DataArray:
    return statistics[f"{_AREA}_standard_error"] * np.sqrt(statistics["samples"])


def _count_within(one: xr.Dataset, statistics: xr.Dataset) -> tuple[int, int]:
    """In how many of how many states one surface's area is within a standard deviation of the mean of all."""
    pair = on_common_path({"mean": statistics, "one": one}, control_of(statistics))
    own, mean = pair["one"][_AREA].where(usable(pair["one"])), pair["mean"]
    if own.dims != mean[_AREA].dims:
        return 0, 0  # several surfaces are compared
    deviation = _standard_deviation(mean)
    both = own.notnull() & deviation.notnull()
    return int((both & (np.abs(own - mean[_AREA]) <= deviation)).sum()), int(both.sum())
