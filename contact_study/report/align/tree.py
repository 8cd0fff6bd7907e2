"""The dataset of a comparison: every model's own beside what tells them apart."""

from collections.abc import Mapping
from typing import Any

import xarray as xr

from contact_study.report.align.ensemble import ensemble_statistics
from contact_study.report.read.datasets import Inputs


def comparison_tree(
    inputs: Inputs,
    deviations: xr.Dataset | None,
    regime: xr.Dataset,
    attrs: Mapping[str, Any],
    of_surfaces: Mapping[str, xr.Dataset] | None = None,
    from_surfaces: xr.Dataset | None = None,
) -> xr.DataTree:
    """A group for each file, named after its kind and as in the file itself, ``regime``, ``deviations`` if any.

    In ``ensemble`` stand, for each model with several samples, means and standard errors over them; in ``scatter`` the
    same of the realisations that are shown behind the models, and the theories' deviations from each of them.

    Parameters
    ----------
    inputs : Inputs
        What was compared; its datasets without the fields.
    deviations, regime : xarray.Dataset
        As :func:`compute_deviations` and :func:`compute_regime` return them; None where nothing deviates from another.
    attrs : mapping
        Attributes of the root.
    of_surfaces : mapping, optional
        What :func:`ensemble_statistics` makes of the realisations that are shown behind the models.
    from_surfaces : xarray.Dataset, optional
        Deviations of the theories from each of these realisations.
    """
    groups = {
        f"/{kind}" + (f"/{name}" if name else ""): dataset
        for kind, contents in inputs.groups.items()
        for name, dataset in contents.items()
    }
    groups["/regime"] = regime
    groups |= {f"/ensemble/{name}": dataset for name, dataset in ensemble_statistics(inputs.models).items()}
    groups |= {f"/scatter/{name}": dataset for name, dataset in (of_surfaces or {}).items()}
    if from_surfaces is not None:
        groups["/scatter/deviations"] = from_surfaces
    if deviations is not None:
        groups["/deviations"] = deviations
    return xr.DataTree.from_dict(
        {"/": xr.Dataset(attrs=attrs), **{path: _without_filled_coordinates(d) for path, d in groups.items()}}
    )


def _without_filled_coordinates(dataset: xr.Dataset) -> xr.Dataset:
    """CF: a coordinate variable has no missing values, hence no fill value."""
    dataset = dataset.copy()
    for name in dataset.indexes:
        dataset[name].encoding = {"_FillValue": None} if dataset[name].dtype.kind in "fiu" else {}
    return dataset
