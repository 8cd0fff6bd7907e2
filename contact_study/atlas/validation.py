"""Checks of a dataset of contacts: names, units, ranges, convergence, order of energies and areas, checksum.

They need the names of this software's datasets and no particular dimensions, so that files of others can be checked.
"""

import numpy as np
import xarray as xr

from contact_study.atlas.joining import checksum
from contact_study.physics.process_zone import POINTS_PER_PROCESS_ZONE
from contact_study.results.schema import variable_of

REQUIRED = (
    "mean_pressure",
    "mean_gap",
    "relative_contact_area",
    "converged",
    "contact_modulus",
    "work_of_adhesion",
)
_PREFIXES = ("theory_", "refined_")
_SHARE, _POSITIVE = (0.0, 1.0), (0.0, np.inf)
_RANGES = {
    "relative_contact_area": _SHARE,
    "relative_repulsive_area": _SHARE,
    "largest_cluster_area": _SHARE,
    "gap_below": _SHARE,
    "pressure_below": _SHARE,
    "elastic_energy": _POSITIVE,
    "contact_perimeter": _POSITIVE,
    "mean_patch_diameter": _POSITIVE,
    "contact_modulus": _POSITIVE,
    "work_of_adhesion": _POSITIVE,
    "peak_tensile_stress": _POSITIVE,
    "process_zone": _POSITIVE,
    "rms_height": _POSITIVE,
    "rms_slope": _POSITIVE,
    "pull_off_pressure": (-np.inf, 0.0),
    "hurst_exponent": _SHARE,
}
_ROUNDING = 1e-5  # of single precision, over the values


def problems(dataset: xr.Dataset) -> list[str]:
    """List what is wrong with a dataset of contacts.

    Parameters
    ----------
    dataset : xarray.Dataset
        States by the names of this software's datasets, in SI; missing states are NaN.

    Returns
    -------
    list of str
        A line for each problem; none if there is none.

    Examples
    --------
    >>> import xarray as xr
    >>> from contact_study.atlas.validation import problems
    >>> problems(xr.Dataset())[0]
    'mean_pressure: is missing'
    """
    found = [f"{name}: is missing" for name in REQUIRED if name not in dataset]
    for name in map(str, dataset.data_vars):
        found += _of_variable(name, dataset[name])
    for check in (_convergence, _areas, _distributions, _losses, _strength, _grid, _content):
        found += check(dataset)
    return found


def _of_variable(name: str, variable: xr.DataArray) -> list[str]:
    found = []
    for word in ("units", "long_name"):
        if word not in variable.attrs:
            found.append(f"{name}: has no {word}")
    known = next((name.removeprefix(prefix) for prefix in _PREFIXES if name.startswith(prefix)), name)
    try:
        units = variable_of(known).units
    except KeyError:
        units = None
    if units is not None and variable.attrs.get("units", units) != units:
        found.append(f"{name}: is in {variable.attrs['units']!r}; expected {units!r}")
    if variable.dtype.kind not in "fiu":
        return found
    values = np.asarray(variable.values, float)
    if np.isinf(values).any():
        found.append(f"{name}: has {np.isinf(values).sum()} infinite values; mark missing states as NaN")
    low, high = _RANGES.get(known, (-np.inf, np.inf))
    outside = (values < low - _ROUNDING) | (values > high + _ROUNDING)
    if outside.any():
        found.append(f"{name}: {outside.sum()} values outside {low:g} to {high:g}, such as {values[outside][0]:.4g}")
    return found


def _has(dataset: xr.Dataset, *names: str) -> bool:
    return all(name in dataset for name in names)


def _counted(wrong: xr.DataArray, words: str) -> list[str]:
    count = int(wrong.sum())
    return [f"{words} at {count} of {wrong.size} places"] if count else []


def _convergence(dataset: xr.Dataset) -> list[str]:
    if not _has(dataset, "mean_pressure", "converged"):
        return []
    there = dataset["mean_pressure"].notnull()
    lost = int((there & (dataset["converged"] != 1)).sum())
    return [f"converged: {lost} of {int(there.sum())} states did not converge"] if lost else []


def _areas(dataset: xr.Dataset) -> list[str]:
    if not _has(dataset, "relative_repulsive_area", "relative_contact_area"):
        return []
    more = dataset["relative_repulsive_area"] > dataset["relative_contact_area"] + _ROUNDING
    return _counted(more, "relative_repulsive_area: exceeds relative_contact_area")


def _distributions(dataset: xr.Dataset) -> list[str]:
    found = []
    for what in ("gap", "pressure"):
        if _has(dataset, f"{what}_below", f"{what}_edge"):
            fallen = dataset[f"{what}_below"].diff(f"{what}_edge") < -_ROUNDING
            found += _counted(fallen, f"{what}_below: falls with {what}_edge")
    return found


def _losses(dataset: xr.Dataset) -> list[str]:
    if not _has(dataset, "dissipated_energy") or "step" not in dataset["dissipated_energy"].dims:
        return []
    lost = dataset["dissipated_energy"]
    # Missing states lie between others: the largest loss so far is carried over them.
    so_far = np.fmax.accumulate(lost.values, axis=lost.get_axis_num("step"))
    fallen = lost < so_far - _ROUNDING * float(abs(lost).max())
    return _counted(fallen, "dissipated_energy: falls along the path")


def _strength(dataset: xr.Dataset) -> list[str]:
    if not _has(dataset, "pull_off_pressure", "peak_tensile_stress"):
        return []
    beyond = dataset["pull_off_pressure"] < -dataset["peak_tensile_stress"] * (1 + _ROUNDING)
    return _counted(beyond, "pull_off_pressure: exceeds peak_tensile_stress")


def _grid(dataset: xr.Dataset) -> list[str]:
    if not _has(dataset, "pixel", "process_zone"):
        return []
    coarse = dataset["pixel"] * POINTS_PER_PROCESS_ZONE > dataset["process_zone"] * (1 + _ROUNDING)
    return _counted(coarse, "pixel: exceeds a quarter of process_zone")


def _content(dataset: xr.Dataset) -> list[str]:
    stated = dataset.attrs.get("content_sha256")
    if stated is None or stated == checksum(dataset):
        return []
    return ["content_sha256: differs from the checksum of the content; the file has changed"]
