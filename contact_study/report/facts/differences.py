"""Differences between neighbouring points of the sweep, paired over samples."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr

from contact_study.report.align.cases import SweepPoint, case_points, select, sweep_points
from contact_study.report.facts.ranking import mean_and_error
from contact_study.report.read.load_steps import samples_in
from contact_study.results.state import usable


@dataclass(frozen=True)
class Difference:
    """Change of one model from one point of the sweep to the next along one key, the mean over shared states.

    Attributes
    ----------
    model : str
        Name of its entry.
    before, after : str
        Labels of the points of the sweep.
    states, samples : int
        States averaged over, samples paired.
    area, gap : tuple of float
        Change of A/A₀ and of the mean gap (m) with its standard error over samples, NaN for none.
    """

    model: str
    before: str
    after: str
    states: int
    samples: int
    area: tuple[float, float]
    gap: tuple[float, float]


def differences(models: Mapping[str, xr.Dataset], control: str) -> list[Difference]:
    """Differences of every model along every swept key; empty without a sweep."""
    found = []
    for one, other in _neighbours(sweep_points(models)):
        for model, dataset in models.items():
            parts = select(dataset, one), select(dataset, other)
            if parts[0] is None or parts[1] is None or parts[0].identical(parts[1]):
                continue
            area, gap = (_change(parts[0], parts[1], name, control) for name in ("relative_contact_area", "mean_gap"))
            if area.size:
                samples, states = area.shape
                change = (mean_and_error(_mean(own)) for own in (area, gap))
                found.append(Difference(model, one.label, other.label, states, samples, *change))
    return found


def _neighbours(points: Sequence[SweepPoint]) -> Iterator[tuple[SweepPoint, SweepPoint]]:
    """Points that follow one another along one key, the others the same."""
    for key in points[0].selection:
        values = list(dict.fromkeys(point.selection[key] for point in points))
        following = dict(pairwise(values))
        for one in points:
            wanted = {**one.selection, key: following.get(one.selection[key])}
            yield from ((one, other) for other in points if other.selection == wanted)


def _change(one: xr.Dataset, other: xr.Dataset, name: str, control: str) -> np.ndarray:
    """Differences at the states of the path that every sample has at both points, a sample a row."""
    if name not in one:
        return np.empty((1, 0))
    paths = [case_points(part, control) for part in (one, other)]
    shared = [named for named in paths[0] if named is not None and named in paths[1]]
    rows = []
    for part, path in zip((one, other), paths, strict=True):
        values = part[name].where(usable(part))
        row = values.transpose(*samples_in(values), "step").values.reshape(-1, part.sizes["step"])
        rows.append(row[:, [path.index(named) for named in shared]])
    change: np.ndarray = rows[1] - rows[0]
    return change[:, np.isfinite(change).all(axis=0)]


def _mean(change: np.ndarray) -> np.ndarray:
    return change.mean(axis=1) if change.size else np.full(1, np.nan)
