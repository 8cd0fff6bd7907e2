"""The models' datasets: opened, checked and told apart by their ``model`` attribute.

Fields over the lateral plane stay in the files, which :func:`field_at` reads one at a time; all else is in memory.
"""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.schema import SCHEMA_VERSION
from contact_study.problem.case import Case
from contact_study.problem.errors import InputError
from contact_study.problem.study import Study, make_study

# Order of trust where one number must stand for all: the two simulations, then the theories.
MODELS = ("atomistic", "continuum", "theory", "gap_flow")
_ROOTS = ("continuum", "atomistic", "theory")
_FIELDS = ("gap", "pressure")

# Keys that a pair of datasets must share to be of one contact; a difference in any other is said, not refused.
_IDENTICAL = {
    "surface": {"size", "kind", "hurst_exponent", "rms_height", "low_mode", "roll_off_mode", "cutoff_mode", "seed"}
    | {"normalisation", "path", "height_unit", "radius", "amplitude", "modes"},
    "material": {"youngs_modulus", "poissons_ratio", "lattice_constant"},
    "interaction": {"law", "well_depth", "work_of_adhesion", "well_depth_ratio", "length"},
    "loading": {"control"},
}
_WORTH_A_NOTE = {
    "surface": {"shape"},
    "material": {"atom_mass"},
    "interaction": {"contact_distance"},
    "loading": {"path", "unload"},
    "solver": {"tolerance"},
}


@dataclass(frozen=True)
class Inputs:
    """What is compared.

    Attributes
    ----------
    paths : dict
        File of each of the models ``continuum``, ``atomistic`` and ``theory`` that is there.
    models : dict
        Dataset of each model, ``gap_flow`` standing beside ``theory``, whose file holds both.
    branches : dict
        The metastable branches that enclose the gap-flow theory, ``loading`` and ``unloading``, if they are there.
    studies : dict
        Study of each file.
    notes : tuple of str
        Differences between the studies that a reader must know.
    """

    paths: dict[str, Path]
    models: dict[str, xr.Dataset]
    branches: dict[str, xr.Dataset]
    studies: dict[str, Study]
    notes: tuple[str, ...] = ()

    @property
    def study(self) -> Study:
        """The study of the first model, in the order of trust."""
        return next(self.studies[name] for name in MODELS if name in self.studies)

    @property
    def control(self) -> str:
        """What was prescribed: "pressure" or "gap"."""
        return self.study.cases[0].loading.control


def read_inputs(paths: Sequence[Path]) -> Inputs:
    """Open the datasets of at least two models, in any order.

    Raises
    ------
    InputError
        If a file is missing, unreadable or foreign, a model comes twice or alone, or the studies are of different
        contacts.
    """
    files: dict[str, Path] = {}
    models: dict[str, xr.Dataset] = {}
    branches: dict[str, xr.Dataset] = {}
    studies: dict[str, Study] = {}
    for path in paths:
        groups = _open(path)
        kind = groups[""].attrs["model"]
        if kind in files:
            raise InputError(f"{files[kind]} and {path} are both of the {kind} model; give one dataset of each model")
        files[kind] = path
        models[kind] = groups[""]
        if kind == "theory" and "gap_flow" in groups:
            models["gap_flow"] = groups["gap_flow"]
            sides = {side: groups.get(f"gap_flow/{side}") for side in ("loading", "unloading")}
            branches = {side: dataset for side, dataset in sides.items() if dataset is not None}
        studies[kind] = _study(path, groups[""])
    if len(files) < 2:
        raise InputError("a comparison needs the datasets of at least two models: continuum, atomistic, theory")
    notes = tuple(_check_pairs(files, studies))
    ordered = {name: models[name] for name in MODELS if name in models}
    return Inputs(files, ordered, branches, studies, notes)


