"""The report's tables: all numbers, agreement, changes along the sweep, loops; regime, material, effort."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from contact_study.plots.style import Unit, length_unit, pressure_unit
from contact_study.report.align import cases
from contact_study.report.align.cases import Models, Scales, SweepPoint, scales, sweep_points
from contact_study.report.align.deviations import split_pair
from contact_study.report.facts.overview import Difference, Loop, effort
from contact_study.report.facts.ranking import AREA, GAP, Ranking
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.text import wording
from contact_study.report.text.rendering import Both
from contact_study.report.text.wording import PRESCRIBED, fixed, number, percent_of, pressure, with_error
from contact_study.study.case import PathPoint

NOTHING = "–"
_GOOD, _FAIR = 0.05, 0.3  # deviations of the contact area up to which a cell is coloured as good, and as fair
_UNITS = {"relative_contact_area": "1", "mean_gap": "m", "mean_pressure": "Pa"}
_REGIME = (
    ("tabor_parameter", "Tabor parameter μ", 2),
    ("process_zone", "process zone", 1),
    ("pixel_over_process_zone", "grid spacing / process zone", 2),
    ("adhesion_over_elastic_energy", "θ = Δγ S / U_full", 2),
    ("full_contact_stress_over_peak", "full-contact stress / σ_max", 2),
    ("rms_slope", "rms gradient", 3),
)
_WORK = {
    "fft_pairs": "FFT pairs",
    "force_evaluations": "force evaluations",
    "iterations": "iterations",
    "wall_time": "time of all steps (s)",
}


@dataclass(frozen=True)
class Cell:
    """A cell of a table: text, the number that it is sorted by and exported with, and how good that is."""

    text: str | Both
    value: float | str = ""
    grade: str = ""

    @property
    def export(self) -> str:
        """The cell in a file: a number with all its digits, or text."""
        return repr(self.value) if isinstance(self.value, float) else str(self.value or self.text)


_EMPTY = Cell(NOTHING, float("nan"))


@dataclass(frozen=True)
class Column:
    """Head of a column on the page, and in a file."""

    head: str | Both
    export: str = ""

    @property
    def words(self) -> bool:
        """Whether it holds words, not numbers."""
        return self.head in ("model", "branch", "state", "from", "to")


@dataclass(frozen=True)
class Table:
    """Columns and rows."""

    columns: list[Column]
    rows: list[list[Cell]] = field(default_factory=list)


def plain_table(header: Sequence[str | Both], rows: Sequence[Sequence[str | Both]]) -> Table:
    """Make a table of words, which are neither sorted nor exported as numbers."""
    return Table([Column(words) for words in header], [[Cell(text) for text in row] for row in rows])


def all_numbers(inputs: Inputs, deviations: xr.Dataset | None) -> Table:
    """Every state of every model: means over samples with their errors, and deviations from the first reference."""
    models, control, ensemble = inputs.models, inputs.control, inputs.samples > 1
    pressures, gaps = (cases.mean_unit(models, name) for name in ("mean_pressure", "mean_gap"))
    points = sweep_points(models)
    symbol, unit, height = PRESCRIBED[control], wording.control_unit(models, control), scales(models, points[0])
    modulus = "p/E*" if control == "pressure" else f"{symbol}/{height.height_symbol}"
    applied = Both(f"{symbol} ({unit.name})", modulus), f"applied_{control} ({'Pa' if control == 'pressure' else 'm'})"
    columns = [Column(key.replace("_", " "), key) for key in points[0].selection]
    columns += [Column(*applied), Column("branch", "branch"), Column("model", "model")]
    heads: dict[str, str | Both] = {
        "relative_contact_area": "A/A₀",
        "mean_gap": Both(f"ū ({gaps.name})", f"ū/{height.height_symbol}"),
        "mean_pressure": Both(f"p ({pressures.name})", "p/E*"),
    }
    shown = [name for name in heads if (name, control) != ("mean_pressure", "pressure")]
    for name in shown:
        columns.append(Column(heads[name], f"{name} ({_UNITS[name]})"))
        columns += [Column("±", f"{name}_standard_error ({_UNITS[name]})")] if ensemble else []
    columns += [Column("samples", "samples")] if ensemble else []
    reference = "" if deviations is None else split_pair(str(deviations["pair"].values[0]))[1]
    if reference:
        short = entry_of(reference).short
        gap = Both(f"ū − {short} ({gaps.name})", f"(ū − {short})/{height.height_symbol}")
        columns += [Column(f"A against {short}", f"{AREA} ({reference})"), Column(gap, f"{GAP} ({reference}, m)")]
    table = Table([*columns, Column("state", "state")])
    lead = max(models.values(), key=lambda dataset: len(dataset.dims))
    units = {key: lead[key].attrs.get("units", "1") if key in lead.dims else "1" for key in points[0].selection}
    for point in points:
        scale = scales(models, point)
        keys = [Cell(wording.coordinate_label(k, v, units[k]), _raw(v)) for k, v in point.selection.items()]
        parts = {name: part for name, dataset in models.items() if (part := cases.select(dataset, point)) is not None}
        found = {name: {own: cases.series(part, own) for own in shown if own in part} for name, part in parts.items()}
        paths = {name: cases.case_points(part) for name, part in parts.items()}
        compared = {} if deviations is None else _deviations_of(deviations, parts, reference, point)
        for named in dict.fromkeys(one for path in paths.values() for one in path if one is not None):
            for name in (name for name in parts if named in paths[name]):
                step = paths[name].index(named)
                row = [*keys, *_point_cells(named, unit, scale, control), Cell(entry_of(name).label, name)]
                for quantity in shown:
                    own = found[name].get(quantity)
                    both = (np.nan, np.nan) if own is None else (own.values[step], own.standard_error[step])
                    row += [_quantity(quantity, float(value), pressures, gaps, scale) for value in both[: 1 + ensemble]]
                area = found[name]["relative_contact_area"]
                row += [Cell(str(int(area.samples[step])), float(area.samples[step]))] if ensemble else []
                if deviations is not None:
                    pair, path = compared.get(name, (deviations, []))
                    here = pair.isel(step=path.index(named)) if named in path else None
                    row += [_EMPTY, _EMPTY] if here is None else _deviation_cells(here, scale, gaps)
                row.append(Cell(_state(parts[name].isel(step=step), bool(area.fit[step]))))
                table.rows.append(row)
    return table


def _deviations_of(
    deviations: xr.Dataset, models: Iterable[str], reference: str, point: SweepPoint
) -> dict[str, tuple[xr.Dataset, list[PathPoint | None]]]:
    """Deviations of models from the reference at one point of the sweep, with the names of the path's points."""
    found = {}
    for name in models:
        pair = deviations.isel(pair=deviations["pair"].values == f"{name} - {reference}")
        part = cases.select(pair.squeeze("pair"), point) if pair.sizes["pair"] else None
        if part is not None:
            found[name] = part, cases.case_points(part)
    return found


