"""One dataset's file: its groups without the fields, the models in it, and one field at a time.

Fields over the lateral plane stay in the files, which :func:`field_at` reads; all else is in memory.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.store.files import engine_of, readable, require_dataset
from contact_study.inputs.errors import InputError
from contact_study.report.models import file_kinds, known, of_file
from contact_study.report.read.load_steps import positions, swept_dims
from contact_study.results.schema import BY_ATOM, LABELLED_GROUPS, LABELS, SCHEMA_VERSION, SITES, VARIABLES, variable_of

_FIELDS = ("gap", "pressure", *BY_ATOM)
_THEORY, _SIDE = LABELS
_METASTABLE = LABELLED_GROUPS[2]
# Groups of a file that are read, "" for the root; a file may hold others, such as states to go on from.
_GROUPS = ("", _METASTABLE)


def open_groups(path: Path) -> dict[str, xr.Dataset]:
    """The groups of a file by name, "" for the root, without the fields."""
    require_dataset(path)
    with readable(path), xr.open_datatree(path, engine=engine_of(path), decode_timedelta=False) as tree:
        require_own(path, tree.attrs)
        nodes = {node.path.strip("/"): node for node in tree.subtree}
        return {name: _in_memory(nodes[name]) for name in _GROUPS if name in nodes}


def require_own(path: Path, attrs: Mapping[str, Any]) -> None:
    """Raise InputError unless the attributes are those of a dataset that this version reads."""
    if "schema_version" not in attrs or attrs.get("model") not in file_kinds():
        raise InputError(f"{path}: is no dataset of bem-adhesion, md-reference or persson-theory")
    if str(attrs["schema_version"]).split(".")[0] != SCHEMA_VERSION.split(".")[0]:
        raise InputError(
            f"{path}: has schema version {attrs['schema_version']}, this program reads {SCHEMA_VERSION}; run its study "
            "again"
        )


def models_in(root: xr.Dataset, file: str = "") -> dict[str, xr.Dataset]:
    """The models in the root group of one file that have an entry."""
    theories = _theories_in(root)
    if not theories:
        return {of_file(root.attrs["model"], file): root}
    found = {}
    for label in theories:
        # Quantities without the dimension of the theories, such as constants, are shown once: beside the first.
        own = [name for name in root.data_vars if _THEORY in root[name].dims or label == theories[0]]
        if known(label):
            found[of_file(label, file)] = _without_empty(_at(root[own], label).drop_vars(_THEORY))
    return found


def branches_in(groups: Mapping[str, xr.Dataset], file: str = "") -> dict[str, dict[str, xr.Dataset]]:
    """The metastable branches of each theory that has some, by their names."""
    if _METASTABLE not in groups:
        return {}
    group, found = groups[_METASTABLE], {}
    for label in _theories_in(group):
        sides = {
            str(side): _without_empty(_at(group, label).sel({_SIDE: side}).drop_vars([_THEORY, _SIDE]))
            for side in group[_SIDE].values
        }
        if known(label) and all(sides[side].data_vars for side in sides):
            found[of_file(label, file)] = sides
    return found


def unknown_theories(root: xr.Dataset) -> Iterator[str]:
    """Theories of a file that have no entry among the models shown."""
    return (label for label in _theories_in(root) if not known(label))


def _theories_in(root: xr.Dataset) -> list[str]:
    """Labels on the dimension of the theories, or the one that was chosen from it."""
    return [str(label) for label in np.atleast_1d(root[_THEORY].values)] if _THEORY in root.coords else []


def _at(root: xr.Dataset, label: str) -> xr.Dataset:
    return root.sel({_THEORY: label}) if _THEORY in root.dims else root


def _without_empty(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset without variables that have no value at all, being quantities of other theories."""
    return dataset.drop_vars([name for name, variable in dataset.data_vars.items() if _is_empty(str(name), variable)])


def _is_empty(name: str, variable: xr.DataArray) -> bool:
    empty = variable_of(name).empty if name in VARIABLES else np.nan
    missing = variable.isnull()
    return bool((missing if isinstance(empty, float) else missing | (variable == empty)).all())


def _in_memory(node: xr.DataTree) -> xr.Dataset:
    """The group without its fields, and without the plane where only they stood on it."""
    dataset = node.to_dataset().drop_vars(_FIELDS, errors="ignore")
    used = {dim for variable in dataset.data_vars.values() for dim in variable.dims}
    unused = [dim for dim in ("y", "x", *SITES, "node") if dim in dataset.dims and dim not in used]
    return dataset.drop_dims(unused).load()


def field_at(path: Path, name: str, selection: Mapping[str, Any], step: int) -> np.ndarray | None:
    """One field of a file, or None where the file does not keep it."""
    with readable(path):
        dataset = xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False)
    with dataset:
        if name not in dataset:
            return None
        chosen = positions({dim: dataset[dim].values for dim in swept_dims(dataset)}, selection)
        with readable(path):
            return dataset[name].isel({**chosen, "step": step}, missing_dims="ignore").values
