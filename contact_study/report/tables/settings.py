"""The report's tables of what was computed: regime, material and interface, effort and convergence."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from contact_study.plots.style import Unit, length_unit, pressure_unit
from contact_study.report.align.cases import constant, first_constant, select, sweep_points
from contact_study.report.models import entry_of
from contact_study.report.tables.table import NOTHING, Table, fixed_or_nothing
from contact_study.report.text.wording import number
from contact_study.results.schema import RESOLUTION_ERROR

# Of a pull-off pressure in the unit of the contact modulus.
_DECIMALS = 3

_REGIME = (
    ("tabor_parameter", "Tabor parameter μ", 2),
    ("process_zone", "process zone", 1),
    ("pixel_over_process_zone", "grid spacing / process zone", 2),
    ("adhesion_over_elastic_energy", "θ = Δγ S / U_full", 2),
    ("full_contact_stress_over_peak", "full-contact stress / σ_max", 2),
    ("rms_slope", "rms slope", 3),
)


def regime_table(models: Mapping[str, xr.Dataset], regime: xr.Dataset) -> Table:
    """Regime numbers, and the pull-off pressures of theories and simulated paths; a row for each point of the sweep.

    Columns without a number, such as those of adhesion for a hard wall, are left out.
    """
    unit = _stress_unit(models)
    columns = [column for column in _REGIME if (regime[column[0]].fillna(0) != 0).any()]
    zone = length_unit(float(regime["process_zone"].fillna(0).max()))
    pulled = [name for name, dataset in models.items() if "pull_off_pressure" in dataset]
    rows = []
    for point in sweep_points(models):
        part = select(regime, point)
        if part is None:
            continue
        cells = [
            fixed_or_nothing(float(part[name]) / (zone.size if name == "process_zone" else 1), decimals)
            for name, _, decimals in columns
        ]
        cells += [_pull_off(select(models[name], point), unit) for name in pulled]
        rows.append([point.label, *cells])
    header = ["", *(f"{words} ({zone.name})" if name == "process_zone" else words for name, words, _ in columns)]
    header += [f"pull-off, {entry_of(name).short} ({unit.name})" for name in pulled]
    return Table("Regime numbers", header, rows)


def _pull_off(part: xr.Dataset | None, unit: Unit) -> str:
    """The pull-off pressure of a point of the sweep; of a path the pressures that it lies between."""
    if part is None:
        return NOTHING
    held, below = (constant(part, f"pull_off_pressure{name}") / unit.size for name in ("", RESOLUTION_ERROR))
    upper = fixed_or_nothing(held, _DECIMALS)
    lower = fixed_or_nothing(held - below, _DECIMALS)
    return upper if lower in (upper, NOTHING) else f"{lower} to {upper}"


def _stress_unit(models: Mapping[str, xr.Dataset]) -> Unit:
    """The unit in which the contact modulus reads well, for stresses that no path prescribes."""
    return pressure_unit(max(first_constant(models, point, "contact_modulus") for point in sweep_points(models)))


def _length_unit(models: Mapping[str, xr.Dataset], name: str) -> Unit:
    return length_unit(max((float(dataset[name].max()) for dataset in models.values() if name in dataset), default=0.0))


def constants_table(models: Mapping[str, xr.Dataset]) -> Table:
    """Inputs of continuum and theories beside what the atomistic model measured on itself."""
    stress = _stress_unit(models)
    distance, height = (_length_unit(models, name) for name in ("equilibrium_distance", "rms_height"))
    columns = {
        "contact_modulus": (f"E* ({stress.name})", stress.size),
        "work_of_adhesion": ("Δγ (J/m²)", 1.0),
        "equilibrium_distance": (f"d_eq ({distance.name})", distance.size),
        "peak_tensile_stress": (f"σ_max ({stress.name})", stress.size),
        "rms_height": (f"h_rms ({height.name})", height.size),
        "rms_slope": ("rms slope", 1.0),
    }
    used = {name: column for name, column in columns.items() if any(name in dataset for dataset in models.values())}
    rows = []
    for point in sweep_points(models):
        for model, dataset in models.items():
            part = select(dataset, point)
            if part is None or not any(name in part for name in used):
                continue
            values = [constant(part, name) / size for name, (_, size) in used.items()]
            cells = [number(value, 5) if np.isfinite(value) else NOTHING for value in values]
            rows.append([point.label, entry_of(model).label, *cells])
    return Table("Material and interface", ["", "model", *(words for words, _ in used.values())], rows)


def effort_table(models: Mapping[str, xr.Dataset]) -> Table:
    """Work done by each model and how its steps ended."""
    counts = {
        "fft_pairs": "FFT pairs",
        "force_evaluations": "force evaluations",
        "iterations": "iterations",
        "wall_time": "time of all steps (s)",
    }
    used = {name: words for name, words in counts.items() if any(name in dataset for dataset in models.values())}
    rows = []
    for model, dataset in models.items():
        solved = dataset["relative_contact_area"].notnull()
        detached = dataset["detached"] == 1 if "detached" in dataset else xr.zeros_like(solved)
        unconverged = (dataset["converged"] == 0) & ~detached if "converged" in dataset else xr.zeros_like(solved)
        residual = dataset["residual"].where(~detached).max() if "residual" in dataset else np.nan
        work = [
            f"{float(dataset[name].where(dataset[name] >= 0).sum()):.0f}" if name in dataset else NOTHING
            for name in used
        ]
        endings = [str(int(solved.sum())), str(int(unconverged.sum())), str(int(detached.sum()))]
        rows.append([entry_of(model).label, *endings, f"{float(residual):.1e}".replace("-", "−"), *work])
    header = ["model", "steps", "not converged", "detached", "largest residual", *used.values()]
    return Table("Effort and convergence", header, rows)


def unconverged_steps(models: Mapping[str, xr.Dataset]) -> int:
    """Steps that did not meet the tolerance, those without contact aside."""
    total = 0
    for dataset in models.values():
        if "converged" in dataset:
            attached = dataset["detached"] != 1 if "detached" in dataset else True
            total += int(((dataset["converged"] == 0) & attached).sum())
    return total
