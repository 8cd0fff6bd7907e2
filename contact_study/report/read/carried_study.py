"""The study that a dataset carries, held against what the dataset holds.

Datasets are joined, cut and passed on with tools that know nothing of the study in their attributes. What the report
says is taken from the study, so the study is made to say what the dataset holds, or the dataset is refused.
"""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.errors import InputError
from contact_study.report.read.differences import SAME, same
from contact_study.report.read.load_steps import SEED, positions, swept_dims
from contact_study.study.case import Case
from contact_study.study.load_steps import PathPoint, path_points, path_points_of
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY
from contact_study.study.schema.keys import keys_of
from contact_study.study.study import Study, make_study


def carried_study(path: Path, dataset: xr.Dataset, average: str = SEED) -> tuple[Study, list[str]]:
    """The study of a dataset, its sweep being what the dataset holds, and what had to be changed for that.

    Parameters
    ----------
    path : pathlib.Path
        File of the dataset, for messages and for what the study names beside it.
    dataset : xarray.Dataset
        Root group of a model's dataset.
    average : str
        Swept key over which a reader sees means.

    Raises
    ------
    InputError
        If there is no such study, or the dataset has bins or a loading path that are not its study's.
    """
    try:
        table = tomllib.loads(dataset.attrs["study_toml"])
    except (KeyError, tomllib.TOMLDecodeError):
        raise InputError(f"{path}: does not hold the study it came from (attribute study_toml)") from None
    study = _readable(path, table)
    changes = dict(_changed_sweep(path, dataset, study))
    if changes:
        study = _readable(path, _with_sweep(path, table, changes))
    _check_bins(path, dataset, study)
    _check_paths(path, dataset, study, average)
    notes = [
        f"{path}: holds {name} = {', '.join(f'{value}' for value in values)}, which the study it carries does not "
        "sweep so; the dataset's are taken"
        for name, values in changes.items()
    ]
    return study, notes


def _readable(path: Path, table: dict[str, Any]) -> Study:
    try:
        return make_study(table, path.parent)
    except InputError as error:
        raise InputError(f"{path}: its study is not one this version can read: {error}") from None


def _changed_sweep(path: Path, dataset: xr.Dataset, study: Study) -> Iterator[tuple[str, list[Any]]]:
    """Swept keys and values of the dataset that are not those of its study."""
    dims = swept_dims(dataset)
    for name in study.sweep:
        if name not in dims:
            raise InputError(
                f"{path}: lacks the dimension {name}, which its study sweeps; cut it with lists, "
                f"dataset.sel({name}=[…]), which keep the dimension"
            )
    for name in dims:
        held = tuple(value.item() for value in dataset[name].values)
        if name not in study.sweep or not same(held, study.sweep[name].values):
            yield name, list(held)


def _with_sweep(path: Path, table: dict[str, Any], changes: dict[str, list[Any]]) -> dict[str, Any]:
    """The study's table with other values of some swept keys."""
    dotted = {key.rpartition(".")[2]: key for key in table.get("sweep", {})}
    for name, values in changes.items():
        key = dotted.get(name) or _only_key(path, name)
        table.setdefault("sweep", {})[key] = values
    return table


def _only_key(path: Path, name: str) -> str:
    """The one key of a study file of that name that can be swept."""
    found = [
        f"{section}.{name}"
        for section, declared in SECTIONS.items()
        if section not in WHOLE_STUDY and name in keys_of(declared)
    ]
    if len(found) != 1:
        raise InputError(f"{path}: its dimension {name} is no key that a study sweeps")
    return found[0]


def _check_bins(path: Path, dataset: xr.Dataset, study: Study) -> None:
    """Joined datasets of different bins have the bins of all, and a density on none of them."""
    output = study.cases[0].output
    for name, count, limits in (
        ("pressure_bin", output.pressure_bins, output.pressure_range),
        ("gap_bin", output.gap_bins, output.gap_range),
    ):
        if name not in dataset.coords:
            continue
        centres = dataset[name].values
        width = np.diff(centres)
        even = centres.size == count and np.ptp(width) <= SAME * np.abs(centres).max()
        inside = limits is None or np.allclose(
            centres[[0, -1]], np.array(limits) + np.array([0.5, -0.5]) * width.mean(), rtol=0, atol=1e-6 * width.mean()
        )
        if not (even and inside):
            raise InputError(
                f"{path}: its {name} are not the {count} even bins of its study, as if datasets of different bins had "
                "been joined; run them as one study, or with one output.pressure_range and output.gap_range"
            )


def _check_paths(path: Path, dataset: xr.Dataset, study: Study, average: str) -> None:
    """Every case walks the path of its study, and all samples of a point of the sweep the same one."""
    if len({case.loading.control for case in study.cases}) > 1:
        raise InputError(
            f"{path}: prescribes pressures at some points of its sweep, gaps at others; compare them apart"
        )
    first: dict[tuple[Any, ...], Case] = {}
    for case in study.cases:
        walked = _path_of(dataset, case)
        if walked != path_points_of(case):
            at = f" at {case.label}" if case.label else ""
            raise InputError(
                f"{path}: its loading path{at} is not that of the study it carries; compare whole datasets"
            )
        others = tuple(value for name, value in case.coordinates.items() if name != average)
        if first.setdefault(others, case).path != case.path:
            raise InputError(
                f"{path}: points that differ in {average} alone take different loading paths ({case.label}); "
                "they cannot be averaged"
            )


def _path_of(dataset: xr.Dataset, case: Case) -> list[PathPoint]:
    at = positions({dim: dataset[dim].values for dim in swept_dims(dataset)}, case.coordinates)
    prescribed, branch = (
        dataset[name].isel({dim: index for dim, index in at.items() if dim in dataset[name].dims}).values
        for name in (f"applied_{case.loading.control}", "branch")
    )
    return [point for point in path_points(prescribed, branch) if point is not None]
