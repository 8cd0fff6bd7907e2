"""A small study of the toy model, its command, and when two of its datasets are the same."""

import copy
import tomllib
from pathlib import Path

import xarray as xr

from contact_study.campaign.store.case_file import CaseFile
from tests.campaign.toy_model import TOY
from tests.commands import main

STUDY = """
[study]
title = "toy"
[surface]
kind = "self_affine"
size = "100 angstrom"
shape = [16, 16]
rms_height = "1 angstrom"
cutoff_mode = 4
[material]
youngs_modulus = "77.2 GPa"
poissons_ratio = 0.42
lattice_constant = "2.5 angstrom"
[interaction]
work_of_adhesion = "0.69 J/m^2"
length = "3.28 angstrom"
[loading]
path = ["0.1 GPa", "1 GPa", "2 GPa"]
[output]
fields = true
[sweep]
"interaction.well_depth_ratio" = [1, 4]
"surface.seed" = [1, 2]
[[override]]
when = { "interaction.well_depth_ratio" = 4 }
"loading.path" = ["0.1 GPa", "-0.5 GPa", "1 GPa", "2 GPa"]
"""


TABLE = tomllib.loads(STUDY)
# Bins that follow from the study widen with it.
OUTPUT = {"fields": True, "pressure_range": ["-40 GPa", "100 GPa"]}
BASE = {**TABLE, "sweep": {"interaction.well_depth_ratio": [1, 4]}, "output": OUTPUT}
del BASE["override"]
LONGER_PATH = {"path": ["0.1 GPa", "1 GPa", "2 GPa", "3 GPa"]}


def changed(**sections):
    table = copy.deepcopy(BASE)
    for section, keys in sections.items():
        table.setdefault(section, {}).update(keys)
        table[section] = {name: value for name, value in table[section].items() if value is not None}
    return table


def run(*arguments):
    return main(TOY, [str(argument) for argument in arguments])


def steps_on_disk(parts: Path) -> int:
    return sum(CaseFile(path).finished(99, last_state=False) for path in parts.glob("*.case"))


def names(folder: Path):
    return sorted(path.name for path in folder.iterdir() if path.name != "study.toml")


def assert_same(one: Path, two: Path):
    with xr.open_datatree(one) as left, xr.open_datatree(two) as right:
        assert left.attrs["study_toml"] == right.attrs["study_toml"]
        assert {node.path for node in left.subtree} == {node.path for node in right.subtree} == {"/", "/metastable"}
        for node in left.subtree:
            datasets = [each[node.path].to_dataset().drop_vars("wall_time", errors="ignore") for each in (left, right)]
            xr.testing.assert_identical(*(dataset.drop_attrs(deep=False) for dataset in datasets))


LONGER = changed(loading=LONGER_PATH)
MORE = changed(sweep={"interaction.well_depth_ratio": [1, 4, 2]})
WHOLE = changed(sweep={"interaction.well_depth_ratio": [1, 4], "surface.seed": [1, 2, 3]})
