"""The report's tables of results: contact area and mean gap of every model, and how far these are apart."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from contact_study.plots.style import Unit
from contact_study.report.align.cases import SweepPoint, case_points, select, series, sweep_points
from contact_study.report.align.deviations import COMPARED, DETACHED, NOT_CONVERGED, split_pair
from contact_study.report.align.scales import Scales, scales
from contact_study.report.facts.findings import Spread, pair_spread
from contact_study.report.facts.ranking import AREA, GAP, on_shared_states
from contact_study.report.models import entry_of
from contact_study.report.tables.table import NOTHING, Table
from contact_study.report.text.wording import PRESCRIBED, control_unit, fixed, number, percent, percent_of, with_error
from contact_study.study.load_steps import PathPoint


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
        names = [entry_of(name).short for name in parts]
        groups = [("", 2), ("contact area A/A₀", len(parts)), (f"mean gap ū ({gaps})", len(parts))]
        tables.append(Table(point.label, [*_point_header(control, unit, gaps), *names, *names], rows, groups))
    return tables


def _union_of_paths(parts: Mapping[str, xr.Dataset], control: str) -> list[PathPoint]:
    return list(dict.fromkeys(named for part in parts.values() for named in case_points(part, control) if named))


def _point_header(control: str, unit: Unit, gaps: str) -> list[str]:
    symbol = PRESCRIBED[control]
    return [f"{symbol} ({unit.name})", "p/E*" if control == "pressure" else f"{symbol} ({gaps})"]


def _point_cells(named: PathPoint, unit: Unit, scale: Scales, control: str) -> list[str]:
    value = float(named[0])
    shown = number(value / unit.size, 5) + (" ↩" if named[1] else "")
    return [shown, number(value / (scale.contact_modulus if control == "pressure" else scale.rms_height), 4)]


def _column(part: xr.Dataset, quantity: str, scale: float, path: list[PathPoint], control: str) -> list[str]:
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
            words = with_error(value, error, decimals) if np.isfinite(value) else NOTHING
            cells.append(words + ("" if found.fit[step] or np.isnan(value) else " *"))
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
            area = [_deviation(here.sel(pair=p), AREA, 1.0) for p in pairs]
            gap = [_deviation(here.sel(pair=p), GAP, scale.rms_height) for p in pairs]
            rows.append([*_point_cells(named, unit, scale, control)[:1], *area, *gap])
        gaps = scale.height_symbol
        groups = [("", 1), ("contact area, relative", len(pairs)), (f"mean gap ({gaps})", len(pairs))]
        tables.append(Table(point.label, [_point_header(control, unit, gaps)[0], *names, *names], rows, groups))
    return tables


def pair_name(pair: str) -> str:
    """A pair as the head of a column."""
    model, reference = split_pair(pair)
    return f"{entry_of(model).short} − {entry_of(reference).short}"


def summary_table(models: Mapping[str, xr.Dataset], deviations: xr.Dataset) -> Table:
    """Mean and largest magnitude of all deviations, a row for each pair, columns over the sweep.

    In a column all pairs are over the same states: those that every pair has which has some there.
    """
    points = sweep_points(models)
    symbol = scales(models, points[0]).height_symbol
    columns, counts = [], []
    for name in (AREA, GAP):
        for point in points:
            scale = 1.0 if name == AREA else scales(models, point).rms_height
            found = _shared_spreads(deviations, name, point, scale)
            columns.append([_mean_and_largest(found.get(pair), name) for pair in deviations["pair"].values])
            counts.append(max((spread.count for spread in found.values()), default=0))
    pairs = [pair_name(pair) for pair in deviations["pair"].values]
    rows = [list(row) for row in zip(pairs, *columns, strict=True)]
    labels = [point.label for point in points] * 2
    header = [
        f"{label}{', ' if label else ''}{count} state{'' if count == 1 else 's'}"
        for label, count in zip(labels, counts, strict=True)
    ]
    groups = [("", 1), ("contact area, relative", len(points)), (f"mean gap ({symbol})", len(points))]
    return Table("Mean (largest) magnitude of the deviations", ["", *header], rows, groups)


def _shared_spreads(deviations: xr.Dataset, name: str, point: SweepPoint, scale: float) -> dict[str, Spread]:
    """Deviations of every pair at one point of the sweep, over the states that all of them have."""
    here = {dim: [value] for dim, value in point.selection.items() if dim in deviations.dims}
    if any(value not in deviations[dim].values for dim, (value,) in here.items()):
        return {}
    shared = on_shared_states(deviations.sel(here), name)
    found = {pair: pair_spread(shared, pair, name, [point], {point.label: scale}) for pair in shared["pair"].values}
    return {pair: spread for pair, spread in found.items() if spread is not None}


def _mean_and_largest(found: Spread | None, name: str) -> str:
    if found is None:
        return NOTHING
    mean, largest = (percent_of(v) if name == AREA else fixed(v, 3) for v in (found.mean, abs(found.worst)))
    return f"{mean} ({largest})"


def _deviation(here: xr.Dataset, name: str, scale: float) -> str:
    if name not in here:
        return NOTHING
    mean = here[f"{name}_mean"] if f"{name}_mean" in here else here[name]
    value = float(mean) / scale
    if np.isfinite(value):
        error = float(here[f"{name}_standard_error"]) / scale if f"{name}_standard_error" in here else np.nan
        return percent(value, error) if name == AREA else with_error(value, error, 3, plus=True)
    states = np.atleast_1d(here["state"].values)
    if (states == DETACHED).all():
        return "detached"
    return "not converged" if (states == NOT_CONVERGED).any() and not (states == COMPARED).any() else NOTHING
