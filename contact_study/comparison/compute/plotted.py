"""What the figures show, as arrays; :mod:`contact_study.comparison.draw.figures` draws it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from contact_study.comparison.compute.cases import SweepPoint, case_points, select, series, sweep_points
from contact_study.comparison.compute.ensemble import standard_error
from contact_study.comparison.compute.scales import Scales, mean_pressure_unit, scales
from contact_study.comparison.compute.shown_states import PanelPoints, point_label
from contact_study.comparison.models import entry_of
from contact_study.comparison.read.path_points import samples_in, usable
from contact_study.problem.path_points import PathPoint


@dataclass(frozen=True)
class Curve:
    """One model's curve.

    Attributes
    ----------
    model : str
        Name of its entry.
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


@dataclass(frozen=True)
class PathCurves:
    """What is drawn along the path: curves of figure 3, of figure 4 and of its linear panel."""

    areas: list[Curve]
    gaps: list[Curve]
    linear_gaps: list[Curve]


def path_curves(models: Mapping[str, xr.Dataset], control: str) -> PathCurves:
    """Every curve along the path."""
    made = (data(models, control) for data in (contact_area_data, mean_gap_data, mean_gap_linear_data))
    return PathCurves(*made)


def contact_area_data(models: Mapping[str, xr.Dataset], control: str) -> list[Curve]:
    """A/A₀ against the mean pressure in units of :func:`mean_pressure_unit`, the paper's figure 3."""
    unit = mean_pressure_unit(models).size

    def curve(part: xr.Dataset, units: Scales) -> tuple[np.ndarray, ...]:
        area, pressure = series(part, "relative_contact_area"), series(part, "mean_pressure")
        return pressure.values / unit, area.values, pressure.standard_error / unit, area.standard_error, area.fit

    return _along_the_path(models, control, curve, "relative_contact_area")


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
            pressure.fit,
        )

    return _along_the_path(models, control, curve, "mean_gap")


def mean_gap_linear_data(models: Mapping[str, xr.Dataset], control: str) -> list[Curve]:
    """p/E* against ū/h_rms, tension included."""

    def curve(part: xr.Dataset, units: Scales) -> tuple[np.ndarray, ...]:
        gap, pressure = series(part, "mean_gap"), series(part, "mean_pressure")
        modulus, height = units.contact_modulus, units.rms_height
        errors = gap.standard_error / height, pressure.standard_error / modulus
        return gap.values / height, pressure.values / modulus, *errors, pressure.fit

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
            x, y, x_error, y_error, fit = curve(_with_resolved_pressure(part, control, units.contact_modulus), units)
            sides = [bool(named[1]) if named else False for named in case_points(part, control)]
            curves.append(
                Curve(model, point.label, colour, x, y, _or_none(x_error), _or_none(y_error), fit, np.array(sides))
            )
    return curves


def _with_resolved_pressure(part: xr.Dataset, control: str, contact_modulus: float) -> xr.Dataset:
    """The part with a pressure of zero where it is none: below the residual stress only rounding has a sign."""
    pressure = part["mean_pressure"]
    if control == "pressure":
        nothing = part["applied_pressure"] == 0
    else:
        nothing = np.abs(pressure) <= (part["residual"] * contact_modulus if "residual" in part else 0.0)
    return part.assign(mean_pressure=pressure.where(~nothing, 0.0))


def _or_none(error: np.ndarray) -> np.ndarray | None:
    return error if np.isfinite(error).any() else None


def mean_gap_panels(curves: Sequence[Curve], linear: Sequence[Curve]) -> list[str]:
    """Panels of figure 4, ``"logarithmic"`` where there is compression, ``"linear"`` where there is tension."""
    compressed = any(np.isfinite(curve.x + curve.y).any() for curve in curves)
    pulled = any((np.isfinite(curve.x) & (curve.y < 0)).any() for curve in linear)
    return [name for name, there in (("logarithmic", compressed), ("linear", pulled)) if there]


def in_compression(curves: Sequence[Curve]) -> bool:
    """Whether some curve of :func:`contact_area_data` has a state to show on logarithmic axes."""
    return any(((curve.x > 0) & (curve.y > 0)).any() for curve in curves)


def of_compression(curve: Curve) -> Curve:
    """A curve of :func:`contact_area_data` for logarithmic axes."""
    return replace(curve, x=np.where((curve.x > 0) & (curve.y > 0), curve.x, np.nan))


def logarithmic(curve: Curve) -> Curve:
    """A curve of :func:`contact_area_data` in powers of ten, on both axes."""
    shown = of_compression(curve)
    positive = np.isfinite(shown.x)
    x, y = (np.log10(np.where(positive, values, 1.0)) for values in (shown.x, shown.y))
    return replace(shown, x=np.where(positive, x, np.nan), y=np.where(positive, y, np.nan))


def window(curves: Sequence[Curve], ended: int | None) -> np.ndarray:
    """Limits of x and y (two rows) that hold every state, or end below where the simulations end along one axis.

    Theories give numbers at any distance: on logarithmic axes they would press all else into a corner.

    Parameters
    ----------
    curves : sequence of Curve
        Some of it finite.
    ended : int or None
        0: x is ended, 1: y is, None: neither.
    """
    points = [np.stack([curve.x, curve.y]) for curve in curves]
    finite = [found[:, np.isfinite(found).all(axis=0)] for found in points]
    every = np.concatenate(finite, axis=1)
    if ended is not None:
        ends = [
            found[ended].min() for curve, found in zip(curves, finite, strict=True) if found.size and simulated(curve)
        ]
        every = every[:, every[ended] >= min(ends, default=-np.inf)]
    low, high = every.min(axis=1), every.max(axis=1)
    margin = np.where(high > low, 0.04 * (high - low), 0.5)
    return np.stack([low - margin, high + margin], axis=1)


