"""What the figures show, as arrays; :mod:`contact_study.comparison.figures` draws it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from contact_study.comparison.cases import (
    SweepPoint,
    case_points,
    first_constant,
    select,
    series,
    strongest,
    sweep_points,
)
from contact_study.comparison.path_points import AVERAGED, Point, usable
from contact_study.comparison.wording import Unit, number, pressure_unit

# p/E* of figures 1b and 2b of Yang et al., EPL 84, 46004 (2008); their panels a state none.
PAPER_PRESSURES = (-0.00532, 0.00832, 0.06265)
PAPER_PANEL_A = PAPER_PRESSURES[1]
_SAME_PRESSURE = 0.01  # of the wanted one: the paper gives three digits


@dataclass(frozen=True)
class Scales:
    """Units of the axes at one point of the sweep, the same for every model.

    Attributes
    ----------
    contact_modulus : float
        E* (Pa).
    rms_height : float
        h_rms (m), or one nanometre for a surface without roughness.
    """

    contact_modulus: float
    rms_height: float
    rough: bool = True

    @property
    def height_symbol(self) -> str:
        """Unit of gaps in words."""
        return "h_rms" if self.rough else "nm"


def scales(models: Mapping[str, xr.Dataset], point: SweepPoint) -> Scales:
    """E* and h_rms of a point of the sweep, as the continuum was given them."""
    rms_height = first_constant(models, point, "rms_height")
    rough = bool(np.isfinite(rms_height) and rms_height > 0)
    return Scales(first_constant(models, point, "contact_modulus"), rms_height if rough else 1e-9, rough)


@dataclass(frozen=True)
class Curve:
    """One model's curve.

    Attributes
    ----------
    model : str
        ``atomistic``, ``continuum``, ``theory`` or ``gap_flow``.
    label : str
        What its colour stands for.
    colour : int
        Number of the colour.
    x, y : numpy.ndarray
        What is plotted, NaN where nothing is.
    x_error, y_error : numpy.ndarray or None
        Standard errors over seeds, of the plotted quantities.
    fit : numpy.ndarray of bool
        False where the state did not converge or has detached.
    unloading : numpy.ndarray of bool
        Whether a point is on the way back.
    """

    model: str
    label: str
    colour: int
    x: np.ndarray
    y: np.ndarray
    x_error: np.ndarray | None = None
    y_error: np.ndarray | None = None
    fit: np.ndarray | None = None
    unloading: np.ndarray | None = None


def mean_pressure_unit(models: Mapping[str, xr.Dataset]) -> Unit:
    """The unit of the pressure axis."""
    found = [float(np.abs(d["mean_pressure"]).max()) for d in models.values() if "mean_pressure" in d]
    return pressure_unit(max(found, default=0.0))


def contact_area_data(models: Mapping[str, xr.Dataset], control: str) -> list[Curve]:
    """A/A₀ against the mean pressure in units of :func:`mean_pressure_unit`, the paper's figure 3."""
    unit = mean_pressure_unit(models).size

    def curve(part: xr.Dataset, units: Scales) -> tuple[np.ndarray, ...]:
        area, pressure = series(part, "relative_contact_area"), series(part, "mean_pressure")
        return pressure.values / unit, area.values, pressure.standard_error / unit, area.standard_error, area.fit

    return _along_the_path(models, control, curve, "relative_contact_area")


def in_compression(curves: Sequence[Curve]) -> bool:
    """Whether some curve of :func:`contact_area_data` has a state to show on logarithmic axes."""
    return any(((curve.x > 0) & (curve.y > 0)).any() for curve in curves)


def mean_gap_data(models: Mapping[str, xr.Dataset], control: str) -> list[Curve]:
    """ln(p/E*) against ū/h_rms for p > 0, the paper's figure 4."""

    def curve(part: xr.Dataset, units: Scales) -> tuple[np.ndarray, ...]:
        gap, pressure = series(part, "mean_gap"), series(part, "mean_pressure")
        positive = np.where(pressure.values > 0, pressure.values, np.nan)
        return (
            np.where(positive > 0, gap.values, np.nan) / units.rms_height,
            np.log(positive / units.contact_modulus),
            gap.standard_error / units.rms_height,
            # ln p has no such error where p may be zero.
            np.where(pressure.standard_error < positive, pressure.standard_error / positive, np.nan),
            gap.fit,
        )

    return _along_the_path(models, control, curve, "mean_gap")


def _along_the_path(
    models: Mapping[str, xr.Dataset],
    control: str,
    curve: Callable[[xr.Dataset, Scales], tuple[np.ndarray, ...]],
    needed: str,
) -> list[Curve]:
    curves = []
    for colour, point in enumerate(sweep_points(models)):
        units = scales(models, point)
        for model, dataset in models.items():
            part = select(dataset, point)
            if part is None or needed not in part or "mean_pressure" not in part:
                continue
            x, y, x_error, y_error, fit = curve(part, units)
            sides = [bool(named[1]) if named else False for named in case_points(part, control)]
            curves.append(
                Curve(model, point.label, colour, x, y, _or_none(x_error), _or_none(y_error), fit, np.array(sides))
            )
    return curves


def _or_none(error: np.ndarray) -> np.ndarray | None:
    return error if np.isfinite(error).any() else None


@dataclass(frozen=True)
class PanelPoints:
    """States whose distributions are shown.

    Attributes
    ----------
    common : Point
        Point of the path at which all points of the sweep are shown (panel a).
    case : SweepPoint
        Point of the sweep shown at several pressures (panel b).
    several : list of Point
        These points of its path.
    paper : bool
        Whether they are those of the paper.
    """

    common: Point
    case: SweepPoint
    several: list[Point]
    paper: bool = False


