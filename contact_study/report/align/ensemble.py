"""Means and standard errors of each model over seeds, or over what else is averaged."""

from collections.abc import Hashable, Iterable, Mapping

import numpy as np
import xarray as xr

from contact_study.report.read.load_steps import averaged
from contact_study.results.schema import VARIABLES
from contact_study.results.state import usable

# Quantities of the way a step was found, not of its result.
_OF_THE_WORK = ("residual", "complementarity_residual", "wall_time", "fft_pairs", "iterations", "force_evaluations")


def standard_error(values: xr.DataArray, over: str | Iterable[Hashable]) -> xr.DataArray:
    """Standard error of the mean over some dimensions, NaN values left out: standard deviation (of n − 1) over √n.

    One sample has no scatter: NaN, not zero.
    """
    count = values.notnull().sum(over)
    return values.std(over, ddof=1).where(count > 1) / np.sqrt(count)


def ensemble_statistics(models: Mapping[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """Statistics of every model with several samples, by its name.

    Returns
    -------
    dict of xarray.Dataset
        For each quantity ``x`` on the path, distributions too: ``x``, its mean over the samples that converged in
        contact, and ``x_standard_error``, their standard deviation (of n − 1) over √n, NaN with fewer than two.
        ``samples`` counts them, ``standard_deviation`` is not stored: it is the error times √samples.
    """
    return {
        name: _statistics(dataset, averaged(dataset))
        for name, dataset in models.items()
        if dataset.sizes.get(averaged(dataset), 1) > 1
    }


def _statistics(dataset: xr.Dataset, over: str) -> xr.Dataset:
    fit = usable(dataset)
    fit = fit if over in fit.dims else fit.expand_dims({over: dataset[over]})
    samples = fit.sum(over).astype(np.int32)
    words = over.replace("_", " ")
    found = {"samples": samples.assign_attrs(units="1", long_name=f"values of {words} that converged in contact")}
    for name in [str(name) for name, variable in dataset.data_vars.items() if _has_a_mean(str(name), variable, over)]:
        values, known = dataset[name].where(fit), VARIABLES[name]
        attrs = {"units": known.units, "ancillary_variables": f"{name}_standard_error samples"}
        found[name] = values.mean(over).assign_attrs(attrs, long_name=f"{known.long_name}, mean over {words}")
        found[f"{name}_standard_error"] = standard_error(values, over).assign_attrs(
            units=known.units, long_name=f"{known.long_name}, standard error of the mean over {words}"
        )
    return xr.Dataset(found, attrs={"averaged_over": over})


def _has_a_mean(name: str, variable: xr.DataArray, over: str) -> bool:
    known = VARIABLES.get(name)
    return (
        known is not None
        and {over, "step"} <= {*variable.dims}
        and known.kind in ("float", "count")
        and name not in _OF_THE_WORK
    )
