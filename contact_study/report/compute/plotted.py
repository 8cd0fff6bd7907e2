"""What the figures show, as arrays; :mod:`contact_study.report.draw.figures` draws it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from contact_study.report.compute.cases import SweepPoint, case_points, select, series, sweep_points
from contact_study.report.compute.curves import Curve
from contact_study.report.compute.ensemble import standard_error
from contact_study.report.compute.scales import Scales, mean_pressure_unit, scales
from contact_study.report.compute.shown_states import PanelPoints, point_label
from contact_study.report.read.load_steps import samples_in, usable
from contact_study.study.load_steps import PathPoint


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
