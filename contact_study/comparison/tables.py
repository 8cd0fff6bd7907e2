"""The report's tables: numbers turned into text, with units, a dash where there is none."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from contact_study.comparison.cases import (
    SweepPoint,
    case_points,
    constant,
    first_constant,
    select,
    series,
    sweep_points,
)
from contact_study.comparison.deviations import COMPARED, DETACHED, NOT_CONVERGED
from contact_study.comparison.figures import MODEL_NAMES
from contact_study.comparison.findings import split_pair, spread
from contact_study.comparison.path_points import Point
from contact_study.comparison.plotted import Scales, scales
from contact_study.comparison.wording import (
    Unit,
    control_unit,
    fixed,
    length_unit,
    number,
    percent,
    percent_of,
    pressure_unit,
)

NOTHING = "–"

# Columns are narrow.
SHORT_NAMES = {"atomistic": "atoms", "continuum": "continuum", "theory": "Persson", "gap_flow": "gap\u00a0flow"}


@dataclass(frozen=True)
class Table:
    """Text in rows and columns.

    Attributes
    ----------
    title : str
        What it holds.
    header : list of str
        Names and units of the columns.
    rows : list of list of str
        Cells.
    groups : list of tuple
        Words over neighbouring columns and how many each spans.
    """

    title: str
    header: list[str]
    rows: list[list[str]]
    groups: list[tuple[str, int]] = field(default_factory=list)


def results_tables(models: Mapping[str, xr.Dataset], control: str) -> list[Table]:
    """Contact area and mean gap of every model, one table for each point of the sweep."""
    tables, unit = [], control_unit(models, control)
    for point in sweep_points(models):
        parts = {name: part for name, dataset in models.items() if (part := select(dataset, point)) is not None}
        path = _union_of_paths(parts, control)
        scale = scales(models, point)
        gaps = scale.height_symbol
        columns = [
            _column(part, quantity, size, path, control)
            for quantity, size in (("relative_contact_area", 1.0), ("mean_gap", scale.rms_height))
            for part in parts.values()
        ]
        points = [_point_cells(named, unit, scale, control) for named in path]
        rows = [[*cells, *numbers] for cells, numbers in zip(points, zip(*columns, strict=True), strict=True)]
        names = [SHORT_NAMES[name] for name in parts]
        groups = [("", 2), ("contact area A/A₀", len(parts)), (f"mean gap ū ({gaps})", len(parts))]
        tables.append(Table(point.label, [*_point_header(control, unit, gaps), *names, *names], rows, groups))
    return tables


def _union_of_paths(parts: Mapping[str, xr.Dataset], control: str) -> list[Point]:
    return list(dict.fromkeys(named for part in parts.values() for named in case_points(part, control) if named))


def _point_header(control: str, unit: Unit, gaps: str) -> list[str]:
    return [f"p ({unit.name})", "p/E*"] if control == "pressure" else [f"ū ({unit.name})", f"ū ({gaps})"]


def _point_cells(named: Point, unit: Unit, scale: Scales, control: str) -> list[str]:
    value = float(named[0])
    shown = number(value / unit.size, 5) + (" ↩" if named[1] else "")
    return [shown, number(value / (scale.contact_modulus if control == "pressure" else scale.rms_height), 4)]


def _column(part: xr.Dataset, quantity: str, scale: float, path: list[Point], control: str) -> list[str]:
    """One quantity of one model at the given points of the path."""
    if quantity not in part:
        return [NOTHING] * len(path)
    own, found = case_points(part, control), series(part, quantity)
    flags = part["detached"].values if "detached" in part else np.zeros(len(own))
    detached = np.all(flags.reshape(-1, len(own)) == 1, axis=0)
    decimals = 4 if quantity == "relative_contact_area" else 3
    cells = []
    for named in path:
        step = own.index(named) if named in own else None
        if step is None:
            cells.append(NOTHING)
        elif detached[step]:
            cells.append("detached")
        else:
            value, error = found.values[step] / scale, found.standard_error[step] / scale
            spread = f" ± {fixed(error, decimals)}" if np.isfinite(error) else ""
            cells.append(
                _fixed_or_nothing(value, decimals) + spread + ("" if found.fit[step] or np.isnan(value) else " *")
            )
    return cells


def deviation_tables(models: Mapping[str, xr.Dataset], deviations: xr.Dataset, control: str) -> list[Table]:
    """Deviations of every pair, one table for each point of the sweep: area relative, mean gap in units of h_rms."""
    tables, unit = [], control_unit(models, control)
    for point in sweep_points(models):
        part = select(deviations, point)
        if part is None:
            continue
        scale = scales(models, point)
        pairs = list(part["pair"].values)
        names = [pair_name(pair) for pair in pairs]
        rows = []
        for step, named in enumerate(case_points(part, control)):
            if named is None:
                continue
            here = part.isel(step=step)
            area = [_deviation(here.sel(pair=p), "relative_contact_area_relative_deviation", 1.0) for p in pairs]
            gap = [_deviation(here.sel(pair=p), "mean_gap_deviation", scale.rms_height) for p in pairs]
            rows.append([*_point_cells(named, unit, scale, control)[:1], *area, *gap])
        gaps = scale.height_symbol
        groups = [("", 1), ("contact area, relative", len(pairs)), (f"mean gap ({gaps})", len(pairs))]
        tables.append(Table(point.label, [_point_header(control, unit, gaps)[0], *names, *names], rows, groups))
    return tables


def pair_name(pair: str) -> str:
    """A pair as the head of a column."""
    model, reference = split_pair(pair)
    return f"{SHORT_NAMES[model]} − {SHORT_NAMES[reference]}"


def summary_table(models: Mapping[str, xr.Dataset], deviations: xr.Dataset) -> Table:
    """Medians of the magnitudes of all deviations, a row for each pair, columns over the sweep."""
    points = sweep_points(models)
    rows = []
    for pair in deviations["pair"].values:
        area = [_median(deviations, pair, "relative_contact_area_relative_deviation", point, 1.0) for point in points]
        heights = [scales(models, point).rms_height for point in points]
        gap = [_median(deviations, pair, "mean_gap_deviation", p, h) for p, h in zip(points, heights, strict=True)]
        rows.append(
            [
                pair_name(pair),
                *(NOTHING if np.isnan(value) else percent_of(value) for value in area),
                *(_fixed_or_nothing(value, 3) for value in gap),
            ]
        )
    labels = [point.label for point in points]
    symbol = scales(models, points[0]).height_symbol
    groups = [("", 1), ("contact area, relative", len(points)), (f"mean gap ({symbol})", len(points))]
    return Table("Median magnitude of the deviations", ["", *labels, *labels], rows, groups)


def _median(deviations: xr.Dataset, pair: str, name: str, point: SweepPoint, scale: float) -> float:
    try:
        return spread(deviations, pair, name, [point], {point.label: scale}).median
    except ValueError:
        return float("nan")


def _deviation(here: xr.Dataset, name: str, scale: float) -> str:
    if name not in here:
        return NOTHING
    mean = here[f"{name}_mean"] if f"{name}_mean" in here else here[name]
    value = float(mean) / scale
    if np.isfinite(value):
        text = percent(value) if "relative_deviation" in name else fixed(value, 3, plus=True)
        error = float(here[f"{name}_standard_error"]) / scale if f"{name}_standard_error" in here else np.nan
        if np.isfinite(error):
            text += f" ± {100 * error:.1f} %" if "relative_deviation" in name else f" ± {error:.3f}"
        return text
    states = np.atleast_1d(here["state"].values)
    if (states == DETACHED).all():
        return "detached"
    return "not converged" if (states == NOT_CONVERGED).any() and not (states == COMPARED).any() else NOTHING


_REGIME = (
    ("tabor_parameter", "Tabor parameter μ", 2),
    ("process_zone", "process zone", 1),
    ("pixel_over_process_zone", "grid spacing / process zone", 2),
    ("adhesion_over_elastic_energy", "θ = Δγ S / U_full", 2),
    ("full_contact_stress_over_peak", "full-contact stress / σ_max", 2),
    ("rms_slope", "rms slope", 3),
)


def regime_table(models: Mapping[str, xr.Dataset], regime: xr.Dataset) -> Table:
    """Regime numbers, and the pull-off pressures that the theories predict; a row for each point of the sweep.

    Columns without a number, such as those of adhesion for a hard wall, are left out.
    """
    unit = _stress_unit(models)
    columns = [column for column in _REGIME if (regime[column[0]].fillna(0) != 0).any()]
    zone = length_unit(float(regime["process_zone"].fillna(0).max()))
    theories = [name for name in ("theory", "gap_flow") if "pull_off_pressure" in models.get(name, ())]
    rows = []
    for point in sweep_points(models):
        part = select(regime, point)
        if part is None:
            continue
        cells = [
            _fixed_or_nothing(float(part[name]) / (zone.size if name == "process_zone" else 1), decimals)
            for name, _, decimals in columns
        ]
        pulls = [select(models[name], point) for name in theories]
        cells += [
            NOTHING if pull is None else _fixed_or_nothing(constant(pull, "pull_off_pressure") / unit.size, 3)
            for pull in pulls
        ]
        rows.append([point.label, *cells])
    header = ["", *(f"{words} ({zone.name})" if name == "process_zone" else words for name, words, _ in columns)]
    header += [f"pull-off, {SHORT_NAMES[name]} ({unit.name})" for name in theories]
    return Table("Regime numbers", header, rows)


def _fixed_or_nothing(value: float, decimals: int) -> str:
    return fixed(value, decimals) if np.isfinite(value) else NOTHING


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
            rows.append([point.label, MODEL_NAMES[model], *cells])
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
        rows.append([MODEL_NAMES[model], *endings, f"{float(residual):.1e}".replace("-", "−"), *work])
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
