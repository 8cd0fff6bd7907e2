"""Every observable on a state made by hand, under names and in the units of its entry."""

import numpy as np
import pytest

from contact_study.numerics.distributions import Bins
from contact_study.numerics.grid import Grid
from contact_study.results.observables import (
    ENTRIES,
    FURTHER,
    OBSERVABLES,
    OVERCOUNT,
    RELATIVE_DISTANCE,
    observed,
    recorded,
)
from contact_study.results.schema import VARIABLES, heights_on
from contact_study.results.state import InterfaceState, SolverReport, Step

BINS = Bins.evenly((-2e9, 4e9, 6), (0.0, 8e-10, 4))
REPORT = SolverReport(converged=True, detached=False, residual=1e-9, iterations=12, fft_pairs=20.5, message="slow")


def state(**changes):
    content = {
        "gap": np.array([[3e-10, 3e-10, 5e-10], [3e-10, 5e-10, 7e-10]]),
        "pressure": np.array([[2.5e9, 1.5e9, -1.5e9], [0.5e9, -0.5e9, 0.0]]),
        "contact": np.array([[True, True, False], [True, False, False]]),
        "equilibrium_distance": 2e-10,
        "mean_separation": 2.2e-10,
        "elastic_energy": 0.3,
        "interaction_energy": -0.4,
        "report": REPORT,
        "restart": {"state": np.arange(3.0)},
        "spacing": (2e-10, 1e-10),
        "further": {"contact_stiffness": 3e18, "dissipated_energy": 0.02},
        "passed": np.array([[1e8, 3e-10, -0.1, 0.0], [-1e8, np.inf, 0.0, 0.2]]),
        "highest_point": 3e-10,
    }
    return InterfaceState(**{**content, **changes})


def test_observables_of_a_state_made_by_hand():
    found = observed(state(), BINS)
    pressure_pdf, gap_pdf = found.pop("pressure_pdf"), found.pop("gap_pdf")
    passed = [list(found.pop(f"passed_{name}")) for name in ("pressure", "separation", "energy", "viscous_dissipation")]
    assert passed == [[1e8, -1e8], [3e-10, np.inf], [-0.1, 0.0], [0.0, 0.2]]
    assert found.pop("mean_gap") == pytest.approx(26e-10 / 6 - 2e-10, rel=1e-12)
    assert found.pop("mean_pressure") == pytest.approx(2.5e9 / 6, rel=1e-12)
    assert found.pop("total_force") == pytest.approx(2.5e9 * 2e-20, rel=1e-12)  # six points of 2 Å x 1 Å
    # Of the lags within half of the shorter side, 3 points along x, there is one: a third of it, in one pair of six.
    pairs = found.pop("contact_autocorrelation")
    np.testing.assert_allclose(pairs[~np.isnan(pairs)], [1 / 6])
    # All three points without contact are 1 Å from it, a third of the shorter side.
    gaps = found.pop("gap_at_distance")
    assert list(np.flatnonzero(~np.isnan(gaps))) == [np.searchsorted(RELATIVE_DISTANCE, 1 / 3) - 1]
    assert np.nanmax(gaps) == pytest.approx((5 + 5 + 7) * 1e-10 / 3 - 2e-10)
    sizes = found.pop("patch_size_density")
    assert sizes[-1] == 2.0  # one patch in the octave of half a cell and more
    assert sizes.sum() == 2.0
    assert found == {
        "mean_patch_diameter": pytest.approx(2 * np.sqrt(3 * 2e-20 / np.pi)),
        "mean_separation": 2.2e-10,
        "displacement": pytest.approx(0.8e-10, rel=1e-12),
        "contact_radius": pytest.approx(np.sqrt(3 * 2e-20 / np.pi), rel=1e-12),
        "relative_contact_area": 3 / 6,
        "relative_repulsive_area": 3 / 6,
        "elastic_energy": 0.3,
        "interaction_energy": -0.4,
        "cluster_count": 1,
        "largest_cluster_area": 3 / 6,
        # On a torus of 2 × 3 cells two sides along x and four along y part contact from none.
        "contact_perimeter": pytest.approx(np.pi / 4 * (2 * 1e-10 + 4 * 2e-10) / (6 * 2e-20), rel=1e-12),
        "corrected_contact_area": pytest.approx(3 / 6 - OVERCOUNT * (2 + 4) / 6),
        "corrected_repulsive_area": pytest.approx(3 / 6 - OVERCOUNT * (2 + 4) / 6),  # the same points
        "contact_stiffness": 3e18,
        "dissipated_energy": 0.02,
        "contact_percolates": True,
        "gap_percolates": True,
        "converged": True,
        "detached": False,
        "residual": 1e-9,
        "iterations": 12,
        "fft_pairs": 20.5,
        "message": "slow",
    }
    # Points in each bin over all points and the bin's width.
    np.testing.assert_allclose(pressure_pdf, np.array([1, 1, 2, 1, 1, 0]) / 6e9, rtol=1e-12)
    np.testing.assert_allclose(gap_pdf, np.array([0, 3, 2, 1]) / (6 * 2e-10), rtol=1e-12)


