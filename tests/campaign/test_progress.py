import numpy as np
import pytest
import tomli_w
import xarray as xr

import bem_adhesion.study.interface
from contact_study import start
from contact_study.campaign import progress as module
from contact_study.campaign.progress import Progress
from contact_study.numerics import life
from tests.campaign import test_library

STUDY = {**test_library.STUDY, "loading": {"path": ["1 GPa"]}, "sweep": {}}


def test_a_line_says_what_became_of_a_step(capsys):
    progress = Progress("toy")
    progress.start(3, 0)
    for label, point, area, converged, detached, message, seconds in (
        ("", "1 GPa", 0.25, True, False, "", 1.0),
        ("case 2", "-1 GPa", 0.0, True, True, "detached: torn off", 0.1),
        ("", "2 GPa", 0.5, False, False, "", 0.1),
    ):
        flags = {"converged": converged, "detached": detached, "message": message}
        progress.step(label, point, {"relative_contact_area": area, **flags}, seconds)
    assert capsys.readouterr().err.splitlines() == [
        "toy: [1/3] 1 GPa, contact area 0.2500 (1.0 s)",
        "toy: [2/3] case 2: -1 GPa, detached: torn off (0.1 s)",
        "toy: [3/3] 2 GPa, contact area 0.5000, NOT CONVERGED (see residual) (0.1 s)",
    ]


def test_a_long_step_shows_life(monkeypatch, capsys):
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    progress = Progress("toy")
    progress.start(4, 1)
    progress.expected = 200.0
    for seconds, iterations in ((10, 5), (31, 12), (45, 20), (62, 30)):
        now[0] = 100.0 + seconds
        progress.step("seed = 1", "1 GPa", {"iterations": iterations, "residual": 3.21e-5}, None)
    assert progress.done == 1
    now[0] = 180.0
    progress.step("seed = 1", "1 GPa", {"relative_contact_area": 0.25}, 80.0)
    now[0] = 211.0
    progress.step("", "2 GPa", {"iterations": 3, "residual": None}, None)
    assert capsys.readouterr().err.splitlines() == [
        "toy: 1 of 4 steps were finished before",
        "toy: [1/4] at work: iteration 12, residual 3.2e-05, about 2.8 min left; seed = 1: 1 GPa",
        "toy: [1/4] at work: iteration 30, residual 3.2e-05, about 2.3 min left; seed = 1: 1 GPa",
        "toy: [2/4] seed = 1: 1 GPa, contact area 0.2500 (80.0 s)",
        "toy: [2/4] at work: iteration 3, about 3.7 min left; 2 GPa",
    ]


def test_a_listener_is_told_of_the_iterations_of_a_step(monkeypatch):
    now, heard = [0.0], []
    monkeypatch.setattr(life.time, "monotonic", lambda: now[0])
    with life.listening(lambda *sign: heard.append(sign)):
        for now[0] in (1.0, 1.9, 2.1, 3.0, 4.2):
            life.beat(2 * now[0])
        life.restart()
        life.beat()
        now[0] = 6.3
        life.beat()
    now[0] = 99.0
    life.beat()
    assert heard == [(3, 4.2), (5, 8.4), (2, None)]


@pytest.mark.parametrize(
    ("model", "points", "keys"),
    [
        ("continuum", 128, ["--loading.path", "1 GPa"]),
        ("continuum", 16, ["--loading.path", "1 GPa, -0.1 GPa", "--loading.adaptive", "true"]),
        ("continuum", 16, ["--solver.path", "overdamped"]),
        ("atoms", 16, []),
        ("theory", 16, []),
    ],
)
def test_every_solver_gives_signs_of_life(model, points, keys, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(life, "PAUSE", 0.0)
    monkeypatch.setattr(module, "_HALF_MINUTE", 0.0)
    surface = {**STUDY["surface"], "shape": [points, points]}
    (tmp_path / "study.toml").write_text(tomli_w.dumps({**STUDY, "surface": surface}))
    given = ["run", str(tmp_path / "study.toml"), "--model", model, "--workers", "1", *keys]
    assert start.bem_adhesion([*given, "-o", str(tmp_path / "told.nc")]) == 0
    assert "at work: iteration 1" in capsys.readouterr().err
    if points == 128:  # the solver itself is traced, which changes no number
        monkeypatch.setattr(bem_adhesion.study.interface, "_TRACED", np.inf)
        assert start.bem_adhesion([*given, "-o", str(tmp_path / "alone.nc")]) == 0
        assert "at work" not in capsys.readouterr().err
        with xr.open_dataset(tmp_path / "told.nc") as told, xr.open_dataset(tmp_path / "alone.nc") as alone:
            xr.testing.assert_equal(told.drop_vars("wall_time"), alone.drop_vars("wall_time"))


def test_tension_on_separated_surfaces_says_so(tmp_path, capsys):
    loading = {"path": ["-1 MPa", "1 MPa"]}
    (tmp_path / "study.toml").write_text(tomli_w.dumps({**STUDY, "loading": loading}))
    assert start.bem_adhesion([str(tmp_path / "study.toml"), "-o", str(tmp_path / "out.nc")]) == 0
    lines = capsys.readouterr().err
    words = "the surfaces are separated; start the loading path with a positive pressure"
    assert f"[1/2] -1 MPa, detached: {words}" in lines
    assert "[2/2] 1 MPa, contact area" in lines


def test_what_takes_its_time_shows_how_far_it_is(monkeypatch, capsys):
    for silence, lines in ((0.0, [f"toy: cases taken: {number} of 3" for number in range(3)]), (60.0, [])):
        monkeypatch.setattr(module, "_SILENCE", silence)
        assert list(Progress("toy").through(range(3), "cases taken")) == [0, 1, 2]
        assert capsys.readouterr().err.splitlines() == lines