def _raw(value: object) -> float | str:
    return float(value) if isinstance(value, int | float | np.number) else str(value)


def _point_cells(named: PathPoint, unit: Unit, scale: Scales, control: str) -> list[Cell]:
    value = float(named[0])
    size = scale.contact_modulus if control == "pressure" else scale.rms_height
    visit = f", visit {named[2] + 1}" if named[2] else ""
    words = ("unloading" if named[1] else "loading") + visit
    return [Cell(Both(number(value / unit.size, 5), number(value / size, 4)), value), Cell(words)]


def _quantity(name: str, value: float, pressures: Unit, gaps: Unit, scale: Scales) -> Cell:
    if not np.isfinite(value):
        return _EMPTY
    if name == "relative_contact_area":
        return Cell(fixed(value, 4), value)
    if name == "mean_gap":
        return Cell(Both(number(value / gaps.size, 4), fixed(value / scale.rms_height, 3)), value)
    return Cell(Both(*(number(value / size, 4) for size in (pressures.size, scale.contact_modulus))), value)


def _state(here: xr.Dataset, fit: bool) -> str:
    if bool((here.get("detached", np.False_) == 1).all()):
        return "detached"
    if fit:
        return "converged"
    return "not converged" if bool((here.get("converged", np.True_) == 0).any()) else NOTHING


