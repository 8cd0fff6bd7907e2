"""The paper's study is run as it should be, and its tables say what its datasets hold."""

import itertools
import os
import re
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from contact_study.start import contact_compare as compare
from contact_study.study.study import read_study
from research import branches, continuum_against_atoms, two_starts
from scripts import reproduce_yang2008, result_table
from tests.report.synthetic import H_RMS, area, gap, write_all


@pytest.mark.parametrize(
    ("options", "surfaces", "trajectories"),
    [
        ([], 12, "60"),
        (["--preset", "quick"], 4, ""),
        (["--surfaces", "3", "--trajectories", "9", "--predictor"], 3, "9"),
        (["--surfaces", "0", "--trajectories", "0"], 0, ""),
    ],
)
def test_the_paper_s_commands(options, surfaces, trajectories, tmp_path, monkeypatch, capsys):
    commands = []
    monkeypatch.setattr(reproduce_yang2008, "run", lambda lanes: commands.extend(itertools.chain(*lanes)) or 0)
    monkeypatch.setattr("sys.argv", ["reproduce_yang2008", "--output", str(tmp_path), *options])
    assert reproduce_yang2008.main() == 0
    commands = [[str(part) for part in command] for command in commands]
    given = {Path(command[command.index("-o") + 1]).stem: command for command in commands}
    predictor = ["--predictor", str(tmp_path / "bem.nc")] if "--predictor" in options else []
    assert given["md"][4:] == [*predictor, "--resume"]
    assert commands[0] == given["bem" if predictor else "md"], "the gap before those who start from it"
    assert ("bem_seeds" in given) == ("--scatter" in given["comparison"]) == (surfaces > 0)
    if surfaces:
        seeds = given["bem_seeds"]
        assert seeds[seeds.index("--surface.seed") + 1] == ",".join(str(n) for n in range(1, surfaces + 1))
        assert seeds[1] == given["md"][1]
        assert given["comparison"][-1] == seeds[3] == str(tmp_path / "bem_seeds.nc")
    assert ("md_0K" in given) == ("md_300K" in given) == ("300K" in capsys.readouterr().out) == bool(trajectories)
    if trajectories:
        cold, warm = given["md_0K"], given["md_300K"]
        # The same question but for the temperature: all that stands in the cold command stands in the warm one.
        assert set(cold) - set(warm) == {str(tmp_path / "md_0K.nc")}
        keys = [word for word in warm[4:] if word != "--resume"]
        table = {
            key[2:]: int(value) if value.isdigit() else value for key, value in zip(*[iter(keys)] * 2, strict=True)
        }
        case = read_study(warm[1], table | {"output.fields": False}).cases[0]
        assert (case.lattice.atoms, case.sampling.trajectories) == ((200, 200), int(trajectories))
        assert (case.atomistic.method, case.atomistic.temperature) == ("sampling", 300.0)


@pytest.mark.parametrize("option", ["--trajectories", "--surfaces"])
def test_one_state_or_surface_has_no_scatter(option, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["reproduce_yang2008", option, "1"])
    with pytest.raises(SystemExit):
        reproduce_yang2008.main()
    assert "takes two" in capsys.readouterr().err


