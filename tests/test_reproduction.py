"""The paper's study is run as it should be, and branches are compared state by state."""

import itertools
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
        (["--surfaces", "0", "--trajectories", "9", "--predictor"], 0, "9"),
    ],
)
def test_the_paper_s_commands(options, surfaces, trajectories, tmp_path, monkeypatch):
    commands = []
    monkeypatch.setattr(reproduce_yang2008, "run", lambda lanes: commands.extend(itertools.chain(*lanes)) or 0)
    monkeypatch.setattr("sys.argv", ["reproduce_yang2008", "--output", str(tmp_path), *options])
    assert reproduce_yang2008.main() == 0
    commands = [[str(part) for part in command] for command in commands]
    given = {Path(command[command.index("-o") + 1]).stem: command for command in commands}
    assert commands[0] == given["bem" if "--predictor" in options else "md"], "the gap before those who start from it"
    assert ("bem_seeds" in given) == ("--scatter" in given["comparison"]) == (surfaces > 0)
    if surfaces:
        assert ",".join(str(n) for n in range(1, surfaces + 1)) in given["bem_seeds"]
    assert ("md_0K" in given) == ("md_300K" in given) == bool(trajectories)
    if trajectories:
        cold, warm = given["md_0K"], given["md_300K"]
        # The same question but for the temperature: all that stands in the cold command stands in the warm one.
        assert set(cold) - set(warm) == {str(tmp_path / "md_0K.nc")}
        assert warm[warm.index("--sampling.trajectories") + 1] == trajectories


@pytest.mark.validation
@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_branches_compares_every_way_with_steps(tmp_path, capsys):
    path = tmp_path / "branches.csv"
    options = ["--atoms", "28", "--ratios", "2", "--pressures", "0.5 GPa", "1 GPa", "-o", str(path)]
    assert branches.main([*options, "--ways", "steps", "flow 1e-2"]) == 0
    first = pd.read_csv(path)
    assert first.converged.tolist() == 8 * [True]
    # What is there is not run again, and another way is added to it.
    assert branches.main([*options, "--models", "continuum", "--ways", "steps", "after 3 GPa"]) == 0
    table = pd.read_csv(path)
    back = table.way == "after 3 GPa"
    pd.testing.assert_frame_equal(table[~back].reset_index(drop=True), first, check_dtype=False)
    assert list(table[back].pressure_GPa) == [0.5, 1.0]
    # One state moved by hand shows.
    wrong = (table.way == "flow 1e-2") & (table.model == "atomistic") & (table.pressure_GPa == 1)
    table.loc[wrong, "area"] -= 0.0123
    said = "".join(branches.lines(table, [1.0]))
    assert "the same in 3 of 4 states; the area differs by −0.0123 at most (atoms, 28²" in said
