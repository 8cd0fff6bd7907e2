"""Regime numbers of a contact, from its roughness, its modulus and its adhesion."""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import Elasticity
from contact_study.physics.spheres.numbers import tabor_parameter
from contact_study.report.align.cases import SweepPoint, constant, first_constant, select, sweep_points
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.load_steps import averaged
from contact_study.study.case import Case, realise


@dataclass(frozen=True)
class Roughness:
    """Moments of one surface."""

    rms_height: float  # (m)
    rms_slope: float  # √<|∇h|²>
    rms_laplacian: float  # √<(∇²h)²> (1/m)
    area_factor: float  # true over projected area, <√(1 + |∇h|²)>
    conformal_energy: float  # elastic energy of full contact over the contact modulus, ½ Σ K |h_q|²/E* per area (m)
    conformal_stress: float  # deviation of the stress of full contact over the contact modulus, √(Σ K² |h_q|²)/E*


def roughness(heights: np.ndarray, size: tuple[float, float], solid: Elasticity) -> Roughness:
    """Moments of a periodic surface (m) of some periods along y and x (m) on what full contact deforms."""
    grid = Grid(heights.shape, size)
    stiffness_q = solid.stiffness_on(grid) / solid.contact_modulus
    spectrum_q = fourier.transform(heights - heights.mean())
    power_q = grid.variances(spectrum_q)
    q = grid.wavenumber
    slope_y, slope_x = (fourier.synthesise(1j * axis * spectrum_q, heights.shape) for axis in grid.wavevectors)
    return Roughness(
        rms_height=float(np.sqrt(np.sum(power_q))),
        rms_slope=float(np.sqrt(np.sum(q**2 * power_q))),
        rms_laplacian=float(np.sqrt(np.sum(q**4 * power_q))),
        area_factor=float(np.mean(np.sqrt(1 + slope_y**2 + slope_x**2))),
        conformal_energy=float(0.5 * np.sum(stiffness_q * power_q)),
        conformal_stress=float(np.sqrt(np.sum(stiffness_q**2 * power_q))),
    )


def compute_regime(inputs: Inputs) -> xr.Dataset:
    """Regime numbers at each point of the sweep, on its swept dimensions without the seed.

    Where seeds are swept, numbers of the surface are those of the first seed, and their ``long_name`` states it.

    With R = 2/√<(∇²h)²>, the radius of the root-mean-square mean curvature, the Tabor parameter at the scale of the
    roughness is μ = (R Δγ²/E*² r₀³)^(1/3); θ = Δγ S/U_full compares what full contact gains with what it costs
    (Persson and Tosatti, J. Chem. Phys. 115, 5597 (2001)).
    """
    models, points = inputs.models, sweep_points(inputs.models)
    numbers = [_regime(inputs, point) for point in points]
    axes = {dim: list(dict.fromkeys(point.selection[dim] for point in points)) for dim in points[0].selection}
    attrs = {d: next(dataset[d].attrs for dataset in models.values() if d in dataset.dims) for d in axes}
    averages = [averaged(dataset) for dataset in models.values() if dataset.sizes.get(averaged(dataset), 1) > 1]
    data = {}
    for name, (units, long_name) in MEANINGS.items():
        values = np.reshape([row[name] for row in numbers], [len(own) for own in axes.values()])
        whose = f", surface of the first {averages[0]}" if averages and name in _OF_THE_SURFACE else ""
        data[name] = (list(axes), values, {"units": units, "long_name": long_name + whose})
    return xr.Dataset(data, {dim: (dim, own, attrs[dim]) for dim, own in axes.items()})


MEANINGS = {
    "tabor_parameter": ("1", "Tabor parameter at the scale of the roughness, R = 2 / rms Laplacian"),
    "process_zone": ("m", "length of the process zone of a crack, E* Δγ / σ_max²"),
    "pixel_over_process_zone": ("1", "grid spacing of the continuum over the process zone"),
    "adhesion_over_elastic_energy": ("1", "θ = Δγ S / U_full, adhesion gained over elastic energy of full contact"),
    "full_contact_stress_over_peak": ("1", "rms stress of full contact over the largest tensile stress"),
    "full_contact_energy": ("J m-2", "elastic energy of full contact per nominal area"),
    "area_factor": ("1", "true over projected area of the surface"),
    "rms_slope": ("1", "root-mean-square slope of the surface"),
    "rms_laplacian": ("m-1", "root-mean-square Laplacian of the surface"),
}
_OF_THE_SURFACE = set(MEANINGS) - {"process_zone", "pixel_over_process_zone"}


def _regime(inputs: Inputs, point: SweepPoint) -> dict[str, float]:
    models, case = inputs.models, next(iter(inputs.cases_at(point.selection)), None)
    surface = _roughness_of(inputs, point, case)
    modulus, work, peak = (
        first_constant(models, point, name) for name in ("contact_modulus", "work_of_adhesion", "peak_tensile_stress")
    )
    zone = modulus * work / peak**2 if peak > 0 else np.nan
    parts = [select(models[name], point) for name in models if entry_of(name).feels_law]
    pixel = max((constant(part, "pixel") for part in parts if part is not None and "pixel" in part), default=np.nan)
    numbers = dict.fromkeys(MEANINGS, float("nan"))
    numbers |= {"process_zone": zone, "pixel_over_process_zone": pixel / zone if zone else np.nan}
    if surface is None or surface.rms_slope == 0:
        return numbers
    energy, radius = modulus * surface.conformal_energy, 2 / surface.rms_laplacian
    # The length r₀ of the Tabor parameter: the equilibrium distance or, outside a wall, the law's range.
    reach = (
        case.law.length
        if case is not None and case.law.has_wall
        else first_constant(models, point, "equilibrium_distance")
    )
    return numbers | {
        "tabor_parameter": float(tabor_parameter(radius, modulus, work, reach)) if reach > 0 else np.nan,
        "adhesion_over_elastic_energy": work * surface.area_factor / energy,
        "full_contact_stress_over_peak": modulus * surface.conformal_stress / peak if peak > 0 else np.nan,
        "full_contact_energy": energy,
        **{name: getattr(surface, name) for name in ("area_factor", "rms_slope", "rms_laplacian")},
    }


def _roughness_of(inputs: Inputs, point: SweepPoint, case: Case | None) -> Roughness | None:
    """Moments of the surface of a point of the sweep, of its first seed.

    None for what is no periodic roughness, and for a point that only the sweeps together would hold.
    """
    if case is None or not case.geometry.periodic:
        return None
    with suppress(InputError):  # the height map may be missing
        surface = realise(case)
        return roughness(surface.sampled, surface.size, case.solid)
    for part in (select(dataset, point) for dataset in inputs.models.values()):
        if part is not None and "height" in part and part["height"].ndim == 2:
            y, x = (part[axis].values[np.isfinite(part[axis].values)] for axis in ("y", "x"))
            heights = part["height"].values[: y.size, : x.size]
            return roughness(heights, (y.size * (y[1] - y[0]), x.size * (x[1] - x[0])), case.solid)
    return None
