"""Curves of every model: along the path, with the scatter between surfaces and the bands of a theory; distributions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from contact_study.plots.paths import Curve
from contact_study.report.align.cases import Series, SweepPoint, case_points, select, series, sweep_points
from contact_study.report.align.ensemble import standard_error
from contact_study.report.align.scales import Scales, mean_pressure_unit, scales
from contact_study.report.models import entry_of
from contact_study.report.read.load_steps import samples_in
from contact_study.report.read.scatter import Scatter
from contact_study.results.state import usable
from contact_study.study.load_steps import PathPoint

_VISIBLE = 2e-3  # of a quantity: a dot of the figures


@dataclass(frozen=True)
class Axis:
    """One axis of a figure along the path: a quantity of the datasets, in a unit of the figure."""

    name: str  # variable of the datasets
    unit: Callable[[Scales], float] = lambda scale: 1.0  # scales of a point of the sweep to the unit of the quantity
    logarithm: bool = False  # whether the natural logarithm is shown, of what is positive

    def values(self, quantity: np.ndarray, scale: Scales) -> np.ndarray:
        """The quantity on this axis."""
        if not self.logarithm:
            return quantity / self.unit(scale)
        return np.log(np.where(quantity > 0, quantity, np.nan) / self.unit(scale))

    def errors(self, found: Series, scale: Scales) -> np.ndarray | None:
        """Its standard error on this axis, None where there is none."""
        error = found.standard_error / self.unit(scale)
        if self.logarithm:  # without error where the quantity may be zero
            positive = np.where(found.values > 0, found.values, np.nan)
            error = np.where(found.standard_error < positive, found.standard_error / positive, np.nan)
        return error if np.isfinite(error).any() else None


_AREA, _GAP = Axis("relative_contact_area"), Axis("mean_gap", lambda scale: scale.rms_height)
_OVER_MODULUS = Axis("mean_pressure", lambda scale: scale.contact_modulus)
_LOG_PRESSURE = replace(_OVER_MODULUS, logarithm=True)


@dataclass(frozen=True)
class PathCurves:
    """Curves along the path, of contact area over pressure and of pressure over mean gap."""

    areas: list[Curve]  # A/A₀ against the mean pressure, the paper's figure 3
    gaps: list[Curve]  # ln(p/E*) against ū/h_rms for p > 0, the paper's figure 4
    linear_gaps: list[Curve]  # p/E* against ū/h_rms, tension included

    @property
    def in_compression(self) -> bool:
        """Whether some contact area has a state to show on logarithmic axes."""
        return any(((curve.x > 0) & (curve.y > 0)).any() for curve in self.areas)

    @property
    def gap_panels(self) -> list[str]:
        """Panels of the mean gap: ``"logarithmic"`` where there is compression, ``"linear"`` where there is tension."""
        compressed = any(curve.finite.any() for curve in self.gaps)
        pulled = any((np.isfinite(curve.x) & (curve.y < 0)).any() for curve in self.linear_gaps)
        return [name for name, there in (("logarithmic", compressed), ("linear", pulled)) if there]


def path_curves(models: Mapping[str, xr.Dataset], control: str, unit: float | None = None) -> PathCurves:
    """Every curve along the path; contact areas over pressures in ``unit`` (Pa), by default the axis' own."""
    pressure = _pressure_axis(mean_pressure_unit(models).size if unit is None else unit)
    return PathCurves(
        _along_the_path(models, control, pressure, _AREA),
        _along_the_path(models, control, _GAP, _LOG_PRESSURE),
        _along_the_path(models, control, _GAP, _OVER_MODULUS),
    )


def _pressure_axis(unit: float) -> Axis:
    return Axis("mean_pressure", lambda scale: unit)


def _along_the_path(models: Mapping[str, xr.Dataset], control: str, across: Axis, up: Axis) -> list[Curve]:
    curves = []
    for colour, point in enumerate(sweep_points(models)):
        scale = scales(models, point)
        for model, dataset in models.items():
            part = select(dataset, point)
            if part is None or any(axis.name not in part for axis in (across, up)):
                continue
            part = _with_resolved_pressure(part, control, scale.contact_modulus)
            found = [series(part, axis.name) for axis in (across, up)]
            x, y = (axis.values(own.values, scale) for axis, own in zip((across, up), found, strict=True))
            if up.logarithm:
                x = np.where(np.isfinite(y), x, np.nan)
            x_error, y_error = (axis.errors(own, scale) for axis, own in zip((across, up), found, strict=True))
            back = np.array([bool(named[1]) if named else False for named in case_points(part, control)])
            simulated = entry_of(model).simulation
            curves.append(Curve(model, point.label, colour, x, y, x_error, y_error, found[1].fit, back, simulated))
    return curves


def _with_resolved_pressure(part: xr.Dataset, control: str, contact_modulus: float) -> xr.Dataset:
    """The part with a pressure of zero where it is none: below the residual stress only rounding has a sign."""
    pressure = part["mean_pressure"]
    if control == "pressure":
        nothing = part["applied_pressure"] == 0
    else:
        nothing = np.abs(pressure) <= (part["residual"] * contact_modulus if "residual" in part else 0.0)
    return part.assign(mean_pressure=pressure.where(~nothing, 0.0))