def _open(path: Path) -> dict[str, xr.Dataset]:
    """Every group of a file by name, "" for the root, without the fields."""
    if not path.is_file():
        raise InputError(f"{path}: {'is a folder' if path.is_dir() else 'does not exist'}; expected a dataset (NetCDF)")
    try:
        with xr.open_datatree(path, engine="netcdf4", decode_timedelta=False) as tree:
            attrs = tree.attrs
            foreign = "schema_version" not in attrs or attrs.get("model") not in _ROOTS
            groups = {} if foreign else {node.path.strip("/"): _in_memory(node) for node in tree.subtree}
    except (OSError, RuntimeError, ValueError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"{path}: cannot be read as NetCDF, perhaps cut short ({reason})") from None
    if foreign:
        raise InputError(f"{path}: is no dataset of bem-adhesion, md-reference or persson-theory")
    if str(attrs["schema_version"]).split(".")[0] != SCHEMA_VERSION.split(".")[0]:
        raise InputError(f"{path}: has schema version {attrs['schema_version']}; this program reads {SCHEMA_VERSION}")
    return groups


def _in_memory(node: xr.DataTree) -> xr.Dataset:
    """The group without its fields, and without the plane where only they stood on it."""
    dataset = node.to_dataset().drop_vars(_FIELDS, errors="ignore")
    used = {dim for variable in dataset.data_vars.values() for dim in variable.dims}
    unused = [dim for dim in ("y", "x") if dim in dataset.dims and dim not in used]
    return dataset.drop_dims(unused).load()


def _study(path: Path, dataset: xr.Dataset) -> Study:
    try:
        return make_study(tomllib.loads(dataset.attrs["study_toml"]), path.parent)
    except (KeyError, tomllib.TOMLDecodeError):
        raise InputError(f"{path}: does not hold the study it came from (attribute study_toml)") from None
    except InputError as error:
        raise InputError(f"{path}: its study is not one this version can read: {error}") from None


def _check_pairs(paths: Mapping[str, Path], studies: Mapping[str, Study]) -> Iterator[str]:
    """Notes on the differences between the studies; refuses those of different contacts."""
    names = [name for name in MODELS if name in studies]
    for other in names[1:]:
        first = names[0]
        where = f"{paths[first]} and {paths[other]}"
        pairs = _matching_cases(studies[first], studies[other])
        if not pairs:
            raise InputError(f"{where} cannot be compared: their sweeps have no point in common")
        analytic = other == "theory" and all(case.theory.spectrum == "analytic" for case in studies[other].cases)
        different: dict[str, tuple[Any, Any]] = {}
        for one, two in pairs:
            different.update(_differences(one, two))
        for key, (one_value, two_value) in different.items():
            section, _, name = key.partition(".")
            values = f"{key} is {_shown(one_value)} in the one and {_shown(two_value)} in the other"
            if key == "surface.seed" and analytic:
                continue  # a theory of the ensemble knows no realisation
            if name in _IDENTICAL.get(section, set()):
                raise InputError(f"{where} cannot be compared: {values}")
            if name in _WORTH_A_NOTE.get(section, set()):
                yield f"{where}: {values}"
        points = {len(study.cases) for study in (studies[first], studies[other])} | {len(pairs)}
        if len(points) > 1 and set(studies[first].sweep) == set(studies[other].sweep):
            yield f"{where} share {len(pairs)} points of their sweeps; only these are compared"


def _matching_cases(one: Study, two: Study) -> list[tuple[Case, Case]]:
    shared = set(one.sweep) & set(two.sweep)
    return [
        (a, b)
        for a in one.cases
        for b in two.cases
        if all(a.coordinates[name] == b.coordinates[name] for name in shared)
    ]


def _differences(one: Case, two: Case) -> Iterator[tuple[str, tuple[Any, Any]]]:
    for section in {**_IDENTICAL, **_WORTH_A_NOTE}:
        left, right = getattr(one, section), getattr(two, section)
        for field in fields(left):
            values = getattr(left, field.name), getattr(right, field.name)
            if values[0] != values[1]:
                yield f"{section}.{field.name}", values


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_shown(item) for item in value) + "]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def field_at(path: Path, name: str, selection: Mapping[str, Any], step: int) -> np.ndarray | None:
    """One field (y, x) of a file, or None where the file keeps no fields.

    Parameters
    ----------
    path : pathlib.Path
        Dataset of a simulation.
    name : str
        ``"gap"`` or ``"pressure"``.
    selection : mapping
        Swept coordinates.
    step : int
        Position on the path.
    """
    with xr.open_dataset(path, decode_timedelta=False) as dataset:
        if name not in dataset:
            return None
        chosen = {dim: value for dim, value in selection.items() if dim in dataset.dims}
        return dataset[name].sel(chosen).isel(step=step).values
