"""The atomistic model on larger systems: independence of the start, and the order of its results."""

import numpy as np
import pytest

from contact_study.study.case import realise
from md_reference.study.model import solve_path
from tests.md_reference.systems import R0, case_of
from tests.recording import recorded_path

pytestmark = pytest.mark.validation

PATH = ("0.2 GPa", "1 GPa", "5 GPa")
SURFACE = {"surface": {"rms_height": 4e-10, "cutoff_mode": 8, "roll_off_mode": 2}}


@pytest.mark.parametrize("ratio", [1, 4, 8])
def test_own_path_and_predicted_starts_end_in_the_same_states(ratio):
    case = case_of((160, 160), ratio=ratio, path=PATH, **SURFACE)
    surface = realise(case)
    own = recorded_path(case, solve_path(case, surface))
    # What a continuum does: the same gap at the lateral rest positions, the attraction outside contact a little off.
    gaps = [s.fields["gap"] * (1 + 0.05 * (s.fields["gap"] > 1.2 * R0)) for s in own]
    led = recorded_path(case, solve_path(case, surface, predictor=lambda number: gaps[number]))
    for a, b in zip(own, led, strict=True):
        assert a.values["converged"]
        assert b.values["converged"]
        assert b.values["relative_contact_area"] == pytest.approx(a.values["relative_contact_area"], abs=2e-4)
        assert b.values["mean_gap"] == pytest.approx(a.values["mean_gap"], abs=1e-3 * R0)
    evaluations = [sum(s.values["force_evaluations"] for s in path) for path in (own, led)]
    assert evaluations[1] < evaluations[0]


def test_adhesion_closes_the_gap_and_pressure_spreads_the_contact():
    cases = [case_of((128, 128), ratio=ratio, path=PATH, **SURFACE) for ratio in (1, 4, 8)]
    paths = [recorded_path(case, solve_path(case, realise(case))) for case in cases]
    areas, gaps = ([[s.values[name] for s in path] for path in paths] for name in ("relative_contact_area", "mean_gap"))
    assert np.all(np.diff(areas, axis=0) > 0)
    assert np.all(np.diff(areas, axis=1) > 0)
    # At 5 GPa the strong laws touch everywhere, and a stiffer law then means less compression.
    assert np.all(np.diff(gaps, axis=0)[:, :2] < 0)
    assert np.all(np.diff(gaps, axis=1) < 0)
