"""The paper's study is run as it should be, and its tables say what its datasets hold."""

import os
import time

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from contact_study.start import contact_compare as compare
from contact_study.study.study import read_study
from research import branches, continuum_against_atoms, two_starts
from scripts import reproduce_yang2008, result_table
from tests.report.synthetic import AREA_FACTOR, GAP_SHIFT, area, gap, write_all


@pytest.mark.parametrize("predictor", [False, True])
def test_the_paper_s_atoms_go_their_own_path_unless_told_otherwise(predictor, tmp_path, monkeypatch, capsys):
    commands = recorded(monkeypatch)
    options = ["--predictor"] if predictor else []
    monkeypatch.setattr("sys.argv", ["reproduce_yang2008", "--output", str(tmp_path), *options])
    assert reproduce_yang2008.main() == 0
    (atoms, *_) = (command for command in commands if command[0] == "md-reference")
    expected = ["--predictor", str(tmp_path / "bem.nc")] if predictor else []
    assert atoms[4:-1] == expected
    assert atoms[-1] == "--resume"
    assert commands[0][0] == ("bem-adhesion" if predictor else "md-reference"), "the gap before those who start from it"


def recorded(monkeypatch):
    """The list that the script's commands go to in place of a run, one lane after the other."""
    commands = []

    def record(lanes):
        commands.extend([str(part) for part in command] for lane in lanes for command in lane)
        return 0

    monkeypatch.setattr(reproduce_yang2008, "run", record)
    return commands


def test_commands_run_beside_each_other_and_the_first_failure_stops_all(tmp_path, monkeypatch):
    """Lanes of shell commands under the names of the project's."""
    for name in ("quick", "slow", "odd", "wrong"):
        command = tmp_path / name
        text = {
            "quick": 'nice > "$1"',
            "slow": "exec sleep 60",
            "odd": "exit 2",
            "wrong": "exit 3",
        }[name]
        command.write_text(f"#!/bin/sh\n{text}\n")
        command.chmod(0o755)
    monkeypatch.setattr("sys.executable", str(tmp_path / "python"))
    first, second = tmp_path / "first", tmp_path / "second"
    assert reproduce_yang2008.run([[["quick", first]], [["odd"], ["quick", second]]]) == 2
    # The tests themselves may run at a low priority.
    assert (int(first.read_text()), int(second.read_text())) == (os.nice(0), 19), "behind the first lane"
    began = time.monotonic()
    assert reproduce_yang2008.run([[["slow"], ["quick", tmp_path / "never"]], [["wrong"], ["slow"]]]) == 3
    assert time.monotonic() - began < 30  # half of the sleep that is cut short
    assert not (tmp_path / "never").exists()


def test_the_paper_s_scatter_is_of_twelve_surfaces(tmp_path, monkeypatch, capsys):
    commands = recorded(monkeypatch)
    for options, count in (
        ([], 12),
        (["--preset", "quick"], 4),
        (["--surfaces", "3"], 3),
        (["--surfaces", "0"], 0),
    ):
        commands.clear()
        monkeypatch.setattr("sys.argv", ["reproduce_yang2008", "--output", str(tmp_path), *options])
        assert reproduce_yang2008.main() == 0
        seeds = [command for command in commands if str(tmp_path / "bem_seeds.nc") in command]
        names = [command[0] for command in seeds]
        if not count:
            assert not seeds
            continue
        assert names == ["bem-adhesion", "contact-compare"], "run before it is shown"
        numbers = seeds[0][seeds[0].index("--surface.seed") + 1].split(",")
        assert numbers == [str(number) for number in range(1, count + 1)]
        assert seeds[0][1] == commands[0][1], "the study of the points"
        assert seeds[1][-2:] == ["--scatter", str(tmp_path / "bem_seeds.nc")]
    monkeypatch.setattr("sys.argv", ["reproduce_yang2008", "--surfaces", "1"])
    with pytest.raises(SystemExit):
        reproduce_yang2008.main()


