"""How near the models come to a reference, ranked at each point of the sweep by itself.

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

from contact_study.report.align.cases import SweepPoint, select, sweep_points
from contact_study.report.align.deviations import COMPARED, split_pair
from contact_study.report.align.scales import scales
from contact_study.report.read.load_steps import samples_in

AREA, GAP = "relative_contact_area_relative_deviation", "mean_gap_deviation"

CONFIDENCE = 0.95
"""Of a paired difference between two models, by Student's distribution over the surfaces."""

TRAPPING = 0.25
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
    """Models at one point of the sweep, nearest to the reference first if there is an ensemble.

    Attributes
    ----------
    reference : str
        Name of the reference's entry.
    at : str
        Label of the point of the sweep.
    states, surfaces : int
        States compared on the path, surfaces averaged over.
    distances : tuple of Distance
        One for each model.
    relations : tuple of str
        Of each model but the last to the next one: `NEARER`, `EQUAL`, or `DIVIDED` where contact area and mean gap
        disagree. Empty for a single surface.
    trapped : float
        Grid spacing over process zone where the grid may trap contact edges, else 0.
    """

    reference: str
    at: str
    states: int
    surfaces: int
    distances: tuple[Distance, ...]
    relations: tuple[str, ...]
    trapped: float

    @property
    def alone(self) -> bool:
        """Whether one model stands beside the reference: there is nothing to rank."""
        return len(self.distances) == 1


def rank_models(
    models: Mapping[str, xr.Dataset], deviations: xr.Dataset, regime: xr.Dataset, reference: str | None = None
) -> list[Ranking]:
    """Rank the models by their deviations from the reference, at each point of the sweep.

    Returns
    -------
    list of Ranking
        Empty without a state that all of them share.
    """
    reference = reference or split_pair(deviations["pair"].values[0])[1]
    pairs = [pair for pair in deviations["pair"].values if split_pair(pair)[1] == reference]
    if AREA not in deviations:
        return []
    points = sweep_points(models)
    found = (_rank(deviations.sel(pair=pairs), point, scales(models, point).rms_height, regime) for point in points)
    return [ranking for ranking in found if ranking is not None]


def on_shared_states(deviations: xr.Dataset, name: str) -> xr.Dataset:
    """One quantity's deviations over the states that every pair has; pairs without any state are left out."""
    if name not in deviations:
        return deviations.isel(pair=slice(0))
    there = deviations[name].notnull()
    some = there.any([dim for dim in there.dims if dim != "pair"])
    there = there.sel(pair=some)
    return deviations.sel(pair=some).where(there.all("pair"))


def _rank(deviations: xr.Dataset, point: SweepPoint, height: float, regime: xr.Dataset) -> Ranking | None:
    part, setting = select(deviations, point), select(regime, point)
    if part is None:
        return None
    part = part.where(part["state"] == COMPARED)
    area, gap = _magnitudes(part, AREA, 1.0), _magnitudes(part, GAP, height)
    if not area:
        return None
    known = np.isfinite(list(area.values())).all(axis=0)
    own = {name: (area[name][known], gap.get(name, np.full(known.shape, np.nan))[known]) for name in area}
    if not known.any():
        return None
    names = list(own)
    if known.sum() > 1:
        lead = {name: sum(sum(_signs(own[name], other)) for other in own.values()) for name in own}
        names.sort(key=lambda name: (-lead[name], own[name][0].mean()))
    shared = on_shared_states(part, AREA)[AREA].notnull().all("pair")
    ratio = float(setting["pixel_over_process_zone"]) if setting is not None else np.nan
    return Ranking(
        reference=split_pair(part["pair"].values[0])[1],
        at=point.label,
        states=int(shared.any(samples_in(shared)).sum()),
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
