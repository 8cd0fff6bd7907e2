"""Findings of a comparison: rankings of the models, and the scatter between surfaces."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from contact_study.report.align.cases import select, series, sweep_points
from contact_study.report.align.deviations import compute_deviations, split_pair
from contact_study.report.align.scales import scales
from contact_study.report.facts.ranking import Ranking, rank_models
from contact_study.report.models import TARGET, entry_of, kind_of, spectrum_of
from contact_study.report.read.load_steps import averaged, on_common_path
from contact_study.report.text.rendering import paragraphs
from contact_study.report.text.wording import PRESCRIBED
from contact_study.results.state import usable

_AREA = "relative_contact_area"


@dataclass(frozen=True)
class SurfaceScatter:
    """Scatter of a simulation's contact area between surfaces, and the theories beside its mean.

    Attributes
    ----------
    model : str
        Name of the simulation's entry.
    surfaces : int
        How many it has.
    relative : dict of float
        Standard deviation over mean, the mean over states, by label of the point of the sweep.
    rankings : list of Ranking
        Theories by their distance from each surface.
    within : tuple of int
        States in which the compared surface lies within one standard deviation of the mean, and states compared.
    """

    model: str
    surfaces: int
    relative: dict[str, float]
    rankings: list[Ranking]
    within: tuple[int, int]


@dataclass(frozen=True)
class Findings:
    """All that a comparison amounts to."""

    unit: str  # unit of mean gaps
    averaged: str  # what the values of an ensemble are called
    rankings: list[Ranking]  # at each point of the sweep
    scatter: list[SurfaceScatter]  # of each simulation over several surfaces beside the comparison
    unranked: bool  # whether several models stand beside the reference without a state that all of them share

    @property
    def _every(self) -> list[Ranking]:
        return [*self.rankings, *(ranking for found in self.scatter for ranking in found.rankings)]

    @property
    def ordered(self) -> bool:
        """Whether an ensemble orders some models."""
        return any(ranking.relations for ranking in self._every)

    @property
    def statuses(self) -> dict[str, list[str]]:
        """Theories that are ranked, by whether they are published."""
        found: dict[str, list[str]] = {}
        for model in dict.fromkeys(one.model for ranking in self._every for one in ranking.distances):
            if entry_of(model).status and kind_of(model) not in found.setdefault(entry_of(model).status, []):
                found[entry_of(model).status].append(kind_of(model))
        return found

    def sentences(self) -> list[str]:
        """The findings in words."""
        return paragraphs("findings.j2", facts=self)


def find(
    models: Mapping[str, xr.Dataset],
    deviations: xr.Dataset | None,
    regime: xr.Dataset,
    statistics: Mapping[str, xr.Dataset] | None = None,
    from_surfaces: xr.Dataset | None = None,
) -> Findings:
    """Compute the findings."""
    rankings, beside = [], 0
    if deviations is not None:
        pairs = [pair for pair in deviations["pair"].values if set(split_pair(pair)) <= {*models}]
        rankings = rank_models(models, deviations.sel(pair=pairs), regime)
        beside = len([pair for pair in pairs if split_pair(pair)[1] == split_pair(pairs[0])[1]])
    scatter = []
    for name, found in (statistics or {}).items():
        relative = {}
        for point in sweep_points({name: found}):
            part = select(found, point)
            share = _standard_deviation(part) / part[_AREA] if part is not None else np.array(np.nan)
            if np.isfinite(share).any():
                relative[point.label] = float(np.nanmean(share))
        if relative:
            within = _count_within(models[name], found) if name in models else (0, 0)
            ranked = [] if from_surfaces is None else rank_models(models, from_surfaces, regime)
            scatter.append(SurfaceScatter(name, int(found["samples"].max()), relative, ranked, within))
    symbol = scales(models, sweep_points(models)[0]).height_symbol
    average = averaged(next(iter(models.values()))).replace("_", " ")
    return Findings(symbol, average, rankings, scatter, beside > 1 and all(ranking.alone for ranking in rankings))


def control_of(part: xr.Dataset) -> str:
    """The quantity that the path of a dataset prescribes."""
    return next(control for control in PRESCRIBED if f"applied_{control}" in part.coords)


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


def relative_errors(models: Mapping[str, xr.Dataset], model: str) -> list[float]:
    """Standard error over mean of a model's contact area at every state of its path that has one."""
    parts = [select(models[model], point) for point in sweep_points(models)]
    found = [series(part, _AREA) for part in parts if part is not None]
    shares = np.concatenate([np.empty(0), *(one.standard_error / one.values for one in found)])
    return list(shares[np.isfinite(shares)])


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