def _deviation_cells(here: xr.Dataset, scale: Scales, unit: Unit) -> list[Cell]:
    """Relative deviation of the area and that of the mean gap from the reference, means over paired samples."""
    cells = []
    for name in (AREA, GAP):
        value = float(here[f"{name}_mean" if f"{name}_mean" in here else name]) if name in here else np.nan
        error = float(here.get(f"{name}_standard_error", np.nan))
        words = percent_of(value, error, plus=True) if name == AREA else _in_both(value, error, unit, scale)
        cells.append(Cell(words, value) if np.isfinite(value) else _EMPTY)
    return cells


def _in_both(value: float, error: float, unit: Unit, scale: Scales) -> Both:
    """A change of gap (m) with its error."""
    return Both(*(with_error(value / size, error / size, 3, plus=True) for size in (unit.size, scale.rms_height)))


def agreement_table(inputs: Inputs, rankings: Sequence[Ranking], gaps: bool = False) -> Table:
    """Mean magnitude of the deviations of contact areas, or of mean gaps, from the one reference of the rankings.

    A model is a row, a point of the sweep a column.
    """
    unit = cases.mean_unit(inputs.models, "mean_gap")
    ranked = [{one.model: one for one in ranking.distances} for ranking in rankings]
    heads = [f"{ranking.at.label or 'all states'}{' ⚠' if ranking.trapped else ''}" for ranking in rankings]
    table = Table([Column(head) for head in ("", *heads)])
    for name in (name for name in inputs.models if any(name in own for own in ranked)):
        row = [Cell(entry_of(name).label)]
        for ranking, own in zip(rankings, ranked, strict=True):
            one, scale = own.get(name), scales(inputs.models, ranking.at)
            if one is None or not np.isfinite(one.gap if gaps else one.area):
                row.append(Cell(NOTHING))
            elif gaps:
                sizes = one.gap * scale.rms_height / unit.size, one.gap_error * scale.rms_height / unit.size
                reduced = f"{with_error(one.gap, one.gap_error, 3)} {scale.height_symbol}"
                row.append(Cell(Both(f"{with_error(*sizes, 3)} {unit.name}", reduced), one.gap))
            else:
                grade = "good" if one.area <= _GOOD else "fair" if one.area <= _FAIR else "poor"
                row.append(Cell(percent_of(one.area, one.area_error), one.area, grade))
        table.rows.append(row)
    return table


def difference_table(inputs: Inputs, found: Sequence[Difference]) -> Table:
    """Changes along the sweep, a row for each model and neighbouring points."""
    unit, first = cases.mean_unit(inputs.models, "mean_gap"), scales(inputs.models, sweep_points(inputs.models)[0])
    rows: list[list[str | Both]] = []
    for one in found:
        words = _in_both(*one.gap, unit, scales(inputs.models, one.before)) if np.isfinite(one.gap[0]) else NOTHING
        counts = one.before.label, one.after.label, entry_of(one.model).label, str(one.states), str(one.samples)
        rows.append([*counts, with_error(*one.area, 4, plus=True), words])
    gaps = Both(f"ū ({unit.name})", f"ū/{first.height_symbol}")
    return plain_table(["from", "to", "model", "states", "samples", "A/A₀", gaps], rows)


