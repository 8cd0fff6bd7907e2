"""The report's tables: all numbers, agreement, changes along the sweep, loops."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from contact_study.plots.style import Unit
from contact_study.report.align.cases import (
    SweepPoint,
    case_points,
    select,
    series,
    sweep_points,
)
from contact_study.report.align.deviations import split_pair
from contact_study.report.align.scales import Scales, mean_gap_unit, mean_pressure_unit, scales
from contact_study.report.facts.differences import Difference
from contact_study.report.facts.loops import Loop
from contact_study.report.facts.ranking import AREA, GAP, Ranking
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.text.rendering import Both
from contact_study.report.text.wording import (
    PRESCRIBED,
    control_unit,
    coordinate_label,
    fixed,
    force,
    number,
    percent,
    percent_of,
    pressure,
    span,
    with_error,
)
from contact_study.study.load_steps import PathPoint

NOTHING = "–"
_GOOD, _FAIR = 0.05, 0.3  # deviations of the contact area up to which a cell is coloured as good, and as fair
_UNITS = {"relative_contact_area": "1", "mean_gap": "m", "mean_pressure": "Pa"}


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
    models, control = inputs.models, inputs.control
    lead = max(models.values(), key=lambda dataset: len(dataset.dims))
    points = sweep_points(models)
    symbol, unit = PRESCRIBED[control], control_unit(models, control)
    modulus = "p/E*" if control == "pressure" else f"{symbol}/{scales(models, points[0]).height_symbol}"
    columns = [Column(key.replace("_", " "), key) for key in points[0].selection]
    columns += [
        Column(
            Both(f"{symbol} ({unit.name})", modulus), f"applied_{control} ({'Pa' if control == 'pressure' else 'm'})"
        ),
        Column("branch", "branch"),
        Column("model", "model"),
    ]
    ensemble = inputs.samples > 1
    shown = ["relative_contact_area", "mean_gap", *([] if control == "pressure" else ["mean_pressure"])]
    heads = {name: _head(name, models, scales(models, points[0])) for name in shown}
    for name in shown:
        columns.append(Column(heads[name], f"{name} ({_UNITS[name]})"))
        columns += [Column("±", f"{name}_standard_error ({_UNITS[name]})")] if ensemble else []
    columns += [Column("samples", "samples")] if ensemble else []
    reference = "" if deviations is None else split_pair(str(deviations["pair"].values[0]))[1]
    if reference:
        short, gaps = entry_of(reference).short, mean_gap_unit(models).name
        heads |= {"gap": Both(f"ū − {short} ({gaps})", f"(ū − {short})/{scales(models, points[0]).height_symbol}")}
        columns += [
            Column(f"A against {short}", f"{AREA} ({reference})"),
            Column(heads["gap"], f"{GAP} ({reference}, m)"),
        ]
    columns.append(Column("state", "state"))
    table = Table(columns)
    for point in points:
        scale = scales(models, point)
        parts = {name: part for name, dataset in models.items() if (part := select(dataset, point)) is not None}
        found = {
            name: {quantity: series(part, quantity) for quantity in shown if quantity in part}
            for name, part in parts.items()
        }
        paths = {name: case_points(part, control) for name, part in parts.items()}
        for named in dict.fromkeys(one for path in paths.values() for one in path if one is not None):
            for name, part in parts.items():
                if named not in paths[name]:
                    continue
                step = paths[name].index(named)
                keys = [
                    Cell(coordinate_label(k, v, lead[k].attrs.get("units", "1") if k in lead.dims else "1"), _raw(v))
                    for k, v in point.selection.items()
                ]
                row = [*keys, *_point_cells(named, unit, scale, control), Cell(entry_of(name).label, name)]
                for quantity in shown:
                    own = found[name].get(quantity)
                    value, error = (np.nan, np.nan) if own is None else (own.values[step], own.standard_error[step])
                    row.append(_quantity(quantity, float(value), models, scale))
                    row += [_quantity(quantity, float(error), models, scale)] if ensemble else []
                area = found[name]["relative_contact_area"]
                row += [Cell(str(int(area.samples[step])), float(area.samples[step]))] if ensemble else []
                row += (
                    _deviation_cells(deviations, f"{name} - {reference}", point, named, control, scale, models)
                    if reference
                    else []
                )
                row.append(Cell(_state(part, step, bool(area.fit[step]))))
                table.rows.append(row)
    return table


def _raw(value: object) -> float | str:
    return float(value) if isinstance(value, int | float | np.number) else str(value)


def _point_cells(named: PathPoint, unit: Unit, scale: Scales, control: str) -> list[Cell]:
    value = float(named[0])
    size = scale.contact_modulus if control == "pressure" else scale.rms_height
    words = "unloading" if named[1] else "loading"
    visit = f", visit {named[2] + 1}" if named[2] else ""
    return [Cell(Both(number(value / unit.size, 5), number(value / size, 4)), value), Cell(words + visit)]


def _head(name: str, models: Mapping[str, xr.Dataset], scale: Scales) -> str | Both:
    if name == "relative_contact_area":
        return "A/A₀"
    if name == "mean_gap":
        return Both(f"ū ({mean_gap_unit(models).name})", f"ū/{scale.height_symbol}")
    return Both(f"p ({mean_pressure_unit(models).name})", "p/E*")


def _quantity(name: str, value: float, models: Mapping[str, xr.Dataset], scale: Scales) -> Cell:
    if not np.isfinite(value):
        return Cell(NOTHING, float("nan"))
    if name == "relative_contact_area":
        return Cell(fixed(value, 4), value)
    if name == "mean_gap":
        return Cell(Both(number(value / mean_gap_unit(models).size, 4), fixed(value / scale.rms_height, 3)), value)
    return Cell(
        Both(number(value / mean_pressure_unit(models).size, 4), number(value / scale.contact_modulus, 4)), value
    )


def _state(part: xr.Dataset, step: int, fit: bool) -> str:
    here = part.isel(step=step)
    if "detached" in here and bool((here["detached"] == 1).all()):
        return "detached"
    if fit:
        return "converged"
    return "not converged" if "converged" in here and bool((here["converged"] == 0).any()) else NOTHING


def _deviation_cells(
    deviations: xr.Dataset | None,
    pair: str,
    point: SweepPoint,
    named: PathPoint,
    control: str,
    scale: Scales,
    models: Mapping[str, xr.Dataset],
) -> list[Cell]:
    """Relative deviation of the area and that of the mean gap from the reference, means over paired samples."""
    empty = [Cell(NOTHING, float("nan"))] * 2
    if deviations is None or pair not in deviations["pair"].values:
        return empty
    part = select(deviations.sel(pair=pair), point)
    if part is None or named not in (path := case_points(part, control)):
        return empty
    here, cells = part.isel(step=path.index(named)), []
    for name in (AREA, GAP):
        if name not in here:
            cells.append(empty[0])
            continue
        mean = here[f"{name}_mean"] if f"{name}_mean" in here else here[name]
        value = float(mean)
        error = float(here[f"{name}_standard_error"]) if f"{name}_standard_error" in here else np.nan
        unit = mean_gap_unit(models).size
        if not np.isfinite(value):
            cells.append(empty[0])
        elif name == AREA:
            cells.append(Cell(percent(value, error), value))
        else:
            reduced = with_error(value / scale.rms_height, error / scale.rms_height, 3, plus=True)
            cells.append(Cell(Both(with_error(value / unit, error / unit, 3, plus=True), reduced), value))
    return cells


def agreement_table(inputs: Inputs, rankings: Sequence[Ranking], gaps: bool = False) -> Table:
    """Mean magnitude of the deviations from the reference, a model a row, a point of the sweep a column.

    Parameters
    ----------
    inputs : Inputs
        What is compared.
    rankings : sequence of Ranking
        Of one reference.
    gaps : bool
        Whether mean gaps are shown, not contact areas.
    """
    points = {point.label: point for point in sweep_points(inputs.models)}
    unit = mean_gap_unit(inputs.models)
    names = dict.fromkeys(
        name for name in inputs.models for ranking in rankings for one in ranking.distances if one.model == name
    )
    table = Table(
        [
            Column(""),
            *(Column(f"{ranking.at or 'all states'}{' ⚠' if ranking.trapped else ''}") for ranking in rankings),
        ]
    )
    for name in names:
        row = [Cell(entry_of(name).label)]
        for ranking in rankings:
            one = next((one for one in ranking.distances if one.model == name), None)
            if one is None or not np.isfinite(one.gap if gaps else one.area):
                row.append(Cell(NOTHING))
            elif gaps:
                height = scales(inputs.models, points[ranking.at]).rms_height
                sizes = one.gap * height / unit.size, one.gap_error * height / unit.size
                reduced = (
                    f"{with_error(one.gap, one.gap_error, 3)} {scales(inputs.models, points[ranking.at]).height_symbol}"
                )
                row.append(Cell(Both(f"{with_error(*sizes, 3)} {unit.name}", reduced), one.gap))
            else:
                grade = "good" if one.area <= _GOOD else "fair" if one.area <= _FAIR else "poor"
                row.append(Cell(percent_of(one.area, one.area_error), one.area, grade))
        table.rows.append(row)
    return table


def difference_table(inputs: Inputs, found: Sequence[Difference]) -> Table:
    """Changes along the sweep, a row for each model and neighbouring points."""
    points = {point.label: point for point in sweep_points(inputs.models)}
    unit = mean_gap_unit(inputs.models)
    gaps = Both(f"ū ({unit.name})", f"ū/{scales(inputs.models, points[next(iter(points))]).height_symbol}")
    rows: list[list[str | Both]] = []
    for one in found:
        height = scales(inputs.models, points[one.before]).rms_height
        words = (with_error(one.gap[0] / size, one.gap[1] / size, 3, plus=True) for size in (unit.size, height))
        rows.append(
            [
                *(one.before, one.after, entry_of(one.model).label, str(one.states), str(one.samples)),
                with_error(one.area[0], one.area[1], 4, plus=True),
                Both(*words) if np.isfinite(one.gap[0]) else NOTHING,
            ]
        )
    return plain_table(["from", "to", "model", "states", "samples", "A/A₀", gaps], rows)


def loop_table(inputs: Inputs, found: Sequence[Loop]) -> Table:
    """Pull-off, jump-in and energies, a row for each model and point of the sweep."""
    points = {point.label: point for point in sweep_points(inputs.models)}
    rows = []
    for one in found:
        modulus = scales(inputs.models, points[one.at]).contact_modulus
        words: list[str | Both] = [one.at, entry_of(one.model).label, pull_off_words(one, modulus)]
        words += [force(one.force) if one.reached else NOTHING, _both_pressures(one.jump_in, modulus)]
        words += [number(value, 3) if np.isfinite(value) else NOTHING for value in (one.dissipated, one.separation)]
        rows.append(words)
    header = [
        "",
        "model",
        "pull-off pressure",
        "pull-off force",
        "jump-in",
        "dissipated (J/m²)",
        "work of separation (J/m²)",
    ]
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
    between = np.isfinite(below) and abs(below - value) > 1e-3 * abs(value)
    physical, reduced = pressure(value, 4), f"{number(value / modulus, 3)} E*"
    if not between:
        return Both(physical, reduced)
    return Both(span(pressure(below, 4), physical), span(f"{number(below / modulus, 3)} E*", reduced))
