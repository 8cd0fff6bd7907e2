"""The benchmarks print what they measure."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import contact_study
from contact_study.study.case import realise
from contact_study.study.study import read_study
from scripts import (
    benchmark_adhesive,
    benchmark_atoms,
    benchmark_grids,
    benchmark_storage,
    benchmark_workers,
    mutants,
)


def test_benchmark_of_the_adhesive_solver(capsys):
    assert benchmark_adhesive.main(["--points", "32", "40", "--surfaces", "2", "1", "--ratios", "1", "--times"]) == 0
    _, _, *rows = capsys.readouterr().out.splitlines()
    assert [row.split(" | ")[0] for row in rows] == ["| 32² (1–2)", "| 40² (1)"]
    for row in rows:
        medians, worst, share = (re.findall(r"\d+", cell) for cell in row.split(" | ")[1:4])
        assert len(medians) == 7
        assert max(map(int, medians)) <= int(worst[0])
        assert 0 < int(share[0]) < 100
    assert benchmark_adhesive.main(["--points", "32", "--surfaces", "1", "--ratios", "1", "--anew"]) == 0
    cells = capsys.readouterr().out.splitlines()[2].strip("| ").split(" | ")
    assert cells[:3] == ["32² (1)", "1 ε₀", "6"]
    assert all(6 < int(cell) < 2000 for cell in cells[3:5])


def test_worst_and_median_of_the_benchmark():
    costs = [
        benchmark_adhesive.PathCost(np.array(pairs), converged, 2.0, 1.0)
        for pairs, converged in (([10, 20], True), ([30, 90], False), ([20, 40], True))
    ]
    found = benchmark_adhesive.line(64, 3, {4.0: costs}, times=True)
    assert found == "| 64² (1–3) | 20 40 | 90 (not converged) | 50 % | 1.000 |"


def test_what_the_step_from_the_state_before_costs_more():
    first = benchmark_adhesive.BesideAnew(np.array([20.0, 30.0, 50]), np.array([10.0, 40, 30]), np.array([0, 1, 0]) > 0)
    second = benchmark_adhesive.BesideAnew(np.array([35.0, 5.0]), np.array([5.0, 5.0]), np.array([True, False]))
    found = benchmark_adhesive.line_beside_anew(64, 2, 4.0, [first, second])
    # Dearer by 10, 20 and 30; one of five is as dear, one cheaper.
    assert found == "| 64² (1–2) | 4 ε₀ | 5 | 70 | 45 | 3 | 20, 30 | 2 |"
    alike = benchmark_adhesive.line_beside_anew(64, 1, 1.0, [replace(second, anew=second.pairs)])
    assert alike == "| 64² (1) | 1 ε₀ | 2 | 40 | 40 | 0 | – | 1 |"


def test_benchmark_of_the_atoms(capsys):
    options = ["--pressures", "1 GPa", "2 GPa", "--ratios", "1"]
    assert benchmark_atoms.main(["--atoms", "40", "48", *options]) == 0
    _, _, *rows = capsys.readouterr().out.splitlines()
    assert [row.split(" | ")[0] for row in rows] == ["| 40²", "| 48²"]
    for row in rows:
        evaluations, pairs = (np.array(cell.split(), dtype=float) for cell in row.strip("| ").split(" | ")[2:])
        assert evaluations.shape == pairs.shape == (2,)
        # A step has an evaluation or more, each but the first from a linear solve and S u.
        assert np.all(pairs > evaluations)
    assert benchmark_atoms.main(["--atoms", "40", "--times", *options]) == 0
    *_, evaluation, pair, _ = re.findall(r"[\d.]+", capsys.readouterr().out.splitlines()[2])
    assert min(float(evaluation), float(pair)) > 0


def test_the_atoms_of_the_benchmark_keep_the_slopes():
    small, large = (realise(benchmark_atoms.case_of(Path("data/yang2008.toml"), n, 4.0)) for n in (40, 80))
    assert large.rms_slope == pytest.approx(small.rms_slope, rel=1e-9)
    assert large.rms_height == pytest.approx(2 * small.rms_height, rel=1e-9)


def test_benchmark_of_the_storage(capsys, monkeypatch):
    monkeypatch.setattr(benchmark_storage, "RATIOS", (1, 4))
    monkeypatch.setattr(benchmark_storage, "PRESSURES", np.array([1e8, 1e9]))
    assert benchmark_storage.main(["data/yang2008.toml", "--flows", "none"]) == 0
    ran, written, read = capsys.readouterr().out.splitlines()
    assert ran.startswith("persson-theory, 4 steps, 1 processes: ")
    for line in (written, read):
        milliseconds, share = re.findall(r"([\d.]+) (?:ms|%)", line)
        assert float(milliseconds) > 0
        assert 0 <= float(share) < 100  # of a slow run writing may round to nothing


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


@pytest.mark.filterwarnings("ignore:.*process zone")
def test_areas_over_grids_are_those_of_datasets(tmp_path):
    np.save(tmp_path / "heights.npy", realise(benchmark_grids.case_of("adhesion, smooth", 64)).sampled)
    row = benchmark_grids.cost("adhesion, smooth", 64, tmp_path / "heights.npy")
    keys = {"interaction.well_depth_ratio": 1, "surface.shape": [64, 64], "loading.path": ["0.5 GPa", "1 GPa"]}
    table = read_study("data/yang2008.toml", keys | {"loading.unload": False, "output.fields": False}).table
    table.pop("override", None)
    assert row["area"] == contact_study.run(table).relative_contact_area.squeeze()[-1]


def test_mutants_are_of_modules_and_tests_that_exist():
    for package, folders in mutants.PACKAGES.items():
        assert all(Path(folder).is_dir() for folder in [package, *folders.split()])
    for module, names in mutants.TESTS.items():
        (package,) = (package for package in mutants.PACKAGES if module.startswith(f"{package}/"))
        assert Path(module).is_file(), module
        assert len(mutants.tests_of(package, module, Path())) >= len(names.split()), module
    assert mutants.tests_of("theory", "theory/study/model.py", Path()) == ["tests/theory/test_run.py"]
