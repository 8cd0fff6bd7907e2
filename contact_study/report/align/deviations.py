"""How far the models are apart at each point of the sweep and of the path; means of each model over its samples."""

from collections.abc import Hashable, Iterable, Mapping

import numpy as np
import xarray as xr

from contact_study.report.models import entry_of, kind_of
from contact_study.report.read.load_steps import averaged, on_common_path, swept_dims
from contact_study.results.schema import COORDINATES, VARIABLES
from contact_study.results.state import usable

QUANTITIES = ("relative_contact_area", "mean_gap", "elastic_energy")

COMPARED, MISSING, NOT_CONVERGED, DETACHED = range(4)

# Quantities of the way a step was found, not of its result.
_OF_THE_WORK = ("residual", "complementarity_residual", "wall_time", "fft_pairs", "iterations", "force_evaluations")


def pairs_of(models: Iterable[str]) -> list[tuple[str, str]]:
    """Model and reference of every comparison: each model with those of more trust, and datasets of one model."""
    names = list(models)
    return [
        (model, reference)
        for number, reference in enumerate(names)
        for model in names[number + 1 :]
        if entry_of(reference).trust > entry_of(model).trust
        or (kind_of(reference) == kind_of(model) and entry_of(reference).file != entry_of(model).file)
    ]


def split_pair(pair: str) -> tuple[str, str]:
    """Model and reference of an entry of the coordinate ``pair``."""
    model, _, reference = pair.partition(" - ")
    return model, reference


def compute_deviations(models: Mapping[str, xr.Dataset], control: str) -> xr.Dataset:
    """Deviations of every pair of models, aligned by prescribed value, branch and occurrence.

    Dimensions (pair, …sweep…, step). For each quantity ``x`` that some pair has, ``x_deviation``, the model's value
    minus the reference's, and ``x_relative_deviation``, the ratio to the reference's value; NaN unless ``state`` marks
    the point as compared. Where a swept key is averaged over, also ``…_mean`` and ``…_standard_error`` of the paired
    differences.
    """
    aligned = on_common_path(models, control)
    pairs = pairs_of(models)
    tables = [_compare_pair(aligned[model], aligned[reference]) for model, reference in pairs]
    attrs = {"units": "1", "long_name": "models compared: model minus reference"}
    names = xr.Variable("pair", [" - ".join(pair) for pair in pairs], attrs)
    table = xr.concat(tables, dim=names, data_vars="all", join="exact", coords="minimal", compat="equals")
    steps = np.arange(table.sizes["step"], dtype=np.int32)
    table = table.rename_vars(prescribed=f"applied_{control}").assign_coords(step=("step", steps))
    for dim in swept_dims(table.drop_dims("pair")):
        table[dim].attrs = next(dataset[dim].attrs for dataset in models.values() if dim in dataset.dims)
    average = averaged(next(iter(models.values())))
    if table.sizes.get(average, 1) > 1:  # the differences are paired, each of two models on one surface
        for name, own in {**table.data_vars}.items():
            if name != "state":
                table[f"{name}_mean"], table[f"{name}_standard_error"] = own.mean(average), standard_error(own, average)
    return _described(table, control, average)


def _compare_pair(model: xr.Dataset, reference: xr.Dataset) -> xr.Dataset:
    fit = usable(model) & usable(reference)
    present = model["relative_contact_area"].notnull() & reference["relative_contact_area"].notnull()
    unconverged = (model.get("converged", 1) == 0) | (reference.get("converged", 1) == 0)
    state = xr.where(fit, COMPARED, xr.where(~present, MISSING, xr.where(unconverged, NOT_CONVERGED, DETACHED)))
    table = {"state": state.where(model["prescribed"].notnull(), VARIABLES["converged"].empty).astype(np.int8)}
    for name in QUANTITIES:
        if name in model and name in reference:
            difference = (model[name] - reference[name]).where(fit)
            table[f"{name}_deviation"] = difference
            table[f"{name}_relative_deviation"] = difference / reference[name].where(reference[name] != 0)
        else:
            table[f"{name}_deviation"] = table[f"{name}_relative_deviation"] = xr.full_like(state, np.nan, float)
    return xr.Dataset(table)


def _described(table: xr.Dataset, control: str, average: str) -> xr.Dataset:
    """Drop what no pair has and give every variable its units and meaning."""
    table = table.drop_vars([name for name, own in table.data_vars.items() if not own.notnull().any()])
    for name in table.data_vars:
        table[name].attrs = _attributes(str(name), average)
    table["state"].encoding = VARIABLES["converged"].encoding
    table["branch"].encoding = COORDINATES["branch"].encoding
    for name in (f"applied_{control}", "branch", "step"):
        known = COORDINATES[name]
        table[name].attrs = {"units": known.units, "long_name": known.long_name, **known.attrs}
    return table


def _attributes(name: str, average: str) -> dict[str, object]:
    if name == "state":
        return {
            "units": "1",
            "long_name": "whether the point could be compared",
            "flag_values": np.arange(-1, 4, dtype=np.int8),
            "flag_meanings": "absent compared missing_in_one not_converged detached",
        }
    quantity = next(quantity for quantity in QUANTITIES if name.startswith(quantity))
    known, relative = VARIABLES[quantity], "_relative_deviation" in name
    words = f"{known.long_name}: {'(model - reference) / reference' if relative else 'model minus reference'}"
    for statistic in ("mean", "standard error"):
        if name.endswith(statistic.replace(" ", "_")):
            words += f", {statistic} of the paired differences over {average}"
    return {"units": "1" if relative else known.units, "long_name": words}


def standard_error(values: xr.DataArray, over: str | Iterable[Hashable]) -> xr.DataArray:
    """Standard error of the mean over some dimensions, NaN values left out: standard deviation (of n − 1) over √n.

    One sample has no scatter: NaN, not zero.
    """
    count = values.notnull().sum(over)
    return values.std(over, ddof=1).where(count > 1) / np.sqrt(count)


def ensemble_statistics(models: Mapping[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """For each quantity ``x`` on the path of every model with several samples, ``x`` and ``x_standard_error``.

    They are its mean over the samples that converged in contact, and their standard deviation (of n − 1) over √n, NaN
    with fewer than two; ``samples`` counts them.
    """
    several = {name: own for name, own in models.items() if own.sizes.get(averaged(own), 1) > 1}
    return {name: _statistics(dataset, averaged(dataset)) for name, dataset in several.items()}


def _statistics(dataset: xr.Dataset, over: str) -> xr.Dataset:
    fit, words = usable(dataset), over.replace("_", " ")
    fit = fit if over in fit.dims else fit.expand_dims({over: dataset[over]})
    attrs = {"units": "1", "long_name": f"values of {words} that converged in contact"}
    found = {"samples": fit.sum(over).astype(np.int32).assign_attrs(attrs)}
    for name, variable in dataset.data_vars.items():
        known = VARIABLES.get(str(name))
        if known is None or known.kind not in ("float", "count") or name in _OF_THE_WORK:
            continue
        if {over, "step"} <= {*variable.dims}:
            values = variable.where(fit)
            attrs = {"units": known.units, "ancillary_variables": f"{name}_standard_error samples"}
            found[str(name)] = values.mean(over).assign_attrs(attrs, long_name=f"{known.long_name}, mean over {words}")
            attrs = {"units": known.units, "long_name": f"{known.long_name}, standard error of the mean over {words}"}
            found[f"{name}_standard_error"] = standard_error(values, over).assign_attrs(attrs)
    return xr.Dataset(found, attrs={"averaged_over": over})
