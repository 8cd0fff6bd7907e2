"""The states of the atlas' contacts by several ways: each is computed once, and what parts is counted and named."""

import numpy as np
import pandas as pd
import pytest

from contact_study.atlas.design import drawn
from research import branches_of_atlas as branches


def numbered(number):
    return next(one for one in drawn() if one.number == number)


@pytest.mark.validation
def test_states_are_computed_once_and_those_that_part_are_counted(tmp_path, capsys, monkeypatch):
    path = tmp_path / "branches.csv"
    monkeypatch.setattr(branches, "design", lambda count: ([numbered(47), numbered(179)], {}))
    given = ["--largest", "36", "--table", str(path), "--ways", "small steps"]
    assert branches.main([*given, "large steps", "thermal 0.1"]) == 0  # no thermal motion at a wall
    first = pd.read_csv(path)
    assert first.way.tolist() == 6 * ["small steps"] + 6 * ["large steps"]
    assert first.load.tolist() == 2 * [*branches.LOADS, *branches.LOADS[::-1]]
    assert first.branch.tolist() == 2 * (3 * ["loading"] + 3 * ["unloading"])
    known = branches.states
    monkeypatch.setattr(branches, "states", lambda condition, way: known(condition, {"flow 1e-2": way}[way]))
    assert branches.main([*given, "large steps", "flow 1e-2"]) == 0
    table = pd.read_csv(path)
    pd.testing.assert_frame_equal(table[:12], first)
    assert table.converged.all()
    assert "0 states without temperature part from small steps." in capsys.readouterr().out
    # One state moved on unloading shows; small steps alone decide about hysteresis.
    moved = (table.way == "flow 1e-2") & (table.branch == "unloading") & (table.load == 0.2)
    table.loc[moved, "area"] -= 0.03
    said = list(branches.lines(table))
    assert any("| no | flow 1e-2 | 1 | 36²…36² | 3 of 3 | 2 of 3 | −0.0300 |" in line for line in said)
    assert said[-1].startswith("| 179 | 36² | dugdale | half_space | 0.25 | flow 1e-2 | unloading | 0.2 | 0.30")
    assert "| −0.0100 |" in next(line for line in said if "| no | flow 1e-2 |" in line)


@pytest.mark.validation
def test_thermal_motion_vanishes_with_its_share_of_the_length():
    condition = numbered(91)
    height = np.zeros((4, 4))
    points, force, hessian = branches.Points(condition, height), np.empty((3, 4, 4)), np.empty((6, 4, 4))
    gap, step = np.linspace(0.9, 3.0, 16).reshape(4, 4) * condition.length, 1e-5 * condition.length
    up, down = (points.evaluate(np.stack([height, height, gap + one]), force) for one in (step, -step))
    points.evaluate(np.stack([height, height, gap]), force, hessian)
    # Central differences: (step / gap)² of terms up to a hundred times the sum.
    assert (up - down) / (2 * step) == pytest.approx(-force[2].sum(), rel=1e-6)
    cold = branches.states(condition, "large steps")[0]
    warm, hot = (next(branches.thermal(condition, share)) for share in (1e-3, 0.1))
    # Thermal expansion goes as the square of the share: below 1e-5 at the small one.
    assert warm[0] == pytest.approx(cold["area"], abs=0.5 / 48**2)
    assert warm[1] == pytest.approx(cold["gap"], abs=4 * warm[3] + 1e-5)
    assert hot[1] > cold["gap"] + 4 * hot[3]