def test_commands_run_beside_each_other_and_the_first_failure_stops_all(tmp_path, monkeypatch):
    texts = {"quick": 'nice > "$1"', "slow": "exec sleep 60", "odd": "exit 2", "wrong": "exit 3"}
    for name, text in texts.items():
        (tmp_path / name).write_text(f"#!/bin/sh\n{text}\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setattr("sys.executable", str(tmp_path / "python"))
    first, second = tmp_path / "first", tmp_path / "second"
    assert reproduce_yang2008.run([[["quick", first]], [["odd"], ["quick", second]]]) == 2
    # The tests themselves may run at a low priority.
    assert (int(first.read_text()), int(second.read_text())) == (os.nice(0), 19), "behind the first lane"
    began = time.monotonic()
    assert reproduce_yang2008.run([[["slow"], ["quick", tmp_path / "never"]], [["wrong"], ["slow"]]]) == 3
    assert time.monotonic() - began < 30  # half of the sleep that is cut short
    assert not (tmp_path / "never").exists()


def test_result_table(tmp_path, capsys):
    comparison = str(tmp_path / "comparison.nc")
    assert compare([*(str(path) for path in write_all(tmp_path)), "-o", comparison]) == 0
    capsys.readouterr()
    assert result_table.main([comparison, "--pressures", "0.1 GPa", "5872.5 MPa"]) == 0
    head, _, *rows = capsys.readouterr().out.splitlines()
    assert head == "| | p (GPa) | atoms | continuum | Persson's theory | gap-flow theory |"
    for found, (ratio, pressure) in zip(rows, itertools.product((1, 8), (0.1, 5.8725)), strict=False):
        cells = [
            f"{area(ratio, 1e9 * pressure, model=model):.4f}; "
            f"{gap(ratio, 1e9 * pressure, model=model) / H_RMS:.3f}".replace("-", "−")
            for model in ("atomistic", "continuum", "persson", "gap_flow")
        ]
        assert found.endswith(f"| {pressure:g} | {' | '.join(cells)} |")
    assert [row[:2] for row in rows[4:]] == ["", *["- "] * 4]


def test_ranges_of_the_attribution():
    models, dims = list(continuum_against_atoms.MODELS), ("well_depth_ratio", "pressure", "model")
    area = [[0.2, 0.2, 0.18, 0.18, 0.18, 0.18, 0.18, 0.19], [0.5, 0.5, 0.4, 0.4, 0.4, 0.4, 0.4, 0.45]]
    gap = [[1.0, 1.0, 1.5, 1.5, 1.5, 1.5, 1.5, 1.2], [1.0, 1.0, 1.1, 1.1, 1.1, 1.1, 1.1, 1.3]]
    data = {"relative_contact_area": np.array([area]), "mean_gap": np.array([gap]) * 1e-10}
    data |= {f"{name}_increment": np.diff(value, prepend=value[..., :1]) for name, value in data.items()}
    printed = continuum_against_atoms.ranges(
        xr.Dataset({name: (dims, value) for name, value in data.items()}, {"model": models})
    )
    # 0.01 of 0.2 and 0.05 of 0.5: over the continuum's area, not the one before.
    for words, cells in (
        (continuum_against_atoms.MODELS["measured_adhesion"], "-20.00 to -10.00 % | +0.100 to +0.500 |"),
        (continuum_against_atoms.MODELS["atoms"], "+5.00 to +10.00 % | -0.300 to +0.200 |"),
        ("**all together**", "-10.00 to -5.00 % | +0.200 to +0.300 |"),
    ):
        assert f"| {words} | {cells}" in printed


def test_conclusion_of_two_starts():
    states = [
        {"area_own": 0.2, "area_predicted": 0.2 + more, "changed_atoms": abs(more), "energy_difference": -more}
        for more in (0, 0.01, -0.01)
    ]
    said = two_starts.conclusion(states)
    assert "at 2 of 3 points, by -5.00 to +5.00 % of the area; at 1 of them" in said


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_branches_on_the_way_back_hold_more_contact(tmp_path):
    path = tmp_path / "branches.csv"
    options = ["--models", "continuum", "--atoms", "140", "--ratios", "8", "--pressures", "0.1 GPa", "1 GPa", "5 GPa"]
    assert branches.main([*options, "--ways", "steps", "after 3 GPa", "-o", str(path)]) == 0
    table = pd.read_csv(path)
    assert table.converged.all()
    loaded, back = (table[table.way == way].set_index("pressure_GPa").area for way in ("steps", "after 3 GPa"))
    assert list(loaded.index) == [0.1, 1.0, 5.0]
    assert list(back.index) == [0.1, 1.0]  # from 3 GPa there is no way back to 5
    # Some of the patches that have snapped in by 3 GPa hold: 0.022 and 0.008 of the cell, a state's error is a point.
    assert back[0.1] > loaded[0.1] + 0.01
    assert back[1.0] > loaded[1.0] + 0.004


def test_branches_compares_every_way_with_steps(tmp_path, capsys):
    path = tmp_path / "branches.csv"
    options = ["--atoms", "28", "--ratios", "2", "--pressures", "0.5 GPa", "1 GPa", "-o", str(path)]
    assert branches.main([*options, "--ways", "steps", "flow 1e-2"]) == 0
    first = pd.read_csv(path)
    assert len(first) == 2 * 2 * 2
    assert first.converged.all()
    # What is there is not run again, and another way is added to it.
    assert branches.main([*options, "--models", "continuum", "--ways", "steps", "small steps"]) == 0
    table = pd.read_csv(path)
    pd.testing.assert_frame_equal(table[table.way != "small steps"].reset_index(drop=True), first, check_dtype=False)
    assert len(table) == 2 * 2 * 2 + 2
    # One state moved by hand shows, with its place.
    wrong = (table.way == "flow 1e-2") & (table.model == "atomistic") & (table.pressure_GPa == 1)
    table.loc[wrong, "area"] -= 0.0123
    table.to_csv(path, index=False)
    capsys.readouterr()
    assert branches.main(["--from", str(path), "--pressures", "1 GPa"]) == 0
    _, _, atoms, continuum, _, small, flow = capsys.readouterr().out.splitlines()
    area = table[(table.way == "steps") & (table.pressure_GPa == 1)].set_index("model").area
    assert re.search(rf"\| 2 \| 1 \| {area['atomistic']:.4f}; .*\|  \| −0.0123;", atoms)
    assert re.search(rf"\| 2 \| 1 \| {area['continuum']:.4f}; .*\| = \| = \|", continuum)
    assert small.endswith("the same in 2 of 2 states.")
    assert "the same in 3 of 4 states; the area differs by −0.0123 at most (atoms, 28²" in flow
    table.loc[wrong, "converged"] = 0
    assert "(moving) |" in list(branches.lines(table, [1.0]))[1]
