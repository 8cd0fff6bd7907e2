"""Errors of resolution beside the states of the theories."""

import dataclasses
import warnings

import numpy as np
import pytest

from contact_study.results.schema import RESOLUTION_ERROR
from contact_study.study.case import realise
from tests.theory.test_run import study_of
from theory.study import model as run
from theory.study.case_theories import case_theories

AREA, GAP = "relative_contact_area", "mean_gap"


def case_of(accuracy, flows="gap_flow, edge_flow", **loading):
    theory = {"flows": flows} | ({} if accuracy is None else {"accuracy": accuracy})
    return study_of(theory=theory, loading={"path": ["1 GPa", "5 GPa"], "unload": False} | loading).cases[0]


@pytest.fixture(scope="module")
def case():
    return case_of(0.05)


@pytest.fixture(scope="module")
def found(case):
    with warnings.catch_warnings():
        warnings.simplefilter("error", run.Unresolved)
        return [step.values for step in run.solve_path(case, realise(case))]


@pytest.mark.validation
def test_every_state_has_its_errors_and_only_where_asked(case, found):
    for state in ("persson", "gap_flow", "gap_flow/loading", "gap_flow/unloading", "edge_flow"):
        for values in found:
            assert values[f"{state}/resolved"] is True
            assert 0 < values[f"{state}/{AREA}{RESOLUTION_ERROR}"] < 0.05 * values[f"{state}/{AREA}"]
            assert 0 < values[f"{state}/{GAP}{RESOLUTION_ERROR}"] < 0.05 * 1e-9
            assert f"{state}/mean_pressure{RESOLUTION_ERROR}" not in values
    (whole,) = case_theories(case, realise(case))
    coarser = dataclasses.replace(whole, coarsening=2).persson
    assert (coarser.nodes, coarser.cells) == (whole.persson.nodes // 2, whole.persson.cells // 2)
    plain = case_of(None)
    (step, *_) = run.solve_path(plain, realise(plain))
    assert not [name for name in step.values if "resol" in name]
    assert step.values["persson/" + AREA] == found[0]["persson/" + AREA]
    (resumed,) = run.solve_path(case, realise(case), start=1)
    for name in (f"persson/{AREA}", f"edge_flow/{AREA}"):
        # The state may differ by the tolerance of its iteration, 1e-6 and less.
        error = pytest.approx(found[1][name + RESOLUTION_ERROR], rel=1e-2, abs=1e-6 * found[1][name])
        assert resumed.values[name + RESOLUTION_ERROR] == error


def test_a_missed_accuracy_is_flagged_and_said(found):
    case = case_of(1e-6)
    with pytest.warns(run.Unresolved) as said:
        missed = [step.values for step in run.solve_path(case, realise(case))]
    assert [values["edge_flow/resolved"] for values in missed] == [False, False]
    assert missed[0]["edge_flow/" + AREA + RESOLUTION_ERROR] == found[0]["edge_flow/" + AREA + RESOLUTION_ERROR]
    (words,) = [str(each.message) for each in said if "edge flow:" in str(each.message)]
    worst = max(values[f"edge_flow/{AREA}{RESOLUTION_ERROR}"] / values[f"edge_flow/{AREA}"] for values in missed)
    assert "at 2 of 2 points" in words
    assert f"at most {worst:.2g} of the contact area" in words


def test_what_is_undefined_or_gone_is_told_apart(case):
    (theories,) = case_theories(case, realise(case))

    def judged(area, gap, other_area, other_gap):
        names = tuple(f"edge_flow/{name}" for name in (AREA, GAP, "mean_pressure", "residual"))
        fine = dict(zip(names, (area, gap, 1e9, 1), strict=True))
        coarser = dict(zip(names, (other_area, other_gap, 2e9, 1), strict=True))
        values, worst = run.errors(fine, coarser, theories, 0.1)
        assert set(values) == {*(name + RESOLUTION_ERROR for name in names[:2]), "edge_flow/resolved"}
        assert values["edge_flow/resolved"] is (not worst)
        return [*values.values()], worst.get("edge_flow")

    assert judged(0.5, 1e-10, 0.47, 1e-10) == ([pytest.approx(0.03), True, 0.0], None)
    # Both have come off, or both define no gap.
    assert judged(0.0, np.inf, 0.0, np.inf) == ([0.0, True, 0.0], None)
    assert judged(0.5, np.nan, 0.5, np.nan) == ([0.0, True, pytest.approx(np.nan, nan_ok=True)], None)
    # One alone has come off; a gap of a tenth of the rms height, 1 nm, and more.
    values, worst = judged(0.5, 1e-10, 0.0, np.inf)
    assert worst[0] == judged(0.0, 0.0, 0.1, 0.0)[1][0] == np.inf
    assert np.isnan(values[2])
    assert judged(0.5, 1e-10, 0.5, 2.1e-10)[1] == (pytest.approx(0.11, rel=1e-2), "of the rms height in the mean gap")


def test_a_balance_of_stress_that_is_off_is_not_resolved(case):
    (theories,) = case_theories(case, realise(case))
    states = (1.03, 0.02, False), (0.97, 0.02, False), (1.03, 0.04, True), (np.nan, 0.01, True)
    for balance, accuracy, resolved in states:
        fine = {f"persson/{AREA}": 0.5, "persson/stress_balance": balance}
        values, worst = run.errors(fine, fine | {"persson/stress_balance": 7.0}, theories, accuracy)
        assert values == {f"persson/{AREA}{RESOLUTION_ERROR}": 0.0, "persson/resolved": resolved}
        if not resolved:
            assert worst["persson"] == (pytest.approx(0.03), "of the pressure in the balance of stress")


def test_a_prescribed_gap_has_an_error_of_the_pressure():
    case = case_of(0.05, control="gap", path=["0.5 nm"], flows="gap_flow")
    (step,) = run.solve_path(case, realise(case))
    assert step.values["gap_flow/mean_pressure" + RESOLUTION_ERROR] > 0
    assert "gap_flow/" + GAP + RESOLUTION_ERROR not in step.values
