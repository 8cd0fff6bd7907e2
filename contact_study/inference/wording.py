"""Results of an inference in words: the preferred model, and parameters that the curves do not determine."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from contact_study.inference.parameters import PHYSICAL
from contact_study.inputs.units import length

_SOFT, _HARD = 3.0, 0.1  # Tabor parameters above which JKR's theory holds, and below which DMT's
_CLEAR, _POOR = 6.0, 1.5  # difference of the BIC that is strong evidence; reduced misfit of a poor model
_OPEN = {
    1: "is not identifiable from these curves: its profile closes on neither side",
    2: "is bounded from above only",
    3: "is bounded from below only",
}


def notes_of(dataset: xr.Dataset) -> Iterator[str]:
    """Sentences about a dataset of :func:`contact_study.infer`."""
    names = [str(name) for name in dataset["model"].values]
    order = np.argsort(dataset["bic"].values)
    if len(names) > 1:
        best, next_one = (names[at] for at in order[:2])
        rise = float(np.diff(dataset["bic"].values[order[:2]])[0])
        words = "strongly" if rise > _CLEAR else "weakly; the curves hardly distinguish them"
        yield f"the BIC prefers {best} to {next_one} by {rise:.1f}: {words}"
    for at in order:
        yield from _of_model(dataset.isel(model=at), names[at])


def _of_model(one: xr.Dataset, name: str) -> Iterator[str]:
    for parameter in PHYSICAL:
        status = int(one.get(f"{parameter}_status", 0))
        if status in _OPEN:
            yield f"{name}: {parameter} {_OPEN[status]}"
    span = float(one["elastic_length"])
    if name == "jkr":
        yield f"jkr: holds if adhesion acts within {length(span / _SOFT)} (Tabor parameter above {_SOFT:g})"
    if name == "dmt":
        yield f"dmt: holds if adhesion reaches beyond {length(span / _HARD)} (Tabor parameter below {_HARD:g})"
    tabor = float(one["tabor_parameter"])
    if np.isfinite(tabor):
        regime = "JKR's" if tabor > _SOFT else "DMT's" if tabor < _HARD else "neither JKR's nor DMT's"
        yield f"{name}: Tabor parameter {tabor:.2g}, the range of {regime} theory"
    if float(one["reduced_misfit"]) > _POOR**2:
        yield (
            f"{name}: residuals are {np.sqrt(float(one['reduced_misfit'])):.2g} times the errors; intervals are as "
            "wide as residuals demand, if these are random"
        )
