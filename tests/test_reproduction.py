"""The paper's study is run as it should be, and branches are compared state by state."""

import itertools
import os
import re
import time
from pathlib import Path

import pandas as pd
import pytest

from research import branches
from scripts import reproduce_yang2008


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
        assert given["comparison"][-1] == seeds[3] == str(tmp_path / "bem_seeds.nc")
    assert ("md_0K" in given) == ("md_300K" in given) == ("300K" in capsys.readouterr().out) == bool(trajectories)
    if trajectories:
        cold, warm = given["md_0K"], given["md_300K"]
        # The same question but for the temperature: all that stands in the cold command stands in the warm one.
        assert set(cold) - set(warm) == {str(tmp_path / "md_0K.nc")}
        assert warm[warm.index("--sampling.trajectories") + 1] == trajectories


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


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_branches_compares_every_way_with_steps(tmp_path, capsys):
    path = tmp_path / "branches.csv"
    options = ["--atoms", "28", "--ratios", "2", "--pressures", "0.5 GPa", "1 GPa", "-o", str(path)]
    assert branches.main([*options, "--ways", "steps", "flow 1e-2"]) == 0
    first = pd.read_csv(path)
    assert len(first) == 2 * 2 * 2
    assert first.converged.all()
    # What is there is not run again, and another way is added to it.
    assert branches.main([*options, "--models", "continuum", "--ways", "steps", "after 3 GPa"]) == 0
    table = pd.read_csv(path)
    back = table.way == "after 3 GPa"
    pd.testing.assert_frame_equal(table[~back].reset_index(drop=True), first, check_dtype=False)
    assert list(table[back].pressure_GPa) == [0.5, 1.0]
    # One state moved by hand shows, with its place.
    wrong = (table.way == "flow 1e-2") & (table.model == "atomistic") & (table.pressure_GPa == 1)
    table.loc[wrong, "area"] -= 0.0123
    table.to_csv(path, index=False)
    capsys.readouterr()
    assert branches.main(["--from", str(path), "--pressures", "1 GPa"]) == 0
    said = capsys.readouterr().out
    area = table[(table.way == "steps") & (table.pressure_GPa == 1)].set_index("model").area
    assert re.search(rf"\| 2 \| 1 \| {area['atomistic']:.4f}; .*\| −0.0123;", said)
    assert re.search(rf"\| 2 \| 1 \| {area['continuum']:.4f}; .*\| =", said)
    assert "the same in 3 of 4 states; the area differs by −0.0123 at most (atoms, 28²" in said
    table.loc[wrong, "converged"] = 0
    assert "(moving) |" in "".join(branches.lines(table, [1.0]))
