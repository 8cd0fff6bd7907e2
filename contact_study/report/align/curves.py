"""Curves of every model: along the path, with the scatter between surfaces and the bands of a theory; distributions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from contact_study.plots.panels import Band
from contact_study.plots.paths import Curve
from contact_study.report.align import cases
from contact_study.report.align.cases import Models, Scales, SweepPoint, scales, sweep_points
from contact_study.report.align.deviations import standard_error
from contact_study.report.models import entry_of, look_of
from contact_study.report.read.datasets import Scatter
from contact_study.report.read.load_steps import swept_dims
from contact_study.results.state import usable
from contact_study.study.case import PathPoint

_VISIBLE = 2e-3  # of a quantity: a dot of the figures


@dataclass(frozen=True)
class Axis:
    """One axis of a figure along the path: a quantity of the datasets, in a unit of the figure."""

    name: str  # variable of the datasets
    label: str
    unit: Callable[[Scales], float] = lambda scale: 1.0  # scales of a point of the sweep to the unit of the quantity


AREA = Axis("relative_contact_area", r"contact area $A/A_0$")


def pressure_axis(models: Models, reduced: bool) -> Axis:
    """Mean pressure in a unit that suits it, or over E*."""
    if reduced:
        return Axis("mean_pressure", r"pressure $p/E^*$", lambda scale: scale.contact_modulus)
    unit = cases.mean_unit(models, "mean_pressure")
    return Axis("mean_pressure", rf"pressure $p$ ({unit.name})", lambda scale: unit.size)


def gap_axis(models: Models, reduced: bool) -> Axis:
    """Mean gap in a unit that suits it, or over the rms height where there is one."""
    if reduced and scales(models, sweep_points(models)[0]).rough:
        return Axis("mean_gap", r"mean gap $\bar{u}/h_\mathrm{rms}$", lambda scale: scale.rms_height)
    unit = cases.mean_unit(models, "mean_gap")
    return Axis("mean_gap", rf"mean gap $\bar{{u}}$ ({unit.name})", lambda scale: unit.size)


def path_curves(models: Models, across: Axis, up: Axis) -> list[Curve]:
    """One curve for each model and point of the sweep; means over the samples with their standard errors."""
    curves, known = [], {point.label: scales(models, point) for point in sweep_points(models)}
    for point, model, part in cases.parts_of(models):
        if any(axis.name not in part for axis in (across, up)):
            continue
        scale = known[point.label]
        part = _with_resolved_pressure(part, scale.contact_modulus)
        found = [cases.series(part, axis.name) for axis in (across, up)]
        sizes = [axis.unit(scale) for axis in (across, up)]
        x, y = (own.values / size for own, size in zip(found, sizes, strict=True))
        errors = [own.standard_error / size for own, size in zip(found, sizes, strict=True)]
        x_error, y_error = (error if np.isfinite(error).any() else None for error in errors)
        back = np.array([bool(named[1]) if named else False for named in cases.case_points(part)])
        drawn = entry_of(model).simulation, look_of(model, models)
        curves.append(Curve(model, point.label, point.colour, x, y, x_error, y_error, found[1].fit, back, *drawn))
    return curves


def _with_resolved_pressure(part: xr.Dataset, contact_modulus: float) -> xr.Dataset:
    """The part with a pressure of zero where it is none: below the residual stress only rounding has a sign."""
    pressure = part["mean_pressure"]
    if "applied_pressure" in part.coords:
        nothing = part["applied_pressure"] == 0
    else:
        nothing = np.abs(pressure) <= (part["residual"] * contact_modulus if "residual" in part else 0.0)
    return part.assign(mean_pressure=pressure.where(~nothing, 0.0))


def scatter_strips(models: Models, scatter: Scatter, across: Axis, up: Axis) -> list[Curve]:
    """Means over the realisations, with their standard deviation in place of the error of the mean."""
    colours = {point.label: point.colour for point in sweep_points(models)}
    own = {scatter.model: scatter.dataset}
    roots = {
        point.label: np.sqrt(cases.series(part, "mean_pressure").samples) for point, _, part in cases.parts_of(own)
    }
    return [
        replace(
            curve,
            colour=colours[curve.label],
            x_error=None if curve.x_error is None else curve.x_error * roots[curve.label],
            y_error=None if curve.y_error is None else curve.y_error * roots[curve.label],
        )
        for curve in path_curves(own, across, up)
        if curve.label in colours
    ]


def path_bands(
    branches: Mapping[str, Mapping[str, xr.Dataset]], models: Models, along: Axis, across: Axis
) -> list[Band]:
    """Bands between the metastable branches of the theories, at the points of the sweep of the models."""
    bands = []
    for model, sides_of in branches.items():
        for point in sweep_points(models):
            parts = [part for dataset in sides_of.values() if (part := cases.select(dataset, point)) is not None]
            if len(parts) < 2:
                continue
            sides = [_side(part, along, across, scales(models, point)) for part in parts]
            if not all(own.size for own, _ in sides):
                continue
            # Under a prescribed gap each branch has its own pressures; the band is where both have some.
            every = np.unique(np.concatenate([own for own, _ in sides]))
            every = every[(every >= max(own[0] for own, _ in sides)) & (every <= min(own[-1] for own, _ in sides))]
            one, two = (np.interp(every, own, values) for own, values in sides)
            # Without hysteresis the branches differ by the error of their grids, which is no band.
            if np.abs(one - two).max(initial=0.0) > _VISIBLE * max(np.abs(one).max(initial=0.0), 1e-300):
                ends = np.minimum(one, two), np.maximum(one, two)
                bands.append(Band(look_of(model, models), point.colour, every, *ends))
    return bands


def _side(part: xr.Dataset, along: Axis, across: Axis, scale: Scales) -> tuple[np.ndarray, np.ndarray]:
    """Increasing pressures of one branch, and the quantity there, in the units of the figure."""
    own, found = cases.series(part, along.name), cases.series(part, across.name)
    x, y = own.values[found.fit] / along.unit(scale), found.values[found.fit] / across.unit(scale)
    finite = np.isfinite(x) & np.isfinite(y)
    x, order = np.unique(x[finite], return_index=True)
    return x, y[finite][order]


def distributions(
    models: Models,
    name: str,
    states: Sequence[tuple[SweepPoint, PathPoint, str]],
    unit_of: Callable[[Scales], float],
) -> list[Curve]:
    """Densities of "pressure" or "gap" of each state, in the unit that its scales give."""
    found = []
    for colour, (point, named, label) in enumerate(states):
        unit = unit_of(scales(models, point))
        for model, dataset in models.items():
            both = density_at(dataset, point, f"{name}_pdf", named)
            if both is None:
                continue
            density, error = (values * unit for values in both)
            known = error if np.isfinite(error).any() else None
            density = np.where(density > 0, density, np.nan)
            x, drawn = dataset[f"{name}_bin"].values / unit, (entry_of(model).simulation, look_of(model, models))
            found.append(Curve(model, label, colour, x, density, None, known, None, None, *drawn))
    return found


def density_at(
    dataset: xr.Dataset, point: SweepPoint, name: str, named: PathPoint
) -> tuple[np.ndarray, np.ndarray] | None:
    """A density at one state: its mean over the samples that converged in contact and the standard error of that.

    The error is NaN with fewer than two samples. None where there is no such state.
    """
    state = cases.state_at(dataset, point, named)
    if state is None or name not in state:
        return None
    fit = usable(state) & state[name].notnull().any(dim=name.replace("_pdf", "_bin"))
    if not fit.any():
        return None
    density = state[name].where(fit)
    dims = swept_dims(density)
    if not dims:
        return density.values, np.full(density.shape, np.nan)
    return density.mean(dims).values, standard_error(density, dims).values
