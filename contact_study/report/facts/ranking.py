"""How near the models come to a reference, ranked at each point of the sweep by itself, beside surfaces' scatter.

Contact area and mean gap are judged together, by the mean magnitude of their deviations over the states that all models
share. A model is nearer than another if the ensemble of surfaces distinguishes them in at least one of the two
quantities and in none the other way round. States of one surface are correlated: without an ensemble there is no order.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr
from scipy.special import stdtrit

from contact_study.physics.process_zone import POINTS_PER_PROCESS_ZONE
from contact_study.report.align.cases import SweepPoint, control_of, parts_of, scales, select, series, sweep_points
from contact_study.report.align.deviations import COMPARED, compute_deviations, split_pair
from contact_study.report.models import TARGET, entry_of, kind_of, spectrum_of
from contact_study.report.read.load_steps import averaged, on_common_path, swept_dims
from contact_study.report.text.rendering import paragraphs
from contact_study.results.state import usable

QUANTITY = "relative_contact_area"
AREA, GAP = f"{QUANTITY}_relative_deviation", "mean_gap_deviation"

CONFIDENCE = 0.95
"""Of a paired difference between two models, by Student's distribution over the surfaces."""

TRAPPING = 1 / POINTS_PER_PROCESS_ZONE
"""Grid spacing over process zone from which a grid may trap contact edges (docs/contact_challenge.md)."""

NEARER, EQUAL, DIVIDED = "nearer", "not distinguishable", "divided"


@dataclass(frozen=True)
class Distance:
    """Mean magnitude of a model's deviations from the reference at one point of the sweep."""

    model: str  # name of its entry
    area: float  # relative deviation of the contact area; its standard error over surfaces, NaN for a single one
    area_error: float
    gap: float  # deviation of the mean gap in units of the roughness, NaN where a model has none; its standard error
    gap_error: float


@dataclass(frozen=True)
class Ranking:
    """Models at one point of the sweep, nearest to the reference first if there is an ensemble."""

    reference: str  # name of its entry
    at: SweepPoint
    states: int  # compared on the path
    surfaces: int  # averaged over
    distances: tuple[Distance, ...]  # one for each model
    # Of each model but the last to the next one: `NEARER`, `EQUAL`, or `DIVIDED` where contact area and mean gap
    # disagree. Empty for a single surface.
    relations: tuple[str, ...]
    trapped: float  # grid spacing over process zone where the grid may trap contact edges, else 0

    @property
    def alone(self) -> bool:
        """Whether one model stands beside the reference: there is nothing to rank."""
        return len(self.distances) == 1


def rank_models(
    models: Mapping[str, xr.Dataset], deviations: xr.Dataset | None, regime: xr.Dataset, reference: str | None = None
) -> list[Ranking]:
    """Rank the models at each point of the sweep that has shared states by their deviations from the reference."""
    if deviations is None or AREA not in deviations:
        return []
    reference = reference or split_pair(deviations["pair"].values[0])[1]
    pairs = [pair for pair in deviations["pair"].values if split_pair(pair)[1] == reference]
    parts = parts_of({"": deviations.sel(pair=pairs)}, sweep_points(models))
    found = (_rank(part, point, scales(models, point).rms_height, select(regime, point)) for point, _, part in parts)
    return [ranking for ranking in found if ranking is not None]


def on_shared_states(deviations: xr.Dataset, name: str) -> xr.Dataset:
    """One quantity's deviations over the states that every pair has; pairs without any state are left out."""
    if name not in deviations:
        return deviations.isel(pair=slice(0))
    there = deviations[name].notnull()
    some = there.any([dim for dim in there.dims if dim != "pair"])
    there = there.sel(pair=some)
    return deviations.sel(pair=some).where(there.all("pair"))


def _rank(part: xr.Dataset, point: SweepPoint, height: float, setting: xr.Dataset | None) -> Ranking | None:
    part = part.where(part["state"] == COMPARED)
    area, gap = _magnitudes(part, AREA, 1.0), _magnitudes(part, GAP, height)
    known = np.isfinite(list(area.values())).all(axis=0)
    if not (area and known.any()):
        return None
    own = {name: (area[name][known], gap.get(name, np.full(known.shape, np.nan))[known]) for name in area}
    names = list(own)
    if known.sum() > 1:
        lead = {name: sum(sum(_signs(own[name], other)) for other in own.values()) for name in own}
        names.sort(key=lambda name: (-lead[name], own[name][0].mean()))
    shared = on_shared_states(part, AREA)[AREA].notnull().all("pair")
    ratio = float(setting["pixel_over_process_zone"]) if setting is not None else np.nan
    return Ranking(
        reference=split_pair(part["pair"].values[0])[1],
        at=point,
        states=int(shared.any(swept_dims(shared)).sum()),
        surfaces=int(known.sum()),
        distances=tuple(Distance(name, *mean_and_error(own[name][0]), *mean_and_error(own[name][1])) for name in names),
        relations=tuple(_relation(own[one], own[other]) for one, other in pairwise(names)) if known.sum() > 1 else (),
        trapped=ratio if ratio >= TRAPPING else 0.0,
    )


