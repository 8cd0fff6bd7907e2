"""The models' datasets: opened, checked and told apart by their ``model`` attribute.

Fields over the lateral plane stay in the files, which :func:`field_at` reads one at a time; all else is in memory.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.schema import LABELLED_GROUPS, SCHEMA_VERSION, VARIABLES, variable_of
from contact_study.comparison.read.carried_study import carried_study
from contact_study.comparison.read.differences import check_height_maps, check_studies, same
from contact_study.comparison.read.path_points import positions, swept_dims
from contact_study.problem.case import Case
from contact_study.problem.errors import InputError
from contact_study.problem.laws import TractionLaw
from contact_study.problem.study import Study

# Order of trust where one number must stand for all: the two simulations, then the theories.
MODELS = ("atomistic", "continuum", "theory", "gap_flow")
_ROOTS = ("continuum", "atomistic", "theory")
_FIELDS = ("gap", "pressure")
_METASTABLE = LABELLED_GROUPS[2]
# Groups of a file that are read, "" for the root; a file may hold others, such as states to go on from.
_GROUPS = ("", _METASTABLE)
_THEORIES = {"theory": "persson", "gap_flow": "gap_flow"}


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
    groups : dict
        Groups of each file as they stand in it, "" for the root.
    """

    paths: dict[str, Path]
    models: dict[str, xr.Dataset]
    branches: dict[str, xr.Dataset]
    studies: dict[str, Study]
    notes: tuple[str, ...] = ()
    groups: dict[str, dict[str, xr.Dataset]] = field(default_factory=dict)

    @property
    def study(self) -> Study:
        """The study of the first model, in the order of trust."""
        return next(self.studies[name] for name in MODELS if name in self.studies)

    @cached_property
    def cases(self) -> list[Case]:
        """Every case of some study, once; a theory that knows no seed has no other cases than the simulations."""
        found = list(self.study.cases)
        for study in (self.studies[name] for name in MODELS if name in self.studies):
            if study is not self.study:
                found += [case for case in study.cases if not any(is_at(known, case.coordinates) for known in found)]
        return found

    def cases_at(self, coordinates: Mapping[str, Any]) -> list[Case]:
        """The cases at a point of the sweep: one, or one for each seed."""
        return [case for case in self.cases if is_at(case, coordinates)]

    @property
    def seeds(self) -> dict[str, list[int]]:
        """The realisations that each simulation has, by model; empty for surfaces that are none."""
        seeds = {}
        for name in ("atomistic", "continuum"):
            cases = self.studies[name].cases if name in self.studies else ()
            found = [seed for case in cases if (seed := case.surface.realisation) is not None]
            if found:
                seeds[name] = list(dict.fromkeys(found))
        return seeds

    @property
    def laws(self) -> list[type[TractionLaw]]:
        """Every traction-separation law of the cases."""
        return list(dict.fromkeys(type(case.law) for case in self.cases))

    @property
    def control(self) -> str:
        """What was prescribed: "pressure" or "gap"."""
        return self.study.cases[0].loading.control


def is_at(case: Case, coordinates: Mapping[str, Any]) -> bool:
    """Whether a case has these swept values; a key that it does not sweep tells nothing."""
    return all(same(case.coordinates.get(name, value), value) for name, value in coordinates.items())


def read_inputs(paths: Sequence[Path]) -> Inputs:
    """Open the datasets of at least two models, in any order.

    Raises
    ------
    InputError
        If a file is missing, unreadable or foreign, a model comes twice or alone, or the studies are of different
        contacts.
    """
    files: dict[str, Path] = {}
    contents: dict[str, dict[str, xr.Dataset]] = {}
    studies: dict[str, Study] = {}
    notes: list[str] = []
    for path in paths:
        groups = _open(path)
        kind = groups[""].attrs["model"]
        if kind in files:
            raise InputError(f"{files[kind]} and {path} are both of the {kind} model; give one dataset of each model")
        files[kind], contents[kind] = path, groups
        studies[kind], joined = carried_study(path, groups[""])
        notes += joined
    if len(files) < 2:
        raise InputError("a comparison needs the datasets of at least two models: continuum, atomistic, theory")
    names = [name for name in MODELS if name in studies]
    notes += check_studies(names, files, studies)
    check_height_maps(names, files, {name: str(contents[name][""].attrs.get("height_maps", "")) for name in names})
    contents = _one_spelling({name: contents[name] for name in names})
    found: dict[str, xr.Dataset] = {}
    branches: dict[str, xr.Dataset] = {}
    for groups in contents.values():
        found |= models_in(groups[""])
        branches |= _branches_in(groups)
    models = {name: found[name] for name in MODELS if name in found}
    return Inputs(files, models, branches, studies, tuple(notes), contents)


