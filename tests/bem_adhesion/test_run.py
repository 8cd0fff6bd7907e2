import warnings

import numpy as np
import pytest

from bem_adhesion import run
from contact_study.campaign.schema import COORDINATES, VARIABLES
from contact_study.problem.bins import with_bins
from contact_study.problem.study import make_study
from contact_study.problem.surface import realise
from tests.bem_adhesion.paper_system import E_STAR, R0, study_table


def problem(points=64, **sections):
    table = study_table(points, size=500e-10, **{"loading": {"path": [0.5e9, 2e9], "unload": True}, **sections})
    case = with_bins(make_study(table)).cases[0]
    return case, realise(case)


HARD_WALL = {"interaction": {"law": "hard_wall", "work_of_adhesion": None, "length": None, "contact_distance": None}}


@pytest.mark.parametrize("sections", [{}, HARD_WALL, {"loading": {"control": "gap", "path": [1e-9, 5e-10]}}])
def test_steps_hold_the_schema_and_agree_with_their_fields(sections):
    case, surface = problem(output={"fields": True}, **sections)
    steps = list(run.solve_path(case, surface))
    assert len(steps) == len(case.path)
    for (target, _), step in zip(case.path, steps, strict=True):
        values, gap, pressure = step.values, step.fields["gap"], step.fields["pressure"]
        assert set(values) <= set(VARIABLES)
        assert values["converged"]
        assert values["residual"] < case.solver.tolerance
        assert values["mean_pressure"] == pytest.approx(pressure.mean())
        assert values["mean_gap"] == pytest.approx(gap.mean() - case.law.equilibrium_distance)
        controlled = values["mean_pressure"] if case.loading.control == "pressure" else values["mean_gap"]
        assert controlled == pytest.approx(target, rel=1e-6)
        assert values["relative_repulsive_area"] == np.mean(pressure > 0)
        touching = gap < case.contact_distance if case.interaction.law != "hard_wall" else pressure > 0
        assert 0 < values["relative_contact_area"] == touching.mean() < 1
        assert np.sum(values["gap_pdf"] * np.diff(case.bins.gap_edges)) == pytest.approx(1)
        assert np.sum(values["pressure_pdf"] * np.diff(case.bins.pressure_edges)) == pytest.approx(1)
        assert values["elastic_energy"] > 0


@pytest.mark.parametrize("sections", [{}, HARD_WALL])
def test_a_resumed_path_gives_the_same_bits(sections):
    case, surface = problem(output={"fields": True}, **sections)
    whole = list(run.solve_path(case, surface))
    resumed = list(run.solve_path(case, surface, whole[0].restart, 1))
    for one, two in zip(whole[1:], resumed, strict=True):
        np.testing.assert_array_equal(one.fields["gap"], two.fields["gap"])
        assert {k: v for k, v in one.values.items() if np.ndim(v) == 0 and k != "wall_time"} == {
            k: v for k, v in two.values.items() if np.ndim(v) == 0 and k != "wall_time"
        }


def test_detached_steps_are_answers_with_nothing_in_contact():
    case, surface = problem(loading={"path": [1e9, -3e9, 1e9], "unload": False})
    first, apart, again = run.solve_path(case, surface)
    assert apart.values["detached"]
    assert apart.values["converged"]
    assert apart.values["relative_contact_area"] == 0
    assert apart.values["mean_gap"] == np.inf
    assert "detached" in apart.values["message"]
    assert again.values["relative_contact_area"] == first.values["relative_contact_area"]


def test_constants_of_law_material_and_surface():
    case, surface = problem(output={"fields": True})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = run.constants(case, surface)
    assert set(found) <= set(VARIABLES) | set(COORDINATES)
    assert found["contact_modulus"] == pytest.approx(E_STAR)
    assert found["work_of_adhesion"] == 0.69
    assert found["equilibrium_distance"] == R0
    assert found["process_zone"] == pytest.approx(41e-10, rel=0.01)
    assert found["height"].shape == (64, 64)


def test_a_grid_that_cannot_resolve_the_law_is_warned_of():
    case, surface = problem(32)
    with pytest.warns(UserWarning, match="quarter of the process zone"):
        run.constants(case, surface)
