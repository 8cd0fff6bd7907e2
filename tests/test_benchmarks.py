"""The benchmarks print what they measure; datasets of two versions are compared bit for bit."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from research import same_numbers
from scripts import benchmark_adhesive, benchmark_workers, mutants


def test_benchmark_of_the_adhesive_solver(capsys):
    assert benchmark_adhesive.main(["--points", "32", "--surfaces", "1", "--ratios", "1", "--anew"]) == 0
    cells = capsys.readouterr().out.splitlines()[2].strip("| ").split(" | ")
    assert cells[:3] == ["32² (1)", "1 ε₀", "6"]
    assert all(6 < int(cell) < 2000 for cell in cells[3:5])


def test_what_the_step_from_the_state_before_costs_more():
    first = benchmark_adhesive.BesideAnew(np.array([20.0, 30.0, 50]), np.array([10.0, 40, 30]), np.array([0, 1, 0]) > 0)
    second = benchmark_adhesive.BesideAnew(np.array([35.0, 5.0]), np.array([5.0, 5.0]), np.array([True, False]))
    found = benchmark_adhesive.line_beside_anew(64, 2, 4.0, [first, second])
    # Dearer by 10, 20 and 30; one of five is as dear, one cheaper.
    assert found == "| 64² (1–2) | 4 ε₀ | 5 | 70 | 45 | 3 | 20, 30 | 2 |"
    alike = benchmark_adhesive.line_beside_anew(64, 1, 1.0, [replace(second, anew=second.pairs)])
    assert alike == "| 64² (1) | 1 ε₀ | 2 | 40 | 40 | 0 | – | 1 |"


def test_two_workers_against_one(monkeypatch, capsys):
    """A command of 8 s of work, the first run of each kind slower; two workers share it and spend a second more."""
    clock, runs = {"wall": 0.0, "processor": 0.0}, []

    def run(command, **_):
        workers = int(command[command.index("--workers") + 1])
        clock["wall"] += 8 / workers + (100 if len(runs) < 2 else 0)
        clock["processor"] += 8 if workers == 1 else 9
        runs.append(command)

    monkeypatch.setattr(benchmark_workers.subprocess, "run", run)
    monkeypatch.setattr(benchmark_workers.time, "perf_counter", lambda: clock["wall"])
    monkeypatch.setattr(benchmark_workers, "children_time", lambda: clock["processor"])
    assert benchmark_workers.main(["--repeats", "2", "study.toml", "--surface.seed", "1,2"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "| continuum | 8 s | 2.00 | 1.12 |"
    assert len(runs) == 6
    assert all("1,2" in command and "--solver.threads" in command for command in runs)


def test_mutants_are_of_modules_and_tests_that_exist():
    for package, folders in mutants.PACKAGES.items():
        assert all(Path(folder).is_dir() for folder in [package, *folders.split()])
    for module, names in mutants.TESTS.items():
        (package,) = (package for package in mutants.PACKAGES if module.startswith(f"{package}/"))
        assert Path(module).is_file(), module
        assert len(mutants.tests_of(package, module, Path())) >= len(names.split()), module
    assert mutants.tests_of("theory", "theory/study/model.py", Path()) == ["tests/theory/test_run.py"]


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
        ("/", "wall_time", 2.0, 0, "2 the same bits"),
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
    monkeypatch.setattr(same_numbers.contact_study, "run", lambda _, model, output: ran.append(model) or output.touch())
    for _ in range(2):
        assert same_numbers.main(["freeze", str(tmp_path), "--only", "atoms_s", "sphere"]) == 0
    assert ran == ["continuum", "atomistic"]