@dataclass(frozen=True)
class Strips:
    """The scatter between realisations of a surface."""

    model: str  # name of the entry of the model that has it
    surfaces: int  # how many realisations
    curves: PathCurves  # means over them, whose errors are standard deviations

    @property
    def label(self) -> str:
        """In a legend."""
        return f"{entry_of(self.model).label}, {self.surfaces} surfaces"


def scatter_strips(models: Mapping[str, xr.Dataset], scatter: Scatter, control: str) -> Strips:
    """Means over the realisations, with their standard deviation in place of the error of the mean."""
    colours = {point.label: number for number, point in enumerate(sweep_points(models))}
    own = {scatter.model: scatter.dataset}
    roots = {point.label: _root_of_samples(scatter.dataset, point) for point in sweep_points(own)}

    def deviating(curves: list[Curve]) -> list[Curve]:
        return [
            replace(
                curve,
                colour=colours[curve.label],
                x_error=None if curve.x_error is None else curve.x_error * roots[curve.label],
                y_error=None if curve.y_error is None else curve.y_error * roots[curve.label],
            )
            for curve in curves
            if curve.label in colours
        ]

    found = path_curves(own, control)
    curves = PathCurves(deviating(found.areas), deviating(found.gaps), deviating(found.linear_gaps))
    return Strips(scatter.model, scatter.surfaces, curves)


def _root_of_samples(dataset: xr.Dataset, point: SweepPoint) -> np.ndarray:
    part = select(dataset, point)
    assert part is not None
    return np.sqrt(series(part, "mean_pressure").samples)


@dataclass(frozen=True)
class Band:
    """The band between the two metastable branches of a theory at one point of the sweep."""

    model: str  # name of the theory's entry
    colour: int  # number of the colour
    along: np.ndarray  # increasing pressures, in the units of the figure
    low: np.ndarray  # the enclosed quantity
    high: np.ndarray


@dataclass(frozen=True)
class PathBands:
    """Bands for the curves of :class:`PathCurves`."""

    areas: list[Band]
    gaps: list[Band]
    linear_gaps: list[Band]

    @property
    def models(self) -> list[str]:
        """Theories that have some."""
        return list(dict.fromkeys(band.model for found in vars(self).values() for band in found))


def path_bands(
    branches: Mapping[str, Mapping[str, xr.Dataset]], models: Mapping[str, xr.Dataset], unit: float | None = None
) -> PathBands:
    """Bands between the branches, at the points of the sweep and in the units of the models' curves."""
    pressure = _pressure_axis(mean_pressure_unit(models).size if unit is None else unit)
    pairs = ((pressure, _AREA), (_LOG_PRESSURE, _GAP), (_OVER_MODULUS, _GAP))
    return PathBands(*(_bands(branches, models, along, across) for along, across in pairs))


def _bands(
    branches: Mapping[str, Mapping[str, xr.Dataset]], models: Mapping[str, xr.Dataset], along: Axis, across: Axis
) -> list[Band]:
    bands = []
    for model, sides_of in branches.items():
        for colour, point in enumerate(sweep_points(models)):
            parts = [part for dataset in sides_of.values() if (part := select(dataset, point)) is not None]
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
                bands.append(Band(model, colour, every, np.minimum(one, two), np.maximum(one, two)))
    return bands


def _side(part: xr.Dataset, along: Axis, across: Axis, scale: Scales) -> tuple[np.ndarray, np.ndarray]:
    """Increasing pressures of one branch, and the quantity there, in the units of the figure."""
    own, found = series(part, along.name), series(part, across.name)
    x, y = along.values(own.values[found.fit], scale), across.values(found.values[found.fit], scale)
    finite = np.isfinite(x) & np.isfinite(y)
    x, order = np.unique(x[finite], return_index=True)
    return x, y[finite][order]


def distributions(
    models: Mapping[str, xr.Dataset],
    control: str,
    name: str,
    states: Sequence[tuple[SweepPoint, PathPoint, str]],
) -> list[Curve]:
    """Decimal logarithm of the density of stress or gap, in units of E* or h_rms: the paper's figures 1 and 2."""
    found = []
    for colour, (point, named, label) in enumerate(states):
        scale = scales(models, point)
        unit = scale.contact_modulus if name == "pressure" else scale.rms_height
        for model, dataset in models.items():
            both = density_at(dataset, point, f"{name}_pdf", named, control)
            if both is None:
                continue
            density, error = both
            with np.errstate(divide="ignore", invalid="ignore"):  # rounding may leave −0
                logarithm = np.where(density > 0, np.log10(density * unit), np.nan)
                # Of the logarithm; where the density may be zero it has none.
                error = np.where(error < density, error / (density * np.log(10)), np.nan)
            curve = Curve(model, label, colour, dataset[f"{name}_bin"].values / unit, logarithm)
            known = error if np.isfinite(error).any() else None
            found.append(replace(curve, y_error=known, simulated=entry_of(model).simulation))
    return found


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
    fit = usable(state) & state[name].notnull().any(dim=name.replace("_pdf", "_bin"))
    if not fit.any():
        return None
    density = state[name].where(fit)
    dims = samples_in(density)
    if not dims:
        return density.values, np.full(density.shape, np.nan)
    return density.mean(dims).values, standard_error(density, dims).values
