"""Gap fields of a continuum dataset as starting configurations for the steps of another run."""

import hashlib
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.campaign import record
from contact_study.campaign.dataset.file import opened
from contact_study.campaign.record import differences
from contact_study.campaign.store.files import require_dataset
from contact_study.inputs.errors import InputError
from contact_study.results.state import usable
from contact_study.study.case import Case, path_points, path_points_of
from contact_study.study.schema.bodies import ROUGH_SECTIONS
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, same
from contact_study.study.schema.keys import keys_of
from contact_study.study.study import Study

# Sections that define a contact, and their keys that do not: each model has its own grid, a height map counts by its
# content, and no gap field depends on the lattice or the contact distance.
_GEOMETRY = ("form", *ROUGH_SECTIONS)
_CONTACT = (*_GEOMETRY, "material", "elasticity", "interaction", "adhesion_map")
_NO_CONTACT = ("shape", "path", "atom_mass", "lattice_constant", "contact_distance")
# Keys that the work of adhesion stands for.
_ADHESION = ("well_depth", "well_depth_ratio", "work_of_adhesion")
# Methods of the atoms with another starting configuration.
_OWN_START = ("overdamped", "dynamics")
_OPTION = "--predictor"


def check_predictor(path: Path, study: Study, height_maps: Mapping[str, str]) -> list[str]:
    """Check that a dataset of the continuum can be a study's predictor; returns notes of another law."""
    for case in study.cases:
        if case.atomistic.method in _OWN_START:
            raise InputError(
                f'{_OPTION} {path}: atoms of atomistic.method = "{case.atomistic.method}" start from separation; leave '
                "the option out"
            )
    require_dataset(path, _OPTION)
    with opened(path, _OPTION) as dataset:
        if "gap" not in dataset or not str(dataset["gap"].dims[-1]).startswith("x"):
            raise InputError(f"{_OPTION}: {path} holds no gap fields; write it with output.fields = true")
        attributes = dict(dataset.attrs)
    other, maps = _study(path, str(attributes.get("study_toml"))), record.recorded_height_maps(attributes)
    differing: dict[str, tuple[Any, Any]] = {}
    for case in study.cases:
        start = _start_case(other, case)
        if start is not None:
            differing |= differences(_contact_keys(start), _contact_keys(case))
            for dotted, name in case.geometry.map_keys.items():
                if height_maps.get(name) != maps.get(start.geometry.map_keys.get(dotted, "")):
                    raise InputError(f"{_OPTION}: {path} is of another height map than {name}")
    notes = []
    for key, pair in differing.items():
        words = f"is of another contact: {record.describe_differences({key: pair}, 'there', 'here')}"
        if key.partition(".")[0] in (*_GEOMETRY, "loading"):
            raise InputError(f"{_OPTION}: {path} {words}")
        notes.append(f"the predictor {path} {words}; its gap fields may select other states")
    return notes


class GapFields:
    """Gap field (y, x) of each path point of a case, by the swept keys of both studies; None without one."""

    def __init__(self, path: Path, case: Case):
        self._path = path
        self._case = case
        self._points = path_points_of(case)
        with opened(path, _OPTION) as dataset:
            study = _study(path, str(dataset.attrs.get("study_toml")))
        start = _start_case(study, case)
        self._index = None if start is None else dict(zip(study.sweep, start.index, strict=True))

    def __call__(self, number: int) -> np.ndarray | None:
        if self._index is None:
            return None
        with opened(self._path, _OPTION) as dataset:
            dataset = dataset.isel({name: i for name, i in self._index.items() if name in dataset.dims})
            points = path_points(dataset[f"applied_{self._case.loading.control}"].values, dataset["branch"].values)
            if self._points[number] not in points:
                return None
            state = dataset.isel(step=points.index(self._points[number]))
            if not usable(state):
                return None
            field = state["gap"].values.astype(float)
        there = ~np.isnan(field)  # rows and columns of NaN pad it in a sweep over sizes
        field = field[: np.count_nonzero(there.any(axis=1)), : np.count_nonzero(there.any(axis=0))]
        return field if field.size else None  # not among output.field_steps

    def fingerprint(self, number: int) -> str:
        """SHA-256 of the field of a path point; empty where there is none."""
        field = self(number)
        return "" if field is None else hashlib.sha256(np.ascontiguousarray(field).tobytes()).hexdigest()


@lru_cache(maxsize=1)  # every case of a study asks for it
def _study(path: Path, toml: str) -> Study:
    try:
        return record.recorded_study({"study_toml": toml}, path.parent)
    except InputError as error:
        raise InputError(f"{_OPTION}: {path} {error}") from None


def _start_case(study: Study, case: Case) -> Case | None:
    """The case of another study at the same point of either sweep: of the same contact, as near as possible else."""
    swept = {*study.sweep, *case.coordinates}
    contact = {name for section in _CONTACT for name in keys_of(SECTIONS[section])} - {*_NO_CONTACT} | {"path"}

    def shared(other: Case, names: set[str]) -> int:
        return sum(same(_value_of(other, name), _value_of(case, name)) for name in names)

    alike = (other for other in study.cases if shared(other, swept & contact) == len(swept & contact))
    return max(alike, key=lambda other: shared(other, swept - contact), default=None)


def _value_of(case: Case, name: str) -> Any:
    """Value of a swept key by its last part; None where the case has no such key."""
    sections = (getattr(case, section) for section in SECTIONS if section not in WHOLE_STUDY)
    found = [getattr(section, name) for section in sections if name in keys_of(type(section))]
    # Bodies share names of keys.
    return case.coordinates.get(name, found[0]) if len(found) > 1 else found[0] if found else None


def _contact_keys(case: Case) -> dict[str, Any]:
    """Keys that define the contact of a case."""
    left_out = (*_NO_CONTACT, *_ADHESION)
    values = {key: value for key, value in record.key_values(case, _CONTACT) if key.split(".")[1] not in left_out}
    return {**values, "the work of adhesion": case.law.work_of_adhesion, "loading.control": case.loading.control}
