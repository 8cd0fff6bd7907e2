"""Datasets of the atlas as one: surfaces and conditions side by side, with a checksum of the content."""

import functools
import hashlib
from collections.abc import Sequence

import numpy as np
import xarray as xr

from contact_study.atlas.design import DESIGNED
from contact_study.inputs.errors import InputError

_EMPTY = -1  # of whole numbers, as in all datasets


def join(datasets: Sequence[xr.Dataset]) -> xr.Dataset:
    """Join datasets of different conditions or surfaces, of this software or others; what one of them lacks is empty.

    Parameters
    ----------
    datasets : sequence of xarray.Dataset
        Of one shape: ``condition``, ``surface``, ``preload`` and ``step``, sound by
        :func:`contact_study.atlas.validation.problems`.

    Returns
    -------
    xarray.Dataset
        In the order of the conditions' numbers, with the attributes of the first and the sum of processor times.

    Raises
    ------
    InputError
        If a dataset has no dimension ``condition``, or if two have the same surface of a condition, or contacts that
        differ under the same number.
    """
    parts: list[xr.Dataset] = []
    for number, one in enumerate(datasets, 1):
        if "condition" not in one.coords:
            raise InputError(f"dataset {number}: has no coordinate condition; number its contacts")
        if conflict := next(filter(None, (_conflict(other, one) for other in parts)), ""):
            raise InputError(f"dataset {number}: {conflict} another dataset; renumber it")
        parts.append(one.assign_coords(step=np.arange(one.sizes["step"])))
    known = {name: variable for one in reversed(parts) for name, variable in one.variables.items()}
    whole = {name for one in parts for name, variable in one.items() if variable.dtype.kind == "i"}
    masked = [one.assign({name: one[name].where(one[name] != _EMPTY) for name in whole & set(one)}) for one in parts]
    found = functools.reduce(xr.Dataset.combine_first, masked)
    found = found.assign({name: found[name].fillna(_EMPTY).astype(known[name].dtype) for name in whole})
    if all("processor_time" in one for one in parts):
        like = {"condition": found["condition"], "fill_value": 0.0}
        found["processor_time"] = sum(one["processor_time"].reindex(**like) for one in parts)
    for name in found.variables:
        found[name].attrs = known[name].attrs
    return sealed(found.drop_vars("step").sortby("condition"))


def _conflict(first: xr.Dataset, second: xr.Dataset) -> str:
    """Say which surface of a condition two datasets have, or which number has another contact; empty if none."""
    both = np.intersect1d(first["condition"], second["condition"])
    one, other = (each.sel(condition=both) for each in (first, second))
    for name in DESIGNED:
        if name in one and name in other and (differ := (one[name] != other[name]).values).any():
            return f"condition {both[differ][0]} has another {name} in"
    held, more = (each["mean_pressure"].notnull().any(["preload", "step"]) for each in (one, other))
    twice = (held & more).to_series()
    return "surface {1} of condition {0} is in".format(*twice.idxmax()) if twice.any() else ""


def concatenated(parts: Sequence[xr.Dataset], along: xr.Variable) -> xr.Dataset:
    """Concatenate datasets whose loops may differ in length, surfaces and preloads; what one lacks is empty."""
    aligned = [one.assign_coords(step=np.arange(one.sizes["step"])) for one in parts]
    whole_numbers = {name for one in aligned for name, variable in one.items() if variable.dtype.kind == "i"}
    empty = dict.fromkeys(whole_numbers, _EMPTY)
    found = xr.concat(aligned, along, data_vars="all", join="outer", combine_attrs="override", fill_value=empty)
    return found.drop_vars("step")


def sealed(dataset: xr.Dataset) -> xr.Dataset:
    """Reduce numbers to seven digits and NaN to one of its many, and enter the checksum of the content."""
    numbers = {name: variable for name, variable in dataset.data_vars.items() if variable.dtype.kind == "f"}
    found = dataset.assign({name: value.where(value.notnull()).astype(np.float32) for name, value in numbers.items()})
    return found.assign_attrs(content_sha256=checksum(found))


def checksum(dataset: xr.Dataset) -> str:
    """SHA-256 of names, dimensions and numbers of a dataset, however its file stores them."""
    digest = hashlib.sha256()
    for name in sorted(map(str, dataset.variables)):
        variable = dataset.variables[name]
        text = variable.dtype.kind in "OUS"
        values = np.asarray(variable.values, str if text else "<f4")
        digest.update(f"{name}{variable.dims}{values.shape}".encode())
        digest.update("\0".join(values.ravel()).encode() if text else (values + np.float32(0)).tobytes())
    return digest.hexdigest()