def simulated(curve: Curve) -> bool:
    """Whether a curve is of a simulation: theories reach beyond any sampling."""
    return entry_of(curve.model).simulation


def path_segments(curve: Curve) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lines that join the states of a curve in the order of the path, each once: two of them retraced hide dashes.

    States that the axes do not show, being not finite, are passed over; one that is not ``fit`` ends the line.

    Returns
    -------
    numpy.ndarray, shape (number, 2, 2)
        Two ends (x, y) of every segment.
    numpy.ndarray of bool, shape (number,)
        Whether it leads to a state on the way back.
    numpy.ndarray of bool, shape (states,)
        Whether a line passes through a state.
    """
    back = np.zeros(curve.x.shape, bool) if curve.unloading is None else curve.unloading
    ends: list[np.ndarray] = []
    unloading: list[bool] = []
    joined = np.zeros(curve.x.shape, bool)
    for last, here in _followed(curve):
        joined[[last, here]] = True
        segment = np.array([[curve.x[last], curve.y[last]], [curve.x[here], curve.y[here]]])
        if not any(_retraces(segment, other) for other in ends):
            ends.append(segment)
            unloading.append(bool(back[here]))
    return np.array(ends).reshape(-1, 2, 2), np.array(unloading, bool), joined


def error_band(curve: Curve) -> np.ndarray:
    """The strip of one standard error to either side of a curve, between the states that its lines join.

    Visible errors along both axes make no strip, and none has a state whose error is not known.

    Returns
    -------
    numpy.ndarray, shape (number, 4, 2)
        Corners (x, y) of the strip's part along every segment.
    """
    x_error, y_error = _visible(curve.x_error, curve.x), _visible(curve.y_error, curve.y)
    if (x_error is None) == (y_error is None):
        return np.empty((0, 4, 2))
    none = np.zeros(curve.x.shape)
    across = np.stack([none if x_error is None else x_error, none if y_error is None else y_error], axis=1)
    points = np.stack([curve.x, curve.y], axis=1)
    low, high = points - across, points + across
    strips = [[low[last], low[here], high[here], high[last]] for last, here in _followed(curve)]
    found = np.array(strips).reshape(-1, 4, 2)
    return found[np.isfinite(found).all(axis=(1, 2))]


def _visible(error: np.ndarray | None, values: np.ndarray) -> np.ndarray | None:
    """Errors, unless all are less than a dot of the figure: what is prescribed is met to the solver's tolerance."""
    finite = values[np.isfinite(values)]
    if error is None or not finite.size or np.nanmax(error, initial=0.0) <= 2e-3 * np.ptp(finite):
        return None
    return error


def _followed(curve: Curve) -> list[tuple[int, int]]:
    """Numbers of the states that lines join, in the order of the path."""
    fit = np.ones(curve.x.shape, bool) if curve.fit is None else curve.fit
    pairs, last = [], None
    for here in range(curve.x.size):
        if not fit[here]:
            last = None
        if not fit[here] or not np.isfinite(curve.x[here] + curve.y[here]):
            continue
        if last is not None:
            pairs.append((last, here))
        last = here
    return pairs


def _retraces(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two segments are the same, in either direction, to a dot of the figures."""
    return any(np.allclose(one, ends, rtol=2e-3, atol=0.0) for ends in (other, other[::-1]))


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
    def curves(states: list[tuple[SweepPoint, PathPoint, str]]) -> list[Curve]:
        found = []
        for colour, (point, named, label) in enumerate(states):
            unit = unit_of(scales(models, point))
            for model, dataset in models.items():
                both = density_at(dataset, point, f"{name}_pdf", named, control)
                if both is None:
                    continue
                density, error = both
                with np.errstate(divide="ignore", invalid="ignore"):  # rounding may leave −0
                    logarithm = np.where(density > 0, np.log10(density * unit), np.nan)
                    # Of the logarithm; where the density may be zero it has none.
                    error = np.where(error < density, error / (density * np.log(10)), np.nan)
                centres = dataset[f"{name}_bin"].values / unit
                found.append(Curve(model, label, colour, centres, logarithm, y_error=_or_none(error)))
        return found

    units = scales(models, shown.case)
    panel_a = [(point, shown.common, point.label) for point in sweep_points(models)]
    panel_b = [(shown.case, named, point_label(named, units, control)) for named in shown.several]
    return curves(panel_a), curves(panel_b)


def density_at(
    dataset: xr.Dataset, point: SweepPoint, name: str, named: PathPoint, control: str
) -> tuple[np.ndarray, np.ndarray] | None:
    """A density at one state: its mean over the samples that converged in contact and the standard error of that.

    The error is NaN with fewer than two samples. None where there is no such state.
    """
    part = select(dataset, point)
    if part is None or name not in part or named not in (path := case_points(part, control)):
        return None
    state = part.isel(step=path.index(named))
    bins = name.replace("_pdf", "_bin")
    fit = usable(state) & state[name].notnull().any(dim=bins)
    if not fit.any():
        return None
    density = state[name].where(fit)
    dims = samples_in(density)
    if not dims:
        return density.values, np.full(density.shape, np.nan)
    return density.mean(dims).values, standard_error(density, dims).values


def smallest_resolved(curves: list[Curve]) -> float:
    """The smallest log₁₀ density that a simulation shows; theories reach below any sampling."""
    shown = [curve.y for curve in curves if simulated(curve)] or [curve.y for curve in curves]
    values = np.concatenate([np.empty(0), *shown])
    values = values[np.isfinite(values)]
    return float(max(values.min(), values.max() - 8)) if values.size else 0.0