@pytest.mark.parametrize(
    ("options", "count"),
    [([], "60"), (["--trajectories", "9"], "9"), (["--trajectories", "0"], ""), (["--preset", "quick"], "")],
)
def test_the_paper_s_atoms_stand_cold_and_warm_in_one_state(options, count, tmp_path, monkeypatch, capsys):
    commands = recorded(monkeypatch)
    monkeypatch.setattr("sys.argv", ["reproduce_yang2008", "--output", str(tmp_path), *options])
    assert reproduce_yang2008.main() == 0
    cold, warm = ([each for each in commands if str(tmp_path / f"md_{word}.nc") in each] for word in ("0K", "300K"))
    printed = capsys.readouterr().out
    if not count:
        assert not cold
        assert not warm
        assert "300K" not in printed
        return
    assert str(tmp_path / "md_300K.nc") in printed
    (cold,), (warm,) = cold, warm
    # The same question but for the temperature: all that stands in the cold command stands in the warm one.
    assert set(cold) - set(warm) == {str(tmp_path / "md_0K.nc")}
    assert warm[warm.index("--sampling.trajectories") + 1] == count
    table, rest = {}, warm[4:]
    while rest:
        key, *rest = rest
        if key != "--resume":
            value, *rest = rest
            table[key.removeprefix("--")] = {"false": False}.get(value, int(value) if value.isdigit() else value)
    case = read_study(warm[1], table).cases[0]
    assert case.lattice.atoms == (200, 200)
    assert (case.atomistic.method, case.atomistic.temperature) == ("sampling", 300.0)


def test_few_thermal_states_are_refused(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["reproduce_yang2008", "--trajectories", "1"])
    with pytest.raises(SystemExit):
        reproduce_yang2008.main()
    assert "two states" in capsys.readouterr().err


def test_result_table(tmp_path, capsys):
    paths = [str(path) for path in write_all(tmp_path)]
    comparison = str(tmp_path / "comparison.nc")
    assert compare([*paths, "-o", comparison]) == 0
    capsys.readouterr()
    assert result_table.main([comparison, "--pressures", "0.1 GPa", "5872.5 MPa"]) == 0
    head, _, *rows = capsys.readouterr().out.splitlines()
    assert head == "| | p (GPa) | atoms | continuum | Persson's theory | gap-flow theory |"
    expected = []
    for ratio, words in ((1, "ε = ε₀"), (8, "ε = 8 ε₀")):
        for pressure in (0.1, 5.8725):
            cells = [
                f"{AREA_FACTOR[model] * area(ratio, 1e9 * pressure):.4f}; "
                f"{(gap(ratio, 1e9 * pressure) + GAP_SHIFT[model]) / 1e-9:.3f}".replace("-", "−")
                for model in ("atomistic", "continuum", "persson", "gap_flow")
            ]
            expected.append(f"| {words} | {pressure:g} | {' | '.join(cells)} |")
    assert rows[:4] == expected
    assert rows[4] == ""
    assert [row.partition(", ")[0] for row in rows[6:]] == [
        "- ε = ε₀",
        "- ε = 8 ε₀",
        "- Persson's theory is published. The gap-flow theory is this project's own",
    ]


def attribution(areas, gaps):
    """A dataset as the script makes it, of one adhesion and as many pressures as rows."""
    models = list(continuum_against_atoms.MODELS)
    data = {"relative_contact_area": np.array([areas]), "mean_gap": np.array([gaps]) * 1e-10}
    for name in list(data):
        data[f"{name}_increment"] = np.diff(data[name], axis=-1, prepend=data[name][..., :1])
    constants = {"contact_modulus": 93.735e9, "measured_contact_modulus": 93.727e9}
    constants |= {"work_of_adhesion": 0.692, "measured_work_of_adhesion": 0.6865}
    return xr.Dataset(
        {name: (("well_depth_ratio", "pressure", "model"), values) for name, values in data.items()}
        | {name: ("well_depth_ratio", [value]) for name, value in constants.items()},
        coords={"model": models, "well_depth_ratio": [4.0], "pressure": range(len(areas))},
    )


def test_ranges_of_the_attribution():
    dataset = attribution(
        [[0.2, 0.2, 0.18, 0.18, 0.18, 0.18, 0.18, 0.19], [0.5, 0.5, 0.4, 0.4, 0.4, 0.4, 0.4, 0.45]],
        [[1.0, 1.0, 1.5, 1.5, 1.5, 1.5, 1.5, 1.2], [1.0, 1.0, 1.1, 1.1, 1.1, 1.1, 1.1, 1.3]],
    )
    rows = {row.split(" | ")[0][2:]: row for row in continuum_against_atoms.ranges(dataset).splitlines() if "|" in row}
    work = continuum_against_atoms.MODELS["measured_adhesion"]
    assert rows[work] == f"| {work} | -20.00 to -10.00 % | +0.100 to +0.500 |"
    # 0.01 of 0.2 and 0.05 of 0.5: over the continuum's area, not the one before.
    slide = continuum_against_atoms.MODELS["atoms"]
    assert rows[slide] == f"| {slide} | +5.00 to +10.00 % | -0.300 to +0.200 |"
    total = "**all together**"
    assert rows[total] == f"| {total} | -10.00 to -5.00 % | +0.200 to +0.300 |"
    words = continuum_against_atoms.constants_in_words(dataset)
    assert words == (
        "The lattice shows this surface E* = 93.727 GPa, the study has 93.735 GPa; the cut-off pairs have "
        "Δγ = 0.6865 J/m², the smeared layers 0.6920 J/m², both at 4 ε₀."
    )


