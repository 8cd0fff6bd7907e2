"""Studies of the datasets, held against what the datasets hold and against one another.

The report's text is from the study, which tools that join or cut datasets ignore: it is changed to what the dataset
holds, or the dataset is refused. Differences that make two studies different contacts are refused, others are notes.
"""

import itertools
import tomllib
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.record import differences, key_values, recorded_height_maps, recorded_study
from contact_study.inputs.errors import InputError
from contact_study.report.models import TARGET, is_simulated
from contact_study.report.read.load_steps import SEED, positions, swept_dims
from contact_study.study.case import Case, PathPoint, path_points, path_points_of
from contact_study.study.schema.bodies import ADDED_SECTIONS
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, same
from contact_study.study.schema.keys import keys_of, shown
from contact_study.study.study import Study, make_study

# Keys that two datasets must share to be of one contact.
ONE_CONTACT = {
    f"{section}.{name}"
    for section, names in {
        "surface": " ".join(name for name in keys_of(SECTIONS["surface"]) if name != "shape"),
        "material": "youngs_modulus poissons_ratio lattice_constant",
        "elasticity": " ".join(keys_of(SECTIONS["elasticity"])),
        "interaction": "law well_depth work_of_adhesion well_depth_ratio length",
        "loading": "control",
    }.items()
    for name in names.split()
}
_EVEN = 1e-9  # of the largest bin: how far widths of even bins may differ


def carried_study(path: Path, dataset: xr.Dataset, average: str = SEED) -> tuple[Study, list[str]]:
    """Read the study of a dataset, with the sweep that the dataset holds, and notes on what differs in it."""
    study = _named(path, lambda: recorded_study(dataset.attrs, path.parent))
    changes = dict(_changed_sweep(path, dataset, study))
    if changes:
        table = tomllib.loads(dataset.attrs["study_toml"])
        dotted = {key.rpartition(".")[2]: key for key in table.get("sweep", {})}
        for name, values in changes.items():
            table.setdefault("sweep", {})[dotted.get(name) or _only_key(path, name, table)] = values
        study = _named(path, lambda: make_study(table, path.parent), "its study is not one this version can read: ")
    _check_bins(path, dataset, study)
    _check_paths(path, dataset, study, average)
    notes = [
        f"{path}: holds {name} = {', '.join(map(str, values))}, its study sweeps other values; the dataset's are taken"
        for name, values in changes.items()
    ]
    return study, notes


def _named(path: Path, read: Callable[[], Study], words: str = "") -> Study:
    try:
        return read()
    except InputError as error:
        raise InputError(f"{path}: {words}{error}") from None


def _changed_sweep(path: Path, dataset: xr.Dataset, study: Study) -> Iterator[tuple[str, list[Any]]]:
    """Yield swept keys and values of the dataset that are not those of its study."""
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


def _only_key(path: Path, name: str, table: Mapping[str, Any]) -> str:
    """The one key of that name that can be swept, of the sections that the study has where several know it."""
    sections = [section for section in SECTIONS if section not in WHOLE_STUDY and name in keys_of(SECTIONS[section])]
    if not sections:
        raise InputError(f"{path}: its dimension {name} is no key that a study sweeps")
    given = [
        section
        for section in sections
        if len(sections) == 1 or (section in table and (name in table[section] or section not in ADDED_SECTIONS))
    ]
    if len(given) != 1:
        keys = ", ".join(f"{section}.{name}" for section in given or sections)
        raise InputError(f"{path}: its dimension {name} may be any of {keys}; sweep the key in one study")
    return f"{given[0]}.{name}"


def _check_bins(path: Path, dataset: xr.Dataset, study: Study) -> None:
    """Refuse bins that are not the study's: joined datasets have the bins of all, and a density on none of them."""
    output = study.cases[0].output
    for name, count, limits in (
        ("pressure_bin", output.pressure_bins, output.pressure_range),
        ("gap_bin", output.gap_bins, output.gap_range),
    ):
        if name not in dataset.coords:
            continue
        centres = dataset[name].values
        width = np.diff(centres)
        even = centres.size == count and np.ptp(width) <= _EVEN * np.abs(centres).max()
        if even and limits is not None:
            ends = np.array(limits) + np.array([0.5, -0.5]) * width.mean()
            even = np.allclose(centres[[0, -1]], ends, rtol=0, atol=1e-6 * width.mean())
        if not even:
            raise InputError(
                f"{path}: its {name} are not the {count} even bins of its study, as if datasets of different bins had "
                "been joined; run them as one study, or with one output.pressure_range and output.gap_range"
            )


def _check_paths(path: Path, dataset: xr.Dataset, study: Study, average: str) -> None:
    """Refuse loading paths that are not the study's, or differ among what is averaged."""
    controls = {case.loading.control for case in study.cases}
    if len(controls) > 1:
        raise InputError(
            f"{path}: prescribes pressures at some points of its sweep, gaps at others; compare them apart"
        )
    first: dict[tuple[Any, ...], Case] = {}
    for case in study.cases:
        if _path_of(dataset, case) != path_points_of(case):
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


def check_studies(
    names: Sequence[str], paths: Mapping[str, Path], studies: Mapping[str, Study], ignored: Collection[str] = ()
) -> Iterator[str]:
    """Yield notes on the differences between the study of the first name and each other one."""
    first = names[0]
    for other in names[1:]:
        where = f"{paths[first]} and {paths[other]}"
        shared = set(studies[first].sweep) & set(studies[other].sweep)
        pairs = [
            (one, two)
            for one, two in itertools.product(studies[first].cases, studies[other].cases)
            if all(same(one.coordinates[name], two.coordinates[name]) for name in shared)
        ]
        if not pairs:
            raise InputError(f"{where} cannot be compared: their sweeps have no point in common")
        target_only = not is_simulated(other) and all(case.spectra == (TARGET,) for case in studies[other].cases)
        different: dict[str, tuple[Any, Any]] = {}
        for one, two in pairs:
            found = differences(dict(key_values(one)), dict(key_values(two)))
            different |= {key: values for key, values in found.items() if key not in different}
        for key, (one_value, two_value) in different.items():
            if key in ignored or (key == "surface.seed" and target_only):
                continue  # a theory of the ensemble uses no realisation
            values = f"{key} is {shown(one_value)} in the one and {shown(two_value)} in the other"
            if key in ONE_CONTACT:
                raise InputError(f"{where} cannot be compared: {values}")
            yield f"{where}: {values}"
        points = {len(study.cases) for study in (studies[first], studies[other])} | {len(pairs)}
        if len(points) > 1 and set(studies[first].sweep) == set(studies[other].sweep):
            yield f"{where} share {len(pairs)} points of their sweeps; only these are compared"


def check_height_maps(paths: Mapping[str, Path], attributes: Mapping[str, Mapping[str, Any]]) -> None:
    """Refuse datasets whose height maps had another content when they were read."""
    known: dict[str, tuple[str, str]] = {}
    for name, path in paths.items():
        for height_map, content in recorded_height_maps(attributes[name]).items():
            first, other = known.setdefault(height_map, (name, content))
            if other != content:
                raise InputError(
                    f"{paths[first]} and {path} cannot be compared: the map {height_map} had another content; "
                    "run both again on the same file"
                )
