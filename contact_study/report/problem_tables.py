"""The report's tables of the problem and of the work: regime, material and interface, effort."""

from collections.abc import Callable, Mapping

import numpy as np
import xarray as xr

from contact_study.plots.style import Unit, length_unit, pressure_unit
from contact_study.report.align.cases import (
    constant,
    first_constant,
    select,
    sweep_points,
)
from contact_study.report.facts.overview import effort
from contact_study.report.models import entry_of
from contact_study.report.tables import NOTHING, Table, plain_table
from contact_study.report.text.wording import (
    fixed,
    number,
)

_REGIME = (
    ("tabor_parameter", "Tabor parameter μ", 2),
    ("process_zone", "process zone", 1),
    ("pixel_over_process_zone", "grid spacing / process zone", 2),
    ("adhesion_over_elastic_energy", "θ = Δγ S / U_full", 2),
    ("full_contact_stress_over_peak", "full-contact stress / σ_max", 2),
    ("rms_slope", "rms gradient", 3),
)


def regime_table(models: Mapping[str, xr.Dataset], regime: xr.Dataset) -> Table:
    """Regime numbers, a row for each point of the sweep, without columns that have no number."""
    columns = [column for column in _REGIME if (regime[column[0]].fillna(0) != 0).any()]
    zone = length_unit(float(regime["process_zone"].fillna(0).max()))
    rows = []
    for point in sweep_points(models):
        part = select(regime, point)
        if part is not None:
            sizes = {"process_zone": zone.size}
            rows.append(
                [
                    point.label,
                    *(_fixed(float(part[name]) / sizes.get(name, 1.0), digits) for name, _, digits in columns),
                ]
            )
    header = [f"{words} ({zone.name})" if name == "process_zone" else words for name, words, _ in columns]
    return plain_table(["", *header], rows)


def constants_table(models: Mapping[str, xr.Dataset]) -> Table:
    """Inputs of continuum and theories beside what the atomistic model measured on itself."""
    stress = pressure_unit(max(first_constant(models, point, "contact_modulus") for point in sweep_points(models)))
    distance, height = (_length_unit(models, name) for name in ("equilibrium_distance", "rms_height"))
    columns = {
        "contact_modulus": (f"E* ({stress.name})", stress.size),
        "work_of_adhesion": ("Δγ (J/m²)", 1.0),
        "equilibrium_distance": (f"d_eq ({distance.name})", distance.size),
        "peak_tensile_stress": (f"σ_max ({stress.name})", stress.size),
        "rms_height": (f"h_rms ({height.name})", height.size),
        "rms_slope": ("rms gradient", 1.0),
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
    return plain_table(["", "model", *(words for words, _ in used.values())], rows)


def _length_unit(models: Mapping[str, xr.Dataset], name: str) -> Unit:
    return length_unit(max((float(dataset[name].max()) for dataset in models.values() if name in dataset), default=0.0))


def effort_table(models: Mapping[str, xr.Dataset]) -> Table:
    """Work done by each model and how its steps ended."""
    counts = {
        "fft_pairs": "FFT pairs",
        "force_evaluations": "force evaluations",
        "iterations": "iterations",
        "wall_time": "time of all steps (s)",
    }
    used = {name: words for name, words in counts.items() if any(name in dataset for dataset in models.values())}
    total: Callable[[xr.DataArray], str] = lambda values: f"{float(values.where(values >= 0).sum()):.0f}"  # noqa: E731
    rows = []
    for model, dataset in models.items():
        work = [total(dataset[name]) if name in dataset else NOTHING for name in used]
        detached = dataset["detached"] == 1 if "detached" in dataset else False
        residual = float(dataset["residual"].where(~detached).max()) if "residual" in dataset else np.nan
        endings = map(str, effort(dataset))
        rows.append([entry_of(model).label, *endings, f"{residual:.1e}".replace("-", "−"), *work])
    return plain_table(["model", "steps", "not converged", "detached", "largest residual", *used.values()], rows)


def _fixed(value: float, decimals: int) -> str:
    return fixed(value, decimals) if np.isfinite(value) else NOTHING