def test_conclusion_of_two_starts():
    same = {"area_own": 0.2, "area_predicted": 0.2, "changed_atoms": 0.0, "energy_difference": -1e-12}
    lower = {"area_own": 0.2, "area_predicted": 0.21, "changed_atoms": 0.01, "energy_difference": -1e-3}
    higher = {"area_own": 0.2, "area_predicted": 0.19, "changed_atoms": 0.01, "energy_difference": 1e-3}
    assert two_starts.conclusion([same, same]) == "The two starts end in the same state at all 2 points."
    assert two_starts.conclusion([same, lower, higher]) == (
        "The two starts end in different states at 2 of 3 points, by -5.00 to +5.00 % of the area; at 1 of them the "
        "state from the continuum has the lower energy."
    )


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_branches_on_the_way_back_hold_more_contact(tmp_path):
    path = tmp_path / "branches.csv"
    options = ["--models", "continuum", "--atoms", "140", "--ratios", "8", "--pressures", "0.1 GPa", "1 GPa", "5 GPa"]
    options += ["--ways", "steps", "after 3 GPa", "-o", str(path)]
    assert branches.main(options) == 0
    table = pd.read_csv(path)
    assert table.converged.all()
    loaded, back = (table[table.way == way].set_index("pressure_GPa").area for way in ("steps", "after 3 GPa"))
    assert list(loaded.index) == [0.1, 1.0, 5.0]
    assert list(back.index) == [0.1, 1.0]  # from 3 GPa there is no way back to 5
    # Some of the patches that have snapped in by 3 GPa hold: 0.022 and 0.008 of the cell, a state's error is a point.
    assert back[0.1] > loaded[0.1] + 0.01
    assert back[1.0] > loaded[1.0] + 0.004
    table.assign(area=0.5).to_csv(path, index=False)
    assert branches.main(options) == 0
    assert (pd.read_csv(path).area == 0.5).all()  # nothing is run again


def test_branches_compares_every_way_with_steps(tmp_path, capsys):
    path = tmp_path / "branches.csv"
    options = ["--atoms", "28", "--ratios", "2", "--pressures", "0.5 GPa", "1 GPa", "-o", str(path)]
    assert branches.main([*options, "--ways", "steps", "flow 1e-2"]) == 0
    first = pd.read_csv(path)
    assert set(first.model) == {"atomistic", "continuum"}
    assert len(first) == 2 * 2 * 2
    assert first.converged.all()
    capsys.readouterr()
    # What is there is not run again, and another way is added to it.
    assert branches.main([*options, "--models", "continuum", "--ways", "steps", "small steps"]) == 0
    table = pd.read_csv(path)
    pd.testing.assert_frame_equal(table[table.way != "small steps"].reset_index(drop=True), first, check_dtype=False)
    assert len(table) == 2 * 2 * 2 + 2
    capsys.readouterr()
    # One state moved by hand shows, with its place.
    wrong = (table.way == "flow 1e-2") & (table.model == "atomistic") & (table.pressure_GPa == 1)
    table.loc[wrong, "area"] -= 0.0123
    table.to_csv(path, index=False)
    assert branches.main(["--from", str(path), "--pressures", "1 GPa"]) == 0
    head, _, atoms, continuum, _, small, flow = capsys.readouterr().out.splitlines()
    assert head == "| | atoms (surfaces) | ε/ε₀ | p (GPa) | steps: A; ū (Å) | small steps | flow 1e-2 |"
    state = table[(table.way == "steps") & (table.pressure_GPa == 1)].set_index("model")
    for row, model, cells in ((atoms, "atomistic", "|  | −0.0123;"), (continuum, "continuum", "| = | = |")):
        assert f"| 2 | 1 | {state.area[model]:.4f}; " in row
        assert cells in row
    assert small == "- small steps: the same in 2 of 2 states."
    shuffled = table.set_axis([0] * len(table))  # as rows of several runs come
    assert list(branches.lines(shuffled, [1.0]))[-1] == flow
    table.loc[wrong, "converged"] = 0
    assert "(moving) |" in list(branches.lines(table, [1.0]))[1]
    assert flow.startswith("- flow 1e-2: the same in 3 of 4 states; the area differs by −0.0123 at most (atoms, 28²")