def test_free_boundaries_part_what_meets_over_the_edges():
    """Two ridges at opposite rims, 4 by 1 points each, of a map of 4 by 6."""
    ridges = np.zeros((4, 6), bool)
    ridges[:, [0, -1]] = True
    maps = {"gap": np.where(ridges, 3e-10, 5e-10), "pressure": 1e9 * ridges, "contact": ridges, "spacing": (1.0, 1.0)}
    together, apart = (observed(state(**maps, periodic=periodic), BINS) for periodic in (True, False))
    names = ("cluster_count", "largest_cluster_area", "contact_percolates", "gap_percolates")
    assert [together[name] for name in names] == [1, 8 / 24, True, True]
    assert [apart[name] for name in names] == [2, 4 / 24, True, True]
    step = np.zeros((4, 6), bool)
    step[0, :3] = step[1, 2:] = True  # from rim to rim, and its ends do not meet over the edge
    for periodic, through, sides in ((True, False, 16), (False, True, 11)):
        found = observed(state(**maps | {"contact": step}, periodic=periodic), BINS)
        assert found["contact_percolates"] is through
        assert found["contact_perimeter"] == pytest.approx(np.pi / 4 * sides / 24)
    # Lags of one point, in the ring from 0.18 to 0.25 of the side: of 24 + 24 pairs 8 + 4, inside 6 of 18 + 20.
    ring = ~np.isnan(together["contact_autocorrelation"])
    assert together["contact_autocorrelation"][ring][0] == pytest.approx(12 / 48)
    assert apart["contact_autocorrelation"][ring][0] == pytest.approx(6 / 38)


def test_names_are_spelt_once_and_have_entries():
    names = [name for observable in OBSERVABLES for name in observable.variables]
    assert len(names) == len(set(names))
    report = SolverReport(True, False, 0.0, 1, 0.0, 1, complementarity_residual=0.0, acceptance_rate=0.8)
    further = dict.fromkeys([*FURTHER.variables, "time"], 1.0)
    indentation = np.array([[1e-10, 0.0, 0.0], [5e-10, 0.0, 0.0]])
    found = observed(state(report=report, further=further, plastic_indentation=indentation), BINS, ["leakage"])
    assert found["relative_plastic_area"] == pytest.approx(2 / 6)
    assert found["mean_plastic_indentation"] == pytest.approx(1e-10)
    assert set(found) == set(names) == set(ENTRIES)
    for name, value in found.items():
        assert VARIABLES[name].dims[0] == "step", name
        assert np.ndim(value) == len(VARIABLES[name].dims) - 1, name
        np.asarray(value).astype(VARIABLES[name].dtype)


def test_heights_stand_on_their_positions():
    found = heights_on(Grid((2, 3), (4e-9, 9e-9)), np.ones((2, 3)))
    np.testing.assert_allclose(found["y"], [0, 2e-9], rtol=1e-15)
    np.testing.assert_allclose(found["x"], [0, 3e-9, 6e-9], rtol=1e-15)


def test_steps_have_fields_where_asked_and_distributions_of_theories_on_the_bins():
    given = state()
    for fields in (False, True):
        step = recorded(given, BINS, fields)
        assert (step.bins, step.restart) == (BINS, given.restart)
        assert step.fields == ({"gap": given.gap, "pressure": given.pressure} if fields else {})
    step = Step({"persson/pressure_pdf": np.diff, "gap_flow/gap_pdf": lambda edges: edges[1:], "mean_gap": 3.0})
    values = recorded(step, BINS).values
    np.testing.assert_array_equal(values["persson/pressure_pdf"], np.diff(BINS.pressure_edges))
    np.testing.assert_array_equal(values["gap_flow/gap_pdf"], BINS.gap_edges[1:])
    assert values["mean_gap"] == 3.0
