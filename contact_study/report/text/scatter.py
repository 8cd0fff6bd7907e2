"""What the scatter between surfaces amounts to, as sentences made from its numbers alone."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from contact_study.report.compute.cases import sweep_points
from contact_study.report.models import TARGET, entry_of, spectrum_of
from contact_study.report.read.load_steps import on_common_path, usable
from contact_study.report.text.findings import control_of, over_states
from contact_study.report.wording import percent_of

_AREA = "relative_contact_area"


def scatter_findings(models: Mapping[str, xr.Dataset], statistics: Mapping[str, xr.Dataset]) -> list[str]:
    """How much contact areas scatter between surfaces, and how far the theories and the one surface are from the mean.

    Parameters
    ----------
    models : mapping
        Datasets that are compared.
    statistics : mapping
        What :func:`ensemble_statistics` makes of the realisations, by model.
    """
    return [sentence for name, found in statistics.items() for sentence in _findings(models, name, found)]


def _findings(models: Mapping[str, xr.Dataset], name: str, found: xr.Dataset) -> list[str]:
    mean, error = found[_AREA], found[f"{_AREA}_standard_error"]
    relative = error * np.sqrt(found["samples"]) / mean
    points = sweep_points({name: found})
    ones = {point.label: 1.0 for point in points}
    try:
        spread = over_states(relative.to_dataset(name="spread"), "spread", points, ones)
    except ValueError:
        return []  # no state was found on two surfaces
    most = int(found["samples"].max())
    sentences = [
        f"Over {most} surfaces of one spectrum the contact area of {entry_of(name).words} scatters by "
        f"{percent_of(spread.median)} in the median of {spread.count} states and by {percent_of(spread.high)} at most "
        f"({spread.high_at}), as standard deviation over mean; the mean is known to "
        f"{percent_of(float((error / mean).median()))} in the median state."
    ]
    # The mean over surfaces is that of their target spectrum.
    theories = {model: dataset for model, dataset in models.items() if not entry_of(model).simulation}
    theories = {model: dataset for model, dataset in theories.items() if spectrum_of(model) == TARGET} or theories
    medians = {model: _median_off(found, dataset) for model, dataset in theories.items()}
    known = sorted((model for model in medians if np.isfinite(medians[model])), key=medians.__getitem__)
    if known:
        words = ", ".join(f"{entry_of(model).words} by {percent_of(medians[model])}" for model in known)
        sentences.append(f"Of that mean, the theories are off, in the median state: {words}.")
    if name in models and (one := _within(found, models[name])):
        sentences.append(f"The one surface compared lies within one standard deviation of it in {one} states.")
    return sentences


def _median_off(found: xr.Dataset, dataset: xr.Dataset) -> float:
    mean, other = _aligned(found, dataset)
    return float(np.abs(other / mean[_AREA] - 1).median())


def _within(found: xr.Dataset, dataset: xr.Dataset) -> str:
    """In how many of how many states an area is within a standard deviation; empty for several surfaces."""
    mean, other = _aligned(found, dataset)
    if other.dims != mean[_AREA].dims:
        return ""
    deviation = mean[f"{_AREA}_standard_error"] * np.sqrt(mean["samples"])
    both = other.notnull() & deviation.notnull()
    near = both & (np.abs(other - mean[_AREA]) <= deviation)
    return f"{int(near.sum())} of {int(both.sum())}" if both.any() else ""


def _aligned(found: xr.Dataset, dataset: xr.Dataset) -> tuple[xr.Dataset, xr.DataArray]:
    """Means, and the contact area of a model where it converged in contact, at the same points."""
    pair = on_common_path({"mean": found, "model": dataset}, control_of(found))
    return pair["mean"], pair["model"][_AREA].where(usable(pair["model"]))
