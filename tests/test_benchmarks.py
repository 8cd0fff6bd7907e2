"""Mutants are of modules and tests that exist; datasets of two versions are compared bit for bit."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from research import same_numbers
from scripts import mutants


def test_mutants_are_of_modules_and_tests_that_exist():
    for package, folders in mutants.PACKAGES.items():
        assert all(Path(folder).is_dir() for folder in [package, *folders.split()])
    for module, names in mutants.TESTS.items():
        (package,) = (package for package in mutants.PACKAGES if module.startswith(f"{package}/"))
        assert Path(module).is_file(), module
        assert len(mutants.tests_of(package, module, Path())) >= len(names.split()), module
    assert mutants.tests_of("theory", "theory/study/model.py", Path()) == ["tests/theory/test_run.py"]


@pytest.mark.parametrize(
    ("node", "name", "change", "status", "words"),
    [
        ("/", "wall_time", 2.0, 0, "2 the same bits"),
        ("/", "gap", 1 + 1e-13, 0, "1 the same bits, 1 within 1e-12"),
        ("/trajectory", "force", 1 + 1e-9, 1, "one: trajectory/force: 1.0e-09\n1 different, 1 the same bits"),
        ("/trajectory", "force", np.nan, 1, "one: trajectory/force: inf\n1 different, 1 the same bits"),
    ],
)
def test_what_differs_is_named(tmp_path, capsys, node, name, change, status, words):
    tree = xr.DataTree.from_dict({
        "/": xr.Dataset({"gap": ("x", [1.0, np.nan, 3.0]), "wall_time": ("x", [1.0, 2.0, 3.0])}),
        "/trajectory": xr.Dataset({"force": ("x", [1e-9, 2e-9, -4e-9])}),
    })  # fmt: skip
    for folder in ("before", "after"):
        (tmp_path / folder).mkdir()
        tree.to_netcdf(tmp_path / folder / "one.nc")
        tree[node][name] = tree[node][name] * change
    assert same_numbers.main(["compare", str(tmp_path / "before"), str(tmp_path / "after")]) == status
    assert capsys.readouterr().out.strip() == words
