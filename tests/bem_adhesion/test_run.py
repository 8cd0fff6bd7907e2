import json
import re

import numpy as np
import pytest

from bem_adhesion.study import model as run
from contact_study.campaign import memory
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import quantity
from contact_study.physics.surfaces.surface import BandLimitedSurface
from contact_study.results.schema import COORDINATES, VARIABLES
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.bem_adhesion.paper_system import E_STAR, R0, study_table
from tests.recording import bins_of_case, recorded_path


def problem(points=64, **sections):
    table = study_table(points, size=500e-10, **{"loading": {"path": [0.5e9, 2e9], "unload": True}, **sections})
    case = make_study(table).cases[0]
    return case, realise(case)


HARD_WALL = {"interaction": {"law": "hard_wall", "work_of_adhesion": None, "length": None, "contact_distance": None}}


TIGHT, BY_GAP = {"solver": {"tolerance": 1e-11}}, {"loading": {"control": "gap", "path": [1e-9, 5e-10]}}


@pytest.mark.parametrize("sections", [TIGHT, HARD_WALL, BY_GAP])
def test_steps_hold_the_schema_and_agree_with_their_fields(sections):
    case, surface = problem(output={"fields": True}, **sections)
    steps, bins = recorded_path(case, run.solve_path(case, surface)), bins_of_case(case)
    for (target, _), step in zip(case.path, steps, strict=True):
        values, gap, pressure = step.values, step.fields["gap"], step.fields["pressure"]
        assert set(values) <= set(VARIABLES)
        assert values["residual"] < case.solver.tolerance
        assert values["mean_pressure"] == pytest.approx(pressure.mean())
        assert values["mean_gap"] == pytest.approx(gap.mean() - case.law.equilibrium_distance)
        assert values[f"mean_{case.loading.control}"] == pytest.approx(target, rel=1e-6)
        assert values["relative_repulsive_area"] == np.mean(pressure > 0)
        touching = gap < case.contact_distance if case.interaction.law != "hard_wall" else pressure > 0
        assert 0 < values["relative_contact_area"] == touching.mean() < 1
        assert np.sum(values["gap_pdf"] * np.diff(bins.gap_edges)) == pytest.approx(1)
        assert np.sum(values["pressure_pdf"] * np.diff(bins.pressure_edges)) == pytest.approx(1)


def test_the_iteration_limit_is_that_of_the_study():
    case, surface = problem(solver={"max_iterations": 1})
    assert next(iter(run.solve_path(case, surface))).report.iterations == 1


def test_constants_of_law_material_and_surface_whose_heights_are_made_once(monkeypatch):
    made, heights = [], BandLimitedSurface.heights
    monkeypatch.setattr(BandLimitedSurface, "heights", lambda self, shape: made.append(shape) or heights(self, shape))
    case, surface = problem(output={"fields": True})
    found = run.constants(case, surface)
    next(iter(run.solve_path(case, surface)))
    assert made == [surface.shape]
    assert set(found) <= set(VARIABLES) | set(COORDINATES)
    assert found["contact_modulus"] == pytest.approx(E_STAR)
    assert found["work_of_adhesion"] == 0.69
    assert found["equilibrium_distance"] == R0
    assert found["process_zone"] == pytest.approx(41e-10, rel=0.01)
    assert found["height"].shape == (64, 64)


def review(points, **sections):
    study = make_study(study_table(points, size=500e-10, **sections))
    return run.review(study, study.scales)


def test_the_grid_is_warned_of_once_a_study_with_ways_out():
    table = study_table(64, size=500e-10, sweep={"interaction.well_depth_ratio": [1, 4, 8], "surface.seed": [1, 2]})
    study = make_study(table)
    (note,) = run.review(study, study.scales)
    assert "(4 of 6 points of the sweep, such as well_depth_ratio = 4.0, seed = 1)" in note  # of process zone 10, 5 Å
    # The way that is named resolves the law of the strongest adhesion, and not by far.
    shape = json.loads(re.search(r"surface\.shape = (\[.*?\])", note)[1])
    for points, resolves in ((shape, True), ([n - 16 for n in shape], False)):
        changed = {**table, "surface": table["surface"] | {"shape": points}}
        assert (run.review(make_study(changed), make_study(changed).scales) == []) == resolves
    assert "interaction.length" not in note, "stiff contacts are not JKR-like: a longer range is another contact"


SOFT = {"material": {"youngs_modulus": 2e6, "poissons_ratio": 0.5}, "surface": {"size": 1e-4, "rms_height": 1e-6}}
SOFT_LAW = {"law": "exponential", "work_of_adhesion": 0.05, "contact_distance": None}


