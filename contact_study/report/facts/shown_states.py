"""Which states the figures of distributions and fields show, what these are called, and the captions."""

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from contact_study.plots.selection import UNLOADING
from contact_study.report.align import cases
from contact_study.report.align.cases import Scales, SweepPoint, scales, sweep_points
from contact_study.report.align.states import resolving
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs, Scatter
from contact_study.report.text.rendering import paragraphs
from contact_study.report.text.wording import PRESCRIBED, length, number, pressure
from contact_study.study.case import PathPoint

# p/E* of figures 1b and 2b of Yang et al., EPL 84, 46004 (2008); their panels a state none.
PAPER_PRESSURES = (-0.00532, 0.00832, 0.06265)
PAPER_PANEL_A = PAPER_PRESSURES[1]
_SAME_PRESSURE = 0.01  # of the wanted one: the paper gives three digits

_ROUNDING = 1e-6  # of h_rms: deviation from zero of a gap prescribed as zero
_BALANCED = 0.01  # difference from one of a balance of stress that a caption does not mention


@dataclass(frozen=True)
class PanelPoints:
    """States whose distributions are shown."""

    common: PathPoint  # point of the path at which all points of the sweep are shown (panel a)
    case: SweepPoint  # point of the sweep shown at several pressures (panel b)
    several: list[PathPoint]  # these points of its path


def panel_points(models: Mapping[str, xr.Dataset], wanted: float | None = None) -> PanelPoints:
    """Choose the states: those of the paper where the path visits them, else spread over the path."""
    case = cases.strongest(sweep_points(models))
    paths: dict[str, dict[PathPoint, None]] = {point.label: {} for point in sweep_points(models)}
    for point, _, part in cases.parts_of(models):  # first visits on loading
        paths[point.label] |= dict.fromkeys(named for named in cases.case_points(part) if named and named[1:] == (0, 0))
    shared = [named for named in paths[case.label] if all(named in path for path in paths.values())]
    own = sorted(paths[case.label], key=_value)
    pressed = cases.control_of(next(iter(models.values()))) == "pressure"
    paper = _paper_points(own, scales(models, case).contact_modulus) if pressed else []
    if wanted is not None:
        common = min(shared or own, key=lambda named: abs(_value(named) - wanted))
    else:
        in_paper = [named for named, wished in paper if wished == PAPER_PANEL_A and named in shared]
        common = in_paper[0] if in_paper else sorted(shared or own, key=_value)[len(shared or own) // 2]
    several = [named for named, _ in paper]
    if len(several) < 2:
        several = [own[0], own[len(own) // 2], own[-1]]
    return PanelPoints(common, case, list(dict.fromkeys(several)))


def _value(named: PathPoint) -> float:
    return float(named[0])


def _paper_points(path: list[PathPoint], contact_modulus: float) -> list[tuple[PathPoint, float]]:
    chosen = []
    for wished in PAPER_PRESSURES:
        near = min(path, key=lambda named: abs(_value(named) / contact_modulus - wished))
        if abs(_value(near) / contact_modulus - wished) <= _SAME_PRESSURE * abs(wished):
            chosen.append((near, wished))
    return chosen


def point_label(named: PathPoint, units: Scales, control: str, reduced: bool = False) -> str:
    """A point of the path of one point of the sweep."""
    symbol, value = PRESCRIBED[control], _value(named)
    if not reduced:
        return f"{symbol} = {pressure(value) if control == 'pressure' else length(value)}"
    if control == "pressure":
        return f"p/E* = {number(value / units.contact_modulus, 4)}"
    return f"{symbol}/{units.height_symbol} = {number(value / units.rms_height, 3)}"


def common_label(models: Mapping[str, xr.Dataset], named: PathPoint, control: str, reduced: bool = False) -> str:
    """A point of the path for the whole sweep; reduced where the unit is one for all of it."""
    every = [scales(models, point) for point in sweep_points(models)]
    sizes = [one.contact_modulus if control == "pressure" else one.rms_height for one in every]
    same = all(math.isclose(size, sizes[0]) for size in sizes)
    return point_label(named, every[0], control, reduced and same)


def state_label(point: SweepPoint, words: str) -> str:
    """A state by its point of the sweep, if there is one to name, and the words of its point of the path."""
    return ", ".join(filter(None, (point.label, words)))


def captions(
    inputs: Inputs, shown: PanelPoints, sample: Any, banded: Collection[str], scatter: Scatter | None = None
) -> dict[str, str]:
    """Captions of the figures, by figure name; ``banded`` are labels of the theories with a band."""
    models, units = inputs.models, scales(inputs.models, shown.case)
    resolved = resolving(inputs)
    own_laws = dict.fromkeys(type(case.law) for case in inputs.cases_at(shown.case.selection))
    made = paragraphs(
        "captions.j2",
        entries=[entry_of(name) for name in models],
        laws=sorted(inputs.laws, key=lambda law: law.has_wall),
        own_laws=sorted(own_laws, key=lambda law: law.has_wall),
        shown=shown,
        common=common_label(models, shown.common, inputs.control),
        several=[point_label(named, units, inputs.control) for named in shown.several],
        state=state_label(shown.case, point_label(shown.common, units, inputs.control)),
        average=inputs.average.replace("_", " "),
        sample=sample,
        averaging=inputs.samples > 1,
        compressed=any((own["mean_pressure"] > 0).any() for own in models.values()),
        unloads=any((own["branch"] == UNLOADING).any() for own in models.values()),
        left_out=any((own["detached"] == 1).any() for own in models.values() if "detached" in own),
        below_zero=list(_below_zero(models)),
        banded=[entry_of(name) for name in models if entry_of(name).label in banded],
        scatter=scatter,
        resolving=entry_of(resolved) if resolved else None,
        balances=list(_balances(models)),
        mapped=any("pressure_pdf_at" in dataset for dataset in models.values()),
        simulations=[entry_of(name) for name in inputs.simulations],
    )
    return {name: text for name, _, text in (paragraph.partition(": ") for paragraph in made)}


def _below_zero(models: Mapping[str, xr.Dataset]) -> Iterator[tuple[list[str], str]]:
    """Models with a negative mean gap, and its meaning, for each kind of model that has one."""
    height = scales(models, sweep_points(models)[0]).rms_height
    lowest = {name: own["mean_gap"].min() for name, own in models.items() if "mean_gap" in own}
    negative = [entry_of(name) for name, value in lowest.items() if value < -_ROUNDING * height]
    for meaning in dict.fromkeys(entry.negative_gap for entry in negative):
        yield [entry.words for entry in negative if entry.negative_gap == meaning], meaning


def _balances(models: Mapping[str, xr.Dataset]) -> Iterator[tuple[str, float, float]]:
    """Models whose distribution of stress does not carry the pressure: least and largest share that it carries."""
    for name, dataset in models.items():
        shares = dataset["stress_balance"].values if "stress_balance" in dataset else np.array([])
        shares = shares[np.isfinite(shares)]
        if shares.size and np.abs(shares - 1).max() > _BALANCED:
            yield entry_of(name).words, float(shares.min()), float(shares.max())