_Magnitudes = tuple[np.ndarray, np.ndarray]


def _magnitudes(deviations: xr.Dataset, name: str, unit: float) -> dict[str, np.ndarray]:
    """Mean magnitude of each model's deviations over the shared states, one for each surface."""
    shared = on_shared_states(deviations, name)
    if not shared.sizes["pair"]:
        return {}
    mean = np.abs(shared[name] / unit).mean("step")
    rows = mean.transpose("pair", ...).values.reshape(shared.sizes["pair"], -1)
    return {split_pair(pair)[0]: row for pair, row in zip(shared["pair"].values, rows, strict=True)}


def mean_and_error(samples: np.ndarray) -> tuple[float, float]:
    """Mean over surfaces and its standard error."""
    known = samples[np.isfinite(samples)]
    error = float(known.std(ddof=1) / np.sqrt(known.size)) if known.size > 1 else np.nan
    return (float(known.mean()) if known.size else np.nan), error


def _signs(one: _Magnitudes, other: _Magnitudes) -> list[int]:
    """For area and gap: 1 where the ensemble finds the first model nearer, −1 the other one, 0 neither."""
    signs = []
    for mine, theirs in zip(one, other, strict=True):
        difference, error = mean_and_error(theirs - mine)
        allowed = stdtrit(max(np.isfinite(theirs - mine).sum() - 1, 1), 0.5 * (1 + CONFIDENCE)) * error
        signs.append(int(np.sign(difference)) if abs(difference) > allowed else 0)
    return signs


def _relation(one: _Magnitudes, other: _Magnitudes) -> str:
    signs = _signs(one, other)
    if {1, -1} <= set(signs):
        return DIVIDED
    return NEARER if 1 in signs else EQUAL


@dataclass(frozen=True)
class SurfaceScatter:
    """Scatter of a simulation's contact area between surfaces, and the theories beside its mean."""

    model: str  # name of the simulation's entry
    surfaces: int  # how many it has
    relative: dict[str, float]  # standard deviation over mean, the mean over states, by label of the point of the sweep
    rankings: list[Ranking]  # theories by their distance from each surface
    within: tuple[int, int]  # states in which the compared surface lies within a standard deviation, and compared ones


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
        shares = {at.label: _standard_deviation(part) / part[QUANTITY] for at, _, part in parts_of({name: found})}
        relative = {at: float(np.nanmean(share)) for at, share in shares.items() if np.isfinite(share).any()}
        if relative:
            within = _count_within(models[name], found) if name in models else (0, 0)
            ranked = [] if from_surfaces is None else rank_models(models, from_surfaces, regime)
            scatter.append(SurfaceScatter(name, int(found["samples"].max()), relative, ranked, within))
    symbol = scales(models, sweep_points(models)[0]).height_symbol
    average = averaged(next(iter(models.values()))).replace("_", " ")
    return Findings(symbol, average, rankings, scatter, beside > 1 and all(ranking.alone for ranking in rankings))


def surface_deviations(models: Mapping[str, xr.Dataset], name: str, realisations: xr.Dataset) -> xr.Dataset | None:
    """Deviations of the theories from each surface of a simulation; None with fewer than two theories.

    Surfaces of one spectrum share its target: theories that are fed with the target are taken where there are some.
    """
    theories = {model: own for model, own in models.items() if not entry_of(model).simulation}
    theories = {model: own for model, own in theories.items() if spectrum_of(model) == TARGET} or theories
    if len(theories) < 2:
        return None
    table = compute_deviations({name: realisations, **theories}, control_of(realisations))
    return table.sel(pair=[pair for pair in table["pair"].values if split_pair(pair)[1] == name])


def relative_errors(models: Mapping[str, xr.Dataset], model: str) -> list[float]:
    """Standard error over mean of a model's contact area at every state of its path that has one."""
    parts = parts_of({model: models[model]}, sweep_points(models))
    found = [series(part, QUANTITY) for _, _, part in parts]
    shares = np.concatenate([np.empty(0), *(one.standard_error / one.values for one in found)])
    return list(shares[np.isfinite(shares)])


def _standard_deviation(statistics: xr.Dataset) -> xr.DataArray:
    return statistics[f"{QUANTITY}_standard_error"] * np.sqrt(statistics["samples"])


def _count_within(one: xr.Dataset, statistics: xr.Dataset) -> tuple[int, int]:
    """In how many of how many states one surface's area is within a standard deviation of the mean of all."""
    pair = on_common_path({"mean": statistics, "one": one}, control_of(statistics))
    own, mean = pair["one"][QUANTITY].where(usable(pair["one"])), pair["mean"]
    if own.dims != mean[QUANTITY].dims:
        return 0, 0  # several surfaces are compared
    deviation = _standard_deviation(mean)
    both = own.notnull() & deviation.notnull()
    return int((both & (np.abs(own - mean[QUANTITY]) <= deviation)).sum()), int(both.sum())