@pytest.mark.parametrize("given", ["auto", 7.4e-8])
def test_a_grid_beyond_this_machine_is_not_proposed(tmp_path, monkeypatch, given):
    monkeypatch.setattr(memory, "_memory", lambda: 1e6 * 100.0)
    rough = {**SOFT["surface"], "cutoff_mode": 64, "shape": [448, 448]}
    heights = realise(make_study(study_table(448, surface=rough)).cases[0]).sampled
    np.save(tmp_path / "map.npy", heights)

    def notes(interaction, **surface):
        keys = {"kind": "file", "path": "map.npy", "size": 1e-4, **surface}
        study = make_study(
            {"surface": keys, "material": SOFT["material"], "interaction": interaction, "loading": {"path": [1e4]}},
            tmp_path,
        )
        return [note for note in run.review(study, study.scales) if "process zone" in note]

    law = {"law": "exponential", "work_of_adhesion": 0.05, "length": given}
    (note,) = notes(law)
    number = r'interaction\.length = "(\S+ \S+)"'
    assert re.search(rf"cannot be resolved here: {number} on surface\.shape = \[\d+, \d+\] needs \S+ [MG]B; ", note)
    part = rf"take a part of the surface of up to (\S+ \S+) with {number} and surface\.shape = (\[.*?\])"
    widest, length, shape = re.search(part, note).groups()
    crop = [[0, quantity(widest, "m", "")]] * 2
    assert notes(law | {"length": length}, crop=crop, shape=json.loads(shape)) == []
    # What the grid at hand resolves, with its price.
    longer = quantity(re.search(rf"accept {number}", note)[1], "m", "")
    assert notes(law | {"length": longer}) == []
    assert notes(law | {"length": 0.95 * longer}) != []
    tabor, pull_off = map(float, re.search(r"Tabor parameter (\S+), a sphere's pull-off \+(\S+) %", note).groups())
    assert 0.5 < tabor < 3
    assert 1 < pull_off < 20
    # A part of a few points is no part of a rough surface, nor a range longer than it is high a way out.
    monkeypatch.setattr(memory, "_memory", lambda: 1e4 * 100.0)
    assert "take a part" not in notes(law)[0]
    (note,) = review(64, surface={"size": 1e-3}, interaction={"length": 1e-9, "contact_distance": 1.2e-9})
    assert "cannot be resolved here" in note
    assert "accept" not in note


def test_a_law_that_no_grid_point_feels_is_refused():
    with pytest.raises(InputError, match=r"surface\.size, surface\.shape: .* beyond 100000"):
        review(64, surface={"size": 3.0})
    assert review(64, surface={"size": 3.0}, **HARD_WALL) == []


def test_below_one_point_a_process_zone_the_state_is_said_to_depend_on_the_way():
    assert review(64) == []  # 5.2 points
    for size in (1000e-10, 2250e-10):  # 2.6 and 1.15
        (note,) = review(64, surface={"size": size})
        assert "a quarter of the process zone" in note
        assert "slow loading" not in note
    (note,) = review(64, surface={"size": 3000e-10})  # 0.87
    assert "the process zone 4.1" in note
    assert "slow loading ends with up to" in note


def test_the_longest_range_of_rubber_is_proposed_with_the_shape_it_needs():
    soft, law = SOFT, SOFT_LAW | {"length": 3e-10}
    (note,) = review(64, interaction=law, **soft)
    proposed, shape = re.search(r'interaction\.length = "auto" \((.*?)\) on surface\.shape = (\[.*?\])', note).groups()
    assert re.search(r"\(0\.\d+ GB; Tabor parameter 3, a sphere's pull-off \+1\.\d %\) resolves it$", note)
    # What it proposes is taken without a further word; on the grid at hand only the points are asked for.
    longer = law | {"length": proposed}
    assert review(json.loads(shape)[0], interaction=longer, **soft) == []
    (other,) = review(64, interaction=longer, **soft)
    assert other.endswith(f"surface.shape = {shape} (0.47 GB) resolves it")
    # On finer grids a range that they resolve and that stays JKR-like is all that is proposed.
    (other,) = review(2304, interaction=law, **soft)
    assert re.search(r'interaction\.length = ".*?" of the same work of adhesion \(Tabor .*\) resolves it$', other)
    assert "surface.shape" not in other
    # What half the points resolve is 1.4 times as long: no longer JKR-like.
    assert f"surface.shape = {shape}" in review(json.loads(shape)[0] // 2, interaction=law, **soft)[0]


def coated(kind, thickness, base):
    of_base = {"base_youngs_modulus": base, "base_poissons_ratio": 0.42} if kind == "layered" else {}
    return {"elasticity": {"kind": kind, "thickness": thickness, **of_base}}


@pytest.mark.parametrize("kind", ["layer", "layered"])
def test_a_layer_thinner_than_the_grid_is_said(kind):
    thin, thick = (
        [note for note in review(48, **coated(kind, depth, 100e9)) if "layer" in note] for depth in (9e-10, 12e-10)
    )
    assert not thick
    assert "the layer of 9e-10 m is thinner than the grid spacing 1.04e-09 m" in thin[0]


def test_the_process_zone_is_that_of_the_softest_wave():
    (note,) = review(64, **coated("layered", 20e-10, 7.72e9))
    zone = quantity(re.search(r"the process zone (\S+ \S+):", note)[1], "m", "")
    # The longest wave, 500 Å, is 25 times as long as the coating is thick, and its modulus not quite the base's.
    assert 4.1e-10 < zone < 1.5 * 4.1e-10
    assert review(64, **coated("layered", 20e-10, 772e9)) == review(64) == []
