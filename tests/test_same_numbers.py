"""Datasets of two versions are compared bit for bit; start-up times are those of processes."""

import numpy as np
import pytest
import xarray as xr

from research import same_numbers
from scripts import benchmark_startup


@pytest.fixture
def folders(tmp_path):
    """Two folders with one dataset that has a group, the same in both."""
    tree = xr.DataTree.from_dict({
        "/": xr.Dataset({"gap": ("x", [1.0, np.nan, 3.0]), "wall_time": ("x", [1.0, 2.0, 3.0])}),
        "/trajectory": xr.Dataset({"force": ("x", [1e-9, 2e-9, -4e-9])}),
        "/restart": xr.Dataset({"state": ("y", [1.0])}),
    })  # fmt: skip
    for name in ("before", "after"):
        (tmp_path / name).mkdir()
        tree.to_netcdf(tmp_path / name / "one.nc")
    return tmp_path / "before", tmp_path / "after", tree


@pytest.mark.parametrize(
    ("node", "name", "change", "status", "words"),
    [
        ("/", "gap", 1.0, 0, "2 the same bits"),
        ("/", "wall_time", 2.0, 0, "2 the same bits"),
        ("/restart", "state", 2.0, 0, "2 the same bits"),
        ("/", "gap", 1 + 1e-13, 0, "1 the same bits, 1 within 1e-12"),
        ("/trajectory", "force", 1 + 1e-9, 1, "one: trajectory/force: 1.0e-09\n1 different, 1 the same bits"),
        ("/trajectory", "force", np.nan, 1, "one: trajectory/force: inf\n1 different, 1 the same bits"),
    ],
)
def test_what_differs_is_named(folders, capsys, node, name, change, status, words):
    before, after, tree = folders
    tree[node][name] = tree[node][name] * change
    tree.to_netcdf(after / "one.nc")
    assert same_numbers.main(["compare", str(before), str(after)]) == status
    assert capsys.readouterr().out.strip() == words


def test_what_is_missing_is_named(folders, capsys):
    before, after, tree = folders
    tree.dataset = tree.to_dataset().rename(gap="area")
    tree.to_netcdf(after / "one.nc")
    (before / "two.nc").touch()
    assert same_numbers.main(["compare", str(before), str(after)]) == 1
    assert "one: area: only after\none: gap: only before\ntwo.nc: not in" in capsys.readouterr().out


def test_studies_are_frozen_once(tmp_path, monkeypatch):
    ran = []
    monkeypatch.setattr(
        same_numbers.contact_study, "run", lambda table, model, output: ran.append(model) or output.touch()
    )
    for _ in range(2):
        assert same_numbers.main(["freeze", str(tmp_path), "--only", "atoms_s", "sphere"]) == 0
    assert ran == ["continuum", "atomistic"]


def test_start_up_is_timed(capsys):
    assert benchmark_startup.main(["--repeat", "1", "--only", "contact-merge"]) == 0
    (row,) = capsys.readouterr().out.splitlines()[2:]
    assert 0.02 < float(row.split(" | ")[1].strip(" |")) < 60
