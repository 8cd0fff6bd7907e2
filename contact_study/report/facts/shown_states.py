"""Which states the figures of distributions and fields show, and what these are called."""

from collections.abc import Mapping
from dataclasses import dataclass

import xarray as xr

from contact_study.report.align.cases import (
    SweepPoint,
    case_points,
    first_constant,
    select,
    strongest,
    sweep_points,
)
from contact_study.report.align.scales import Scales, common_scales, scales
from contact_study.report.text.wording import PRESCRIBED, length, number, pressure
from contact_study.study.load_steps import PathPoint

# p/E* of figures 1b and 2b of Yang et al., EPL 84, 46004 (2008); their panels a state none.
PAPER_PRESSURES = (-0.00532, 0.00832, 0.06265)
PAPER_PANEL_A = PAPER_PRESSURES[1]
_SAME_PRESSURE = 0.01  # of the wanted one: the paper gives three digits


@dataclass(frozen=True)
class PanelPoints:
    """States whose distributions are shown."""

    common: PathPoint  # point of the path at which all points of the sweep are shown (panel a)
    case: SweepPoint  # point of the sweep shown at several pressures (panel b)
    several: list[PathPoint]  # these points of its path
    paper: bool = False  # whether they are those of the paper


def panel_points(models: Mapping[str, xr.Dataset], control: str, wanted: float | None = None) -> PanelPoints:
    """Choose the states: those of the paper where the path visits them, else spread over the path."""
    points = sweep_points(models)
    case = strongest(points)
    paths = {point.label: _loading_points(models, point, control) for point in points}
    shared = [named for named in paths[case.label] if all(named in path for path in paths.values())]
    own = sorted(paths[case.label], key=_value)
    paper = _paper_points(own, first_constant(models, case, "contact_modulus")) if control == "pressure" else []
    if wanted is not None:
        common = min(shared or own, key=lambda named: abs(_value(named) - wanted))
    else:
        in_paper = [named for named, wished in paper if wished == PAPER_PANEL_A and named in shared]
        common = in_paper[0] if in_paper else sorted(shared or own, key=_value)[len(shared or own) // 2]
    several = [named for named, _ in paper]
    if len(several) < 2:
        several = [own[0], own[len(own) // 2], own[-1]]
    is_paper = len(paper) == len(PAPER_PRESSURES) and common == paper[PAPER_PRESSURES.index(PAPER_PANEL_A)][0]
    return PanelPoints(common, case, list(dict.fromkeys(several)), is_paper)


def _value(named: PathPoint) -> float:
    return float(named[0])


def _loading_points(models: Mapping[str, xr.Dataset], point: SweepPoint, control: str) -> list[PathPoint]:
    """First visits on loading at one point of the sweep, by any model."""
    found: dict[PathPoint, None] = {}
    for dataset in models.values():
        part = select(dataset, point)
        if part is not None:
            found |= dict.fromkeys(named for named in case_points(part, control) if named and named[1:] == (0, 0))
    return list(found)


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
    one_modulus, one_height = common_scales(models)
    one = one_modulus if control == "pressure" else one_height
    return point_label(named, scales(models, sweep_points(models)[0]), control, reduced and one)


def state_label(point: SweepPoint, words: str) -> str:
    """A state by its point of the sweep, if there is one to name, and the words of its point of the path."""
    return ", ".join(filter(None, (point.label, words)))
