"""How far the models are apart at each point of the sweep and of the loading path."""

from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr

from contact_study.report.align.ensemble import standard_error
from contact_study.report.models import entry_of, kind_of
from contact_study.report.read.load_steps import averaged, on_common_path, swept_dims
from contact_study.results.schema import COORDINATES, VARIABLES
from contact_study.results.state import usable

QUANTITIES = ("relative_contact_area", "mean_gap", "elastic_energy")

COMPARED, MISSING, NOT_CONVERGED, DETACHED = range(4)


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

    Returns
    -------
    xarray.Dataset
        Dimensions (pair, …sweep…, step). For each quantity ``x`` that some pair has, ``x_deviation``, the model's value
        minus the reference's, and ``x_relative_deviation``, the ratio to the reference's value; NaN unless ``state``
        marks the point as compared. Where a swept key is averaged over, the seed unless another is named,
        also ``…_mean`` and ``…_standard_error`` of the paired differences.
    """
    aligned = on_common_path(models, control)
    pairs = pairs_of(models)
    tables = [_compare_pair(aligned[model], aligned[reference]) for model, reference in pairs]
    names = xr.Variable(
        "pair",
        [f"{model} - {reference}" for model, reference in pairs],
        {"units": "1", "long_name": "models compared: model minus reference"},
    )
    table = xr.concat(tables, dim=names, data_vars="all", join="exact", coords="minimal", compat="equals")
    table = table.rename_vars(prescribed=f"applied_{control}").assign_coords(
        step=("step", np.arange(table.sizes["step"], dtype=np.int32))
    )
    for dim in swept_dims(table.drop_dims("pair")):
        table[dim].attrs = next(dataset[dim].attrs for dataset in models.values() if dim in dataset.dims)
    average = averaged(next(iter(models.values())))
    if table.sizes.get(average, 1) > 1:
        table = _with_statistics(table, average)
    return _described(table, control, average)


def _compare_pair(model: xr.Dataset, reference: xr.Dataset) -> xr.Dataset:
    fit = usable(model) & usable(reference)
    present = model["relative_contact_area"].notnull() & reference["relative_contact_area"].notnull()
    unconverged = _flagged(model, "converged", 0) | _flagged(reference, "converged", 0)
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


def _flagged(dataset: xr.Dataset, name: str, value: int) -> xr.DataArray | bool:
    return dataset[name] == value if name in dataset else False


def _with_statistics(table: xr.Dataset, average: str) -> xr.Dataset:
    """Add means and standard errors over samples; the differences are paired, each of two models on one surface."""
    added = {}
    for name in [str(name) for name in table.data_vars if str(name).endswith("deviation")]:
        added[f"{name}_mean"] = table[name].mean(average)
        added[f"{name}_standard_error"] = standard_error(table[name], average)
    return table.assign(added)


def _described(table: xr.Dataset, control: str, average: str) -> xr.Dataset:
    """Drop what no pair has and give every variable its units and meaning."""
    empty = [name for name in table.data_vars if name != "state" and not table[name].notnull().any()]
    table = table.drop_vars(empty)
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
    if name.endswith("_mean"):
        words += f", mean of the paired differences over {average}"
    if name.endswith("_standard_error"):
        words += f", standard error of the paired differences over {average}"
    return {"units": "1" if relative else known.units, "long_name": words}
