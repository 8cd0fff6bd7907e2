"""What a path tells of adhesion, on series in closed form: flat surfaces under a 10-4 law, a contact that jumps."""

from dataclasses import replace

import numpy as np
import pytest

from contact_study.physics.laws import LennardJones104
from contact_study.results.path_results import PathSeries, beyond_spring, path_results, series_of, with_forces

LAW = LennardJones104(0.69, 3.28e-10)


def series(pressure, separation, energy=None, ends_apart=False, points=None):
    columns = [pressure, separation, *([] if energy is None else [energy])]
    return PathSeries(np.stack([np.asarray(column, float) for column in columns], axis=-1), ends_apart, points)


def flat(gaps, ends_apart=True):
    """Flat rigid surfaces brought through these gaps (m)."""
    gaps = np.asarray(gaps)
    return series(-LAW.traction(gaps), gaps - LAW.equilibrium_distance, LAW.potential(gaps), ends_apart)


def there_and_back(closest, farthest, points=400):
    back = np.geomspace(closest, farthest, points)
    return np.concatenate([back[::-1], back[1:]])


def test_flat_surfaces_pull_off_at_the_peak_and_take_their_work_of_adhesion():
    found = path_results(flat(there_and_back(3e-10, 2e-9)), "gap")
    error = found["pull_off_pressure_resolution_error"]
    # A parabola's vertex: off by the third power of a step of half a per cent, times some ten to a hundred; the lowest
    # of the states by half its second power, times the curvature of the peak, some twenty.
    assert found["pull_off_pressure"] - error == pytest.approx(-LAW.peak_tensile_stress, rel=1e-5)
    assert 0 <= error <= 3e-4 * LAW.peak_tensile_stress
    # The trapezoidal rule: the square of a step of 0.5 % over twelve, times the second derivative, some ten peaks.
    for end in (2e-9, 8e-10):  # wherever the path ends
        work = path_results(flat(there_and_back(3e-10, end)), "gap")["work_of_separation"]
        assert work == pytest.approx(0.69, rel=1e-3)
    assert "jump_in_pressure" not in found, "rigid surfaces do not jump"


def test_pull_off_between_long_uneven_steps_is_within_its_error():
    """A cubic p(s) with its lowest, −2 at s = 1, in the longer of the steps beside the lowest state."""
    curve = np.polynomial.Polynomial([0.0, -3.0, 0.0, 1.0])
    separation = np.array([-0.5, -1.0, -0.2, 0.4, 1.6, 1.9, 3.0])
    known = series(curve(separation), separation, -curve.integ()(separation))
    found = path_results(known, "gap")
    assert found["pull_off_pressure"] == curve(0.4)
    # A cubic less the parabola of its ends and mean is 1.2³/(12 √3) = 0.083 at most; that through three misses 0.4.
    assert found["pull_off_pressure"] - found["pull_off_pressure_resolution_error"] == pytest.approx(-2, abs=0.083)
    plain = path_results(series(curve(separation), separation), "gap")
    assert plain["pull_off_pressure"] - plain["pull_off_pressure_resolution_error"] > -1.6


def test_the_work_begins_where_the_pressure_is_none_between_two_states():
    known = series([2.0, 1.0, -1.0, -2.0, 0.0], [0.0, 1.0, 2.0, 3.0, 5.0], [0.0, 0.0, 0.0, 0.0, -0.1], ends_apart=True)
    # From 1.5 on: a triangle of ½ by 1, 1.5, a triangle of 2 by 2; then what the last state holds.
    assert path_results(known, "gap")["work_of_separation"] == pytest.approx(0.25 + 1.5 + 2 + 0.1)