def models_in(root: xr.Dataset) -> dict[str, xr.Dataset]:
    """The models whose numbers stand in the root of one file, or of its group in the dataset of a comparison."""
    if "theory" not in root.dims:
        return {root.attrs["model"]: root}
    theories = {}
    for name, label in _THEORIES.items():
        if label in root["theory"].values:
            # What does not stand on the theories, such as the constants, is shown once: beside the first.
            own = [v for v in root.data_vars if "theory" in root[v].dims or label == root["theory"].values[0]]
            theories[name] = _without_empty(root[own].sel(theory=label, drop=True))
    return theories


def _branches_in(groups: Mapping[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """The metastable branches of the gap-flow theory."""
    if _METASTABLE not in groups:
        return {}
    both = groups[_METASTABLE].sel(theory=_THEORIES["gap_flow"], drop=True)
    return {
        str(side): _without_empty(both.sel(metastable_branch=side, drop=True))
        for side in both["metastable_branch"].values
    }


def _without_empty(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset without variables that have no value at all, being quantities of other theories."""
    return dataset.drop_vars([name for name, variable in dataset.data_vars.items() if _is_empty(str(name), variable)])


def _is_empty(name: str, variable: xr.DataArray) -> bool:
    empty = variable_of(name).empty if name in VARIABLES else np.nan
    missing = variable.isnull()
    return bool((missing if isinstance(empty, float) else missing | (variable == empty)).all())


def _one_spelling(contents: Mapping[str, dict[str, xr.Dataset]]) -> dict[str, dict[str, xr.Dataset]]:
    """The groups with the swept values of the first file that has them where they differ by roundings."""
    known: dict[str, list[Any]] = {}
    spelt: dict[str, dict[str, xr.Dataset]] = {}
    for kind, groups in contents.items():
        spelt[kind] = {}
        for name, dataset in groups.items():
            for dim in swept_dims(dataset):
                values = known.setdefault(dim, [])
                own = [next((value for value in values if same(value, given)), given) for given in dataset[dim].values]
                values += [value for value in own if value not in values]
                dataset = dataset.assign_coords({dim: (dim, own, dataset[dim].attrs)})
            spelt[kind][name] = dataset
    return spelt


def _open(path: Path) -> dict[str, xr.Dataset]:
    """The groups of a file by name, "" for the root, without the fields."""
    if not path.is_file():
        raise InputError(f"{path}: {'is a folder' if path.is_dir() else 'does not exist'}; expected a dataset (NetCDF)")
    try:
        with xr.open_datatree(path, engine="netcdf4", decode_timedelta=False) as tree:
            attrs = tree.attrs
            foreign = "schema_version" not in attrs or attrs.get("model") not in _ROOTS
            nodes = {node.path.strip("/"): node for node in tree.subtree}
            groups = {} if foreign else {name: _in_memory(nodes[name]) for name in _GROUPS if name in nodes}
    except (OSError, RuntimeError, ValueError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"{path}: cannot be read as NetCDF, perhaps cut short ({reason})") from None
    if foreign:
        raise InputError(f"{path}: is no dataset of bem-adhesion, md-reference or persson-theory")
    if str(attrs["schema_version"]).split(".")[0] != SCHEMA_VERSION.split(".")[0]:
        raise InputError(
            f"{path}: has schema version {attrs['schema_version']}, this program reads {SCHEMA_VERSION}; run its study "
            "again"
        )
    return groups


def _in_memory(node: xr.DataTree) -> xr.Dataset:
    """The group without its fields, and without the plane where only they stood on it."""
    dataset = node.to_dataset().drop_vars(_FIELDS, errors="ignore")
    used = {dim for variable in dataset.data_vars.values() for dim in variable.dims}
    unused = [dim for dim in ("y", "x") if dim in dataset.dims and dim not in used]
    return dataset.drop_dims(unused).load()


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
        chosen = positions({dim: dataset[dim].values for dim in swept_dims(dataset)}, selection)
        return dataset[name].isel(chosen).isel(step=step).values
