"""Gap fields of another dataset, as starts for the steps of a case."""

import hashlib
import tomllib
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.dataset.formats import engine_of, readable, require_dataset
from contact_study.errors import InputError
from contact_study.study.case import Case
from contact_study.study.load_steps import path_points, path_points_of
from contact_study.study.schema.dotted_keys import SECTIONS, same
from contact_study.study.schema.keys import keys_of, shown
from contact_study.study.study import Study, make_study

# Sections and keys that make a contact what it is. The grid is each model's own, a map's content counts and not its
# place, and the lattice and the distance that counts as contact are nothing to a gap field.
_CONTACT = ("surface", "material", "elasticity", "interaction")
_APART = ("shape", "path", "atom_mass", "lattice_constant", "contact_distance")
# Ways of the atoms that begin with none of another model's states.
_WITHOUT_START = ("overdamped", "dynamics")
_OPTION = "--predictor"
# What stands for these is Δγ.
_ADHESION = ("well_depth", "well_depth_ratio", "work_of_adhesion")


def check_predictor(path: Path, study: Study, height_maps: Mapping[str, str]) -> list[str]:
    """Make sure that a dataset can serve a study as predictor.

    A start chooses among the states that adhesion leaves, so it must be of the same surface; other moduli or another
    law give starts that are only rough, and are said.

    Parameters
    ----------
    path : pathlib.Path
        Dataset of the continuum.
    study : Study
        The study to be started.
    height_maps : mapping
        SHA-256 of each of its height maps by the path as the study writes it.

    Returns
    -------
    list of str
        In what the dataset's study differs.

    Raises
    ------
    InputError
        If it cannot be read, holds no gap fields, or is of another surface or control, or if atoms of the study come
        down by themselves.
    """
    for case in study.cases:
        if case.atomistic.method in _WITHOUT_START:
            raise InputError(
                f'--predictor {path}: atoms of atomistic.method = "{case.atomistic.method}" come down by themselves; '
                "leave it out"
            )
    require_dataset(path, _OPTION)
    with readable(path, _OPTION), xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False) as dataset:
        if "gap" not in dataset or not str(dataset["gap"].dims[-1]).startswith("x"):
            raise InputError(f"--predictor: {path} holds no gap fields; write it with output.fields = true")
        attributes = dict(dataset.attrs)
    other = _study(path, attributes)
    maps = {line.partition(" ")[2]: line.split(" ")[0] for line in str(attributes.get("height_maps", "")).splitlines()}
    differing: dict[str, tuple[Any, Any]] = {}
    for case in study.cases:
        start = _matching(other, case)
        if start is not None:
            differing.update(_differences(case, start))
            if case.height_map is not None:
                content = f"sha256:{height_maps[str(case.surface.map_path)]}", maps.get(str(start.surface.map_path))
                if content[0] != content[1]:
                    raise InputError(f"--predictor: {path} is of another height map than {case.surface.map_path}")
    for dotted, (own, others) in differing.items():
        if dotted.startswith(("surface.", "loading.")):
            raise InputError(
                f"--predictor: {path} is of another contact: {dotted} is {shown(others)} there and {shown(own)} here"
            )
    return [
        f"the predictor {path} is of another contact: {dotted} is {shown(others)} there and {shown(own)} here; its "
        "gap fields may choose other states"
        for dotted, (own, others) in differing.items()
    ]


class GapFields:
    """Gap field (y, x) of each path point of one case, or None where the dataset has no such converged state.

    Parameters
    ----------
    path : pathlib.Path
        Dataset of the continuum.
    case : Case
        The case to be started; matched by what either study sweeps and by the points of its path.
    """

    def __init__(self, path: Path, case: Case):
        self._path = path
        self._case = case
        self._points = path_points_of(case)
        with readable(path, _OPTION), xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False) as dataset:
            study = _study(path, dataset.attrs)
        start = _matching(study, case)
        self._index = None if start is None else dict(zip(study.sweep, start.index, strict=True))

    def __call__(self, number: int) -> np.ndarray | None:
        if self._index is None:
            return None
        with (
            readable(self._path, _OPTION),
            xr.open_dataset(self._path, engine=engine_of(self._path), decode_timedelta=False) as dataset,
        ):
            dataset = dataset.isel({name: i for name, i in self._index.items() if name in dataset.dims})
            points = path_points(dataset[f"applied_{self._case.loading.control}"].values, dataset["branch"].values)
            if self._points[number] not in points:
                return None
            state = dataset.isel(step=points.index(self._points[number]))
            if state["converged"] != 1 or state["detached"] == 1:
                return None
            field = _unpadded(state["gap"].values.astype(float))
            return field if field.size else None  # not among output.field_steps

    def fingerprint(self, number: int) -> str:
        """SHA-256 of the field of a path point; empty where there is none."""
        field = self(number)
        return "" if field is None else hashlib.sha256(np.ascontiguousarray(field).tobytes()).hexdigest()


def _study(path: Path, attributes: Mapping[str, Any]) -> Study:
    try:
        return _made(str(attributes["study_toml"]), path.parent)
    except (KeyError, tomllib.TOMLDecodeError, InputError):
        raise InputError(f"--predictor: {path} does not hold the study it came from (attribute study_toml)") from None


@lru_cache(maxsize=1)  # every case of a study asks for it
def _made(toml: str, directory: Path) -> Study:
    return make_study(tomllib.loads(toml), directory)


def _matching(study: Study, case: Case) -> Case | None:
    """The case of another study that stands at the same point of what either study sweeps, as far as contacts go."""
    swept = {*study.sweep, *case.coordinates}
    deciding = {name for section in _CONTACT for name in keys_of(SECTIONS[section])} - {*_APART} | {"path"}
    alike = [
        other
        for other in study.cases
        if all(same(_value(other, name), _value(case, name)) for name in swept & deciding)
    ]
    rest = swept - deciding
    return max(
        alike, key=lambda other: sum(same(_value(other, name), _value(case, name)) for name in rest), default=None
    )


def _value(case: Case, name: str) -> Any:
    """What a case holds under the last part of a key that can be swept."""
    for section in (case.surface, case.material, case.interaction, case.solver, case.atomistic, case.theory):
        if name in keys_of(type(section)):
            return getattr(section, name)
    return getattr(case.loading, name, None)  # None: a key of another kind than the case's


def _differences(case: Case, other: Case) -> Iterator[tuple[str, tuple[Any, Any]]]:
    """Keys that tell two contacts apart, with the values of both."""
    for section in _CONTACT:
        for name in keys_of(SECTIONS[section]):
            values = getattr(getattr(case, section), name, None), getattr(getattr(other, section), name, None)
            if name not in (*_APART, *_ADHESION) and not same(*values):
                yield f"{section}.{name}", values
    if not same(case.law.work_of_adhesion, other.law.work_of_adhesion):
        yield "the work of adhesion", (case.law.work_of_adhesion, other.law.work_of_adhesion)
    if case.loading.control != other.loading.control:
        yield "loading.control", (case.loading.control, other.loading.control)


def _unpadded(field: np.ndarray) -> np.ndarray:
    """A field without the rows and columns that a sweep over sizes pads it with."""
    there = ~np.isnan(field)
    return field[: np.count_nonzero(there.any(axis=1)), : np.count_nonzero(there.any(axis=0))]
