"""Points of the models' loading paths, matched by prescribed value, branch and occurrence."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from contact_study.results.schema import COORDINATES
from contact_study.study.case import PathPoint, path_points
from contact_study.study.schema.dotted_keys import same

SEED = "seed"

# Attribute of a dataset in a comparison: the swept key over which a reader sees means.
_AVERAGED = "averaged_over"


def averaged(dataset: xr.Dataset) -> str:
    """The swept key over which a reader sees means; a dataset may have no such dimension."""
    return str(dataset.attrs.get(_AVERAGED, SEED))


def with_average(dataset: xr.Dataset, name: str) -> xr.Dataset:
    """The dataset, to be averaged over a swept key."""
    return dataset.assign_attrs({_AVERAGED: name})


def swept_dims(dataset: xr.Dataset | xr.DataArray) -> tuple[str, ...]:
    """The swept keys among a dataset's dimensions, in their order.

    They have values, unlike dimensions that only count, such as points along y where the sweep changes their positions.
    In one point of the sweep only what is averaged over is left of them.
    """
    return tuple(str(dim) for dim in dataset.dims if dim in dataset.coords and dim not in COORDINATES)


def positions(dims: Mapping[str, np.ndarray], coordinates: Mapping[str, Any]) -> dict[str, int]:
    """Find the positions of swept values along their dimensions, however they were rounded."""
    found = {}
    for dim, value in coordinates.items():
        if dim in dims:
            index = next((index for index, given in enumerate(dims[dim]) if same(given, value)), None)
            if index is None:
                raise KeyError(f"{dim} = {value}")
            found[dim] = index
    return found


def on_common_path(models: Mapping[str, xr.Dataset], control: str) -> dict[str, xr.Dataset]:
    """The datasets on the swept points that all share, their steps arranged so that equal positions are equal points.

    The steps are those of the first model, followed by what only the others visit; where a model lacks a point its
    variables are NaN. ``prescribed`` and ``branch`` are alike in all.
    """
    wanted = {name: _with_step(dataset, control) for name, dataset in models.items()}
    shared = dict(zip(wanted, xr.align(*wanted.values(), join="inner", exclude=["step"]), strict=True))
    lead = xr.broadcast(*(dataset["prescribed"].isel(step=0, drop=True) for dataset in shared.values()))[0]
    points = {name: _all_points(dataset, lead) for name, dataset in shared.items()}
    every = {
        index: [point for of_model in points.values() for point in of_model[index]] for index in np.ndindex(lead.shape)
    }
    union = {index: [point for point in dict.fromkeys(own) if point is not None] for index, own in every.items()}
    steps = max(len(case) for case in union.values())
    position = {name: np.full((*lead.shape, steps), -1) for name in shared}
    prescribed = np.full((*lead.shape, steps), np.nan)
    branch = np.full((*lead.shape, steps), COORDINATES["branch"].empty)
    for index, case in union.items():
        for step, point in enumerate(case):
            prescribed[(*index, step)], branch[(*index, step)] = float(point[0]), point[1]
            for name in shared:
                if point in points[name][index]:
                    position[name][(*index, step)] = points[name][index].index(point)
    dims = (*lead.dims, "step")
    where = {name: xr.DataArray(found, dims=dims, coords=lead.coords) for name, found in position.items()}
    return {
        name: shared[name]
        .drop_vars(["prescribed", "branch"])
        .isel(step=where[name].clip(min=0))
        .where(where[name] >= 0)
        .assign_coords(prescribed=(dims, prescribed), branch=(dims, branch))
        for name in shared
    }


def _with_step(dataset: xr.Dataset, control: str) -> xr.Dataset:
    """Variables on the path alone, with the controlled quantity as ``prescribed``."""
    names = [name for name, v in dataset.data_vars.items() if set(v.dims) <= {*swept_dims(dataset), "step"}]
    names = [name for name in names if "step" in dataset[name].dims and dataset[name].dtype.kind in "fiub"]
    kept = dataset[names].drop_vars([name for name in dataset[names].coords if "step" in dataset[name].dims])
    kept = kept.assign_coords(prescribed=dataset[f"applied_{control}"], branch=dataset["branch"])
    return kept.drop_vars([f"applied_{control}", "step"], errors="ignore")


def _all_points(dataset: xr.Dataset, lead: xr.DataArray) -> dict[tuple[int, ...], list[PathPoint | None]]:
    """Points of every case, by position in the sweep."""
    prescribed, branch = (
        dataset[name].broadcast_like(lead).transpose(*lead.dims, "step").values for name in ("prescribed", "branch")
    )
    return {index: path_points(prescribed[index], branch[index]) for index in np.ndindex(lead.shape)}