def test_the_work_is_that_of_the_last_retraction():
    """Of a cycle that ends in contact and one that ends under tension nothing but the second way out counts."""
    deep, shallow = there_and_back(3e-10, 2e-9), there_and_back(1.1 * LAW.equilibrium_distance, 2e-9)
    both, last = (path_results(flat(gaps), "gap") for gaps in (np.concatenate([deep, shallow[1:]]), shallow))
    assert both == pytest.approx(last, rel=1e-12)
    turned_again = np.concatenate([shallow, deep[: deep.size // 3]])  # and not what comes after it
    assert path_results(flat(turned_again), "gap")["work_of_separation"] == last["work_of_separation"]


def test_what_the_rule_leaves_and_where_a_jump_lies_is_the_error_of_the_work():
    coarse = path_results(flat(there_and_back(3e-10, 2e-9, 30)), "gap")
    # Branches count by their energy: only the way to balance is the rule's, of a step of 7 % where the core is stiff.
    assert coarse["work_of_separation"] == pytest.approx(0.69, rel=1e-2)
    assert 1e-3 * 0.69 < coarse["work_of_separation_resolution_error"] < 0.05 * 0.69
    known = series([0.0, -1.0, -0.2, 0.0], [0.0, 1.0, 1.2, 2.0], [-2.0, -1.5, -2.0, -1.92], ends_apart=True)
    jump = path_results(known, "gap")
    assert jump["work_of_separation"] == pytest.approx(2.0 + 0.62)  # ½ (1 + 0.2) 0.2 and the half that was stored
    assert jump["work_of_separation_resolution_error"] == pytest.approx(0.5 * 0.8 * 0.2)


def test_approach_gains_what_separation_takes_less_what_jumps_lose():
    """A reversible path gains its work of adhesion; one that jumps in gains less by the loss."""
    gaps = there_and_back(3e-10, 2e-9)
    both = path_results(replace(flat(gaps), begins_apart=True), "gap")
    assert both["work_of_approach"] == pytest.approx(both["work_of_separation"], rel=1e-9)
    assert "work_of_approach" not in path_results(flat(gaps), "gap"), "the way to the first state is not known"
    # In by −1 from 4 to 2, a jump that loses 0.4 at constant separation, by springs of 4 to p = 1, and back by 2.
    separation, pressure = [4.0, 3.0, 2.0, 2.0, 1.5, 1.25, 1.5, 2.0], [-1.0, -1.0, -1.0, -2.0, 0.0, 1.0, 0.0, -2.0]
    energy = [-0.5, -1.5, -2.5, -2.9, -3.4, -3.275, -3.4, -2.9]
    known = replace(series(pressure, separation, energy), begins_apart=True)
    assert path_results(known, "gap")["work_of_approach"] == pytest.approx(0.5 + 2 + 0.5)


def test_the_spring_of_a_machine_is_in_the_books_of_its_jumps():
    """A body of two branches, p = 0 and p = −2 from s = 1 on, snaps in on a spring of compliance one by its length."""
    body = np.array([[0.0, 2.0, 0.0], [0.0, 1.0, 0.0], [-2.0, -1.0, -4.0]])
    far = beyond_spring(body, 1.0)
    assert far.tolist() == [[0, 2, 0], [0, 1, 0], [-2, 1, -2]]  # ½ p² of energy, extended by 2
    assert beyond_spring(far, -1.0).tolist() == body.tolist()
    found = path_results(PathSeries(np.concatenate([far, [[-2.0, 0.9, -2.2]]]), compliance=1.0), "approach")
    assert found["jump_in_separation"] == 1.0, "that of the surfaces"
    assert found["jump_in_pressure"] == 0.0


@pytest.mark.parametrize("left", [0.0, 0.02, 0.04])
def test_pressure_at_a_fold_is_within_its_error(left):
    """p = −√(s − 1) − 1 folds at s = 1; the last state is some way before it and the next one 0.04 beyond that."""
    last = 1 + left
    separation = np.array([1.5, last + 0.1, last, last - 0.04])
    branch = -np.sqrt(separation[:3] - 1) - 1
    pressure, energy = np.append(branch, -9.0), np.array([0.0, 0.0, 0.0, -9.0])
    for i in range(1, 3):
        energy[i] = energy[i - 1] - 0.5 * (pressure[i] + pressure[i - 1]) * (separation[i] - separation[i - 1])
    found = path_results(series(pressure, separation, energy), "gap")
    assert found["jump_in_pressure"] == branch[2]
    # Two thirds of it where the fold is at the next state.
    assert abs(branch[2] + 1) <= found["jump_in_pressure_resolution_error"] * (1 + 1e-12) / 1.5 < 0.5


def test_forces_and_energies_are_those_of_the_nominal_area():
    found = path_results(flat(there_and_back(3e-10, 2e-9)), "gap")
    total = with_forces(found, 2e-12)
    assert found.items() <= total.items()
    for name, force in (("pull_off_pressure", "pull_off_force"), ("work_of_separation", "separation_energy")):
        for end in ("", "_resolution_error"):
            assert total[force + end] == 2e-12 * found[name + end]
    assert set(total) - set(found) == {
        f"{name}{end}" for name in ("pull_off_force", "separation_energy") for end in ("", "_resolution_error")
    }


def test_states_between_the_points_of_a_path_are_no_turns():
    """A layer's mean separation goes back a little where the surfaces jump apart, at a mean gap that grows."""
    pressure, separation = [0.0, 1.0, -2.0, -1.0, -0.5, 0.0], [5.0, 1.0, 2.0, 1.9, 3.0, 5.0]
    whole = series(pressure, separation, np.zeros(6), ends_apart=True, points=np.array([0, 1, 5]))
    assert path_results(whole, "gap")["pull_off_pressure"] == -2.0


def test_what_a_path_does_not_show_is_not_said():
    gaps = there_and_back(3e-10, 2e-9)
    assert path_results(flat(gaps[: gaps.size // 2]), "gap") == {}, "approach alone"
    still_in_tension = gaps[gaps < LAW.peak_distance]
    assert path_results(flat(still_in_tension, ends_apart=False), "gap") == {}
    beyond_the_peak = flat(there_and_back(1.2 * LAW.peak_distance, 2e-9))
    assert "pull_off_pressure" not in path_results(beyond_the_peak, "gap")
    coarse = PathSeries(flat(gaps).states[:, :2], ends_apart=True)  # points too far apart to integrate
    for known in (flat(gaps, ends_apart=False), coarse):
        assert set(path_results(known, "gap")) == {"pull_off_pressure", "pull_off_pressure_resolution_error"}


def test_the_first_state_that_loses_energy_on_approach_is_the_jump():
    """Two branches p = −k (s − s₀) of a spring that lets go of 0.1 J/m² from one to the other."""
    separation = np.array([5.0, 4.0, 3.0, 2.99, 2.0, 1.0, 2.0, 3.0, 4.0]) * 1e-10
    pressure = np.array([-1.0, -2.0, -3.0, -9.0, -4.0, 1.0, -4.0, -9.0, -14.0]) * 1e8
    energy = np.zeros(9)
    energy[1:] = np.cumsum(-0.5 * (pressure[1:] + pressure[:-1]) * np.diff(separation))
    energy[3:] -= 0.1
    found = path_results(series(pressure, separation, energy), "gap")
    assert found["jump_in_pressure"] == -3e8
    assert found["jump_in_separation"] == 3e-10
    assert found["jump_in_separation_resolution_error"] == pytest.approx(1e-12)
    assert "jump_in_pressure" not in path_results(series(pressure, separation, energy), "pressure")
    smooth = energy + 0.1 * (np.arange(9) > 2)
    assert "jump_in_pressure" not in path_results(series(pressure, separation, smooth), "gap")


def test_a_pressure_that_rises_all_at_once_near_balance_is_no_jump():
    """p = −1 down to s = 1.5 and from there on a spring of 3, in steps of one: the rule misses 0.375 at the bend."""
    separation, pressure = np.array([4.0, 3.0, 2.0, 1.0, 0.5]), np.array([-1.0, -1.0, -1.0, 0.5, 2.0])
    energy = np.array([0.0, -1.0, -2.0, -2.625, -2.0])  # ∫−p ds in closed form
    assert "jump_in_pressure" not in path_results(series(pressure, separation, energy), "gap")
    jumped = energy - np.array([0.0, 0.0, 0.0, 1.0, 1.0])
    assert path_results(series(pressure, separation, jumped), "gap")["jump_in_separation"] == 2.0


@pytest.mark.parametrize(
    ("pressures", "separations", "lowest", "error"),
    [
        ([1.0, -0.5, -0.9, -1.0], [0, 1, 2, np.inf], -0.9, 0.1),
        ([1.0, -0.9, -1.0, -1.5], [0, 2, np.inf, np.inf], -0.9, 0.1),  # the first that was not held
        ([1.0, -0.5, -1.0, 1.0, -0.8, -1.1], [0, 1, np.inf, 0, 1, np.inf], -0.8, 0.3),
        ([1.0, -0.2], [0, np.inf], 0.0, 0.2),  # nothing pulls them apart without a load
    ],
)
def test_surfaces_under_a_load_pull_off_between_what_held_and_what_did_not(pressures, separations, lowest, error):
    found = path_results(series(np.array(pressures), np.array(separations, float)), "pressure")
    assert found == {"pull_off_pressure": lowest, "pull_off_pressure_resolution_error": pytest.approx(error)}


def test_surfaces_that_held_or_never_touched_do_not_pull_off():
    for separations in ([0.0, 1.0, 2.0], [np.inf, np.inf, np.inf]):
        assert path_results(series(np.array([1.0, -0.5, -0.9]), np.array(separations)), "pressure") == {}
    for control in ("pressure", "gap"):
        assert path_results(series_of([point(1.0, 1.0, converged=False)], control), control) == {}


def point(pressure, separation, area=0.1, **changes):
    known = {"mean_pressure": pressure, "applied_pressure": pressure, "mean_separation": separation}
    return {**known, "relative_contact_area": area, "converged": True, "detached": False, **changes}


def test_points_make_a_series_and_those_that_did_not_converge_none():
    steps = [
        point(1e9, 1e-10),
        point(-1e9, 3e-10, converged=False),
        point(-2e9, 2e-10),
        point(0.0, np.inf, 0.0, detached=True, applied_pressure=-3e9),
    ]
    found = series_of(steps, "pressure")
    assert found.states.tolist() == [[1e9, 1e-10], [-2e9, 2e-10], [-3e9, np.inf]]
    assert found.ends_apart
    assert not series_of(steps[:3], "pressure").ends_apart


def test_what_steps_passed_makes_a_finer_series():
    passed = {"passed_pressure": [2.0, 1.0], "passed_separation": [5.0, 4.0], "passed_energy": [0.0, 7.0]}
    found = series_of(2 * [point(1.0, 4.0, **passed, dissipated_energy=0.0)], "gap")
    assert found.states.tolist() == 2 * [[2, 5, 0], [1, 4, 7]]
    assert found.points.tolist() == [1, 3]
    relaxing = series_of(2 * [point(1.0, 4.0, **passed)], "gap")
    assert relaxing.states.tolist() == 2 * [[2, 5], [1, 4]], "where no jumps are booked the solid dissipates, too"