def loop_table(inputs: Inputs, found: Sequence[Loop]) -> Table:
    """Pull-off, jump-in and energies, a row for each model and point of the sweep."""
    rows = []
    for one in found:
        modulus = scales(inputs.models, one.at).contact_modulus
        words: list[str | Both] = [one.at.label, entry_of(one.model).label, pull_off_words(one, modulus)]
        words += [wording.force(one.force) if one.reached else NOTHING, _both_pressures(one.jump_in, modulus)]
        words += [_or_nothing(number, value, 3) for value in (one.dissipated, one.separation)]
        rows.append(words)
    energies = "dissipated (J/m²)", "work of separation (J/m²)"
    header = ["", "model", "pull-off pressure", "pull-off force", "jump-in", *energies]
    used = [n for n, _ in enumerate(header) if n < 3 or any(row[n] != NOTHING for row in rows)]
    return plain_table([header[n] for n in used], [[row[n] for n in used] for row in rows])


def pull_off_words(one: Loop, modulus: float) -> str | Both:
    """The pull-off pressure, the two that it lies between, or that it was not reached."""
    if not one.reached:
        ends = pressure(one.lowest, 4), f"{number(one.lowest / modulus, 4)} E*"
        return Both(*(f"not reached down to {end}" for end in ends))
    return _both_pressures(one.pull_off, modulus, one.below)


def _both_pressures(value: float, modulus: float, below: float = np.nan) -> str | Both:
    if not np.isfinite(value):
        return NOTHING
    low = below if np.isfinite(below) and abs(below - value) > 1e-3 * abs(value) else value
    ends = zip(*((pressure(end, 4), f"{number(end / modulus, 3)} E*") for end in (low, value)), strict=True)
    return Both(*(wording.span(*own) for own in ends))


def regime_table(models: Models, regime: xr.Dataset) -> Table:
    """Regime numbers, a row for each point of the sweep, without columns that have no number."""
    zone = length_unit(float(regime["process_zone"].fillna(0).max()))
    columns = [column for column in _REGIME if (regime[column[0]].fillna(0) != 0).any()]
    sizes = {"process_zone": zone.size}
    rows = []
    for at, _, part in cases.parts_of({"": regime}, sweep_points(models)):
        cells = (_or_nothing(fixed, float(part[name]) / sizes.get(name, 1.0), digits) for name, _, digits in columns)
        rows.append([at.label, *cells])
    header = [f"{words} ({zone.name})" if name == "process_zone" else words for name, words, _ in columns]
    return plain_table(["", *header], rows)


def constants_table(models: Models) -> Table:
    """Inputs of continuum and theories beside what the atomistic model measured on itself."""
    moduli = (cases.first_constant(models, point, "contact_modulus") for point in sweep_points(models))
    stress = pressure_unit(max(moduli))
    distance, height = (
        length_unit(max((float(own[name].max()) for own in models.values() if name in own), default=0.0))
        for name in ("equilibrium_distance", "rms_height")
    )
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
    for point, model, part in cases.parts_of(models):
        if any(name in part for name in used):
            cells = [_or_nothing(number, cases.constant(part, name) / size, 5) for name, (_, size) in used.items()]
            rows.append([point.label, entry_of(model).label, *cells])
    return plain_table(["", "model", *(words for words, _ in used.values())], rows)


def effort_table(models: Models) -> Table:
    """Work done by each model and how its steps ended."""
    used = {name: words for name, words in _WORK.items() if any(name in dataset for dataset in models.values())}
    rows = []
    for model, dataset in models.items():
        work = [
            f"{float(own.where(own >= 0).sum()):.0f}" if own is not None else NOTHING for own in map(dataset.get, used)
        ]
        residual = dataset.get("residual", xr.DataArray(np.nan)).where(dataset.get("detached", 0) != 1)
        endings = map(str, effort(dataset))
        rows.append([entry_of(model).label, *endings, f"{float(residual.max()):.1e}".replace("-", "−"), *work])
    return plain_table(["model", "steps", "not converged", "detached", "largest residual", *used.values()], rows)


def _or_nothing(show: Callable[[float, int], str], value: float, digits: int) -> str:
    return show(value, digits) if np.isfinite(value) else NOTHING