def panel_points(models: Mapping[str, xr.Dataset], control: str, wanted: float | None = None) -> PanelPoints:
    """Choose the states: those of the paper where the path visits them, else spread over the path.

    Parameters
    ----------
    models : mapping
        Datasets by model.
    control : str
        ``"pressure"`` or ``"gap"``.
    wanted : float, optional
        Prescribed value of panel a (Pa or m), in place of the paper's p/E* = 0.00832; the nearest one is taken.
    """
    points = sweep_points(models)
    case = strongest(points)
    paths = {point.label: _loading_points(models, point, control) for point in points}
    shared = [named for named in paths[case.label] if all(named in path for path in paths.values())]
    own = sorted(paths[case.label], key=_value)
    paper = _paper_points(own, first_constant(models, case, "contact_modulus")) if control == "pressure" else []
    if wanted is not None:
        common = min(shared or own, key=lambda named: abs(_value(named) - wanted))
    else:
        in_paper = [named for named, pressure in paper if pressure == PAPER_PANEL_A and named in shared]
        common = in_paper[0] if in_paper else sorted(shared or own, key=_value)[len(shared or own) // 2]
    several = [named for named, _ in paper]
    if len(several) < 2:
        several = [own[0], own[len(own) // 2], own[-1]]
    is_paper = len(paper) == len(PAPER_PRESSURES) and common == paper[PAPER_PRESSURES.index(PAPER_PANEL_A)][0]
    return PanelPoints(common, case, list(dict.fromkeys(several)), is_paper)


def _value(named: Point) -> float:
    return float(named[0])


def _loading_points(models: Mapping[str, xr.Dataset], point: SweepPoint, control: str) -> list[Point]:
    """First visits on loading at one point of the sweep, by any model."""
    found: dict[Point, None] = {}
    for dataset in models.values():
        part = select(dataset, point)
        if part is not None:
            found |= dict.fromkeys(named for named in case_points(part, control) if named and named[1:] == (0, 0))
    return list(found)


def _paper_points(path: list[Point], contact_modulus: float) -> list[tuple[Point, float]]:
    chosen = []
    for pressure in PAPER_PRESSURES:
        near = min(path, key=lambda named: abs(_value(named) / contact_modulus - pressure))
        if abs(_value(near) / contact_modulus - pressure) <= _SAME_PRESSURE * abs(pressure):
            chosen.append((near, pressure))
    return chosen


def point_label(named: Point, units: Scales, control: str) -> str:
    """A point of the path in the figures' units."""
    if control == "pressure":
        return f"p/E* = {number(_value(named) / units.contact_modulus, 4)}"
    symbol = "ū/h_rms" if units.rough else "ū/nm"
    return f"{symbol} = {number(_value(named) / units.rms_height, 3)}"


def stress_distribution_data(
    models: Mapping[str, xr.Dataset], control: str, shown: PanelPoints
) -> tuple[list[Curve], list[Curve]]:
    """log₁₀ of P(σ) E* against σ/E*, the paper's figure 1: panels a and b."""
    return _distributions(models, control, shown, "pressure", lambda units: units.contact_modulus)


def gap_distribution_data(
    models: Mapping[str, xr.Dataset], control: str, shown: PanelPoints
) -> tuple[list[Curve], list[Curve]]:
    """log₁₀ of P(u) h_rms against u/h_rms, the paper's figure 2: panels a and b."""
    return _distributions(models, control, shown, "gap", lambda units: units.rms_height)


def _distributions(
    models: Mapping[str, xr.Dataset],
    control: str,
    shown: PanelPoints,
    name: str,
    unit_of: Callable[[Scales], float],
) -> tuple[list[Curve], list[Curve]]:
    def curves(states: list[tuple[SweepPoint, Point, str]]) -> list[Curve]:
        found = []
        for colour, (point, named, label) in enumerate(states):
            unit = unit_of(scales(models, point))
            for model, dataset in models.items():
                density = density_at(dataset, point, f"{name}_pdf", named, control)
                if density is None:
                    continue
                with np.errstate(divide="ignore", invalid="ignore"):  # rounding may leave −0
                    logarithm = np.where(density > 0, np.log10(density * unit), np.nan)
                found.append(Curve(model, label, colour, dataset[f"{name}_bin"].values / unit, logarithm))
        return found

    units = scales(models, shown.case)
    panel_a = [(point, shown.common, point.label) for point in sweep_points(models)]
    panel_b = [(shown.case, named, point_label(named, units, control)) for named in shown.several]
    return curves(panel_a), curves(panel_b)


def density_at(dataset: xr.Dataset, point: SweepPoint, name: str, named: Point, control: str) -> np.ndarray | None:
    """A density at one state, its mean over the seeds that converged in contact; None where there is none."""
    part = select(dataset, point)
    if part is None or name not in part or named not in (path := case_points(part, control)):
        return None
    state = part.isel(step=path.index(named))
    fit = usable(state) & state[name].notnull().any(dim=name.replace("_pdf", "_bin"))
    if not fit.any():
        return None
    density = state[name].where(fit)
    return (density.mean(AVERAGED) if AVERAGED in density.dims else density).values


def smallest_resolved(curves: list[Curve]) -> float:
    """The smallest log₁₀ density that a simulation shows; theories reach below any sampling."""
    simulated = [curve.y for curve in curves if curve.model in ("atomistic", "continuum")]
    values = np.concatenate(simulated or [curve.y for curve in curves])
    values = values[np.isfinite(values)]
    return float(max(values.min(), values.max() - 8)) if values.size else 0.0
