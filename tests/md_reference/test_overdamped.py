"""Atoms in slow motion against friction: down the steepest descent of their energy, to rest, and on from any stop."""

import dataclasses

import numpy as np
import pytest

import contact_study
from contact_study.results.overdamped_path import Status, at_rest, follow, pace_of
from contact_study.results.schema import TRAJECTORY
from contact_study.study.case import realise
from contact_study.study.study import make_study
from md_reference.study.cold import OverdampedAtoms
from md_reference.study.model import solve_path
from md_reference.study.system import build_contact
from tests.md_reference.systems import AREA, E_STAR, FLOW, R0, SMALL, apply, case_of, changed, groups_of, touching


class Motion:
    def __init__(self, case):
        self.case, self.load = case, case.path[0][0]
        self.contact = build_contact(case, realise(case))
        self.start = touching(self.contact.interface)

    def implicit(self, step_error, rate=1e9):  # at which the load is there from the first step on
        given = dataclasses.replace(self.case.overdamped, step_error=step_error, loading_rate=rate)
        pace = pace_of(dataclasses.replace(self.case, overdamped=given), self.case.lattice.size)
        moving = OverdampedAtoms(self.case, self.contact, pace.allowed)
        return list(follow(moving, at_rest(self.start, 0.0, pace), self.load, pace))

    def energy_and_slope(self, u, load):
        force, elastic = np.empty_like(u), apply(self.contact.block, u, True)
        energy = 0.5 * np.sum(u * elastic) + self.contact.interface.evaluate(u, force) + load * AREA * np.sum(u[2])
        slope = elastic - force
        slope[2] += load * AREA
        return energy, slope / AREA

    def explicit(self, residual, every=10):
        stiffest = self.contact.block.coefficients[2].max() / AREA + 8 * self.case.law.equilibrium_stiffness
        u, states = self.start, [self.start]
        while True:
            for _ in range(every):
                slope = self.energy_and_slope(u, self.load)[1]
                u = u - 0.5 / stiffest * slope
            states.append(u)
            if np.abs(slope).max() <= residual * E_STAR:
                return np.array(states), every * 0.5 / stiffest


def off_path(states, path):
    return max(np.sqrt(np.min(np.max((path - state) ** 2, axis=(1, 2, 3)))) for state in states) / R0


@pytest.fixture(scope="module")
def landing():
    return Motion(case_of((16, 16), 4, [5e8], surface={"rms_height": 3e-10, "cutoff_mode": 6}))


@pytest.mark.validation
def test_steps_stay_on_the_path_of_an_explicit_flow(landing):
    path, interval = landing.explicit(residual=3e-3)
    distances = []
    for step_error in (0.2, 0.05):
        found = landing.implicit(step_error)
        assert found[-1].fate is Status.AT_REST
        # Lateral slides, the slowest of all, still go on where the explicit path ends.
        distances.append(off_path([each.state for each in found if each.found.residual > 5e-3], path))
        np.testing.assert_allclose(found[-1].state[2], path[-1][2], rtol=0, atol=0.05 * R0)
    moving = [each for each in found if each.found.residual > 5e-3]
    times = [interval * np.argmin(np.max((path - each.state) ** 2, axis=(1, 2, 3))) for each in moving]
    # Measured 2 % on the way and 9 % at its end.
    np.testing.assert_allclose(times[5:], [each.time for each in moving[5:]], rtol=0.1)
    # Local errors of 0.05 r0 that the next steps damp.
    assert distances[1] < 0.05
    assert distances[1] < 0.75 * distances[0]
    area = [np.mean(landing.contact.interface.gap(u) < landing.case.contact_distance) for u in (path[-1], path[0])]
    assert area[0] > area[1] + 0.1


@pytest.mark.validation
def test_energy_never_rises_and_rest_is_a_minimum(landing):
    found, before = landing.implicit(0.1, 1e-2), landing.start
    for each in found:
        energies = [landing.energy_and_slope(u, each.load)[0] for u in (before, each.state)]
        # The sum over 256 atoms of energies that cancel rounds at 1e-12 of them.
        assert energies[1] <= energies[0] + 1e-11 * abs(energies[0])
        before = each.state
    (first, _), (last, slope) = (landing.energy_and_slope(u, landing.load) for u in (landing.start, before))
    assert first - last > 0.1 * abs(last)
    assert np.abs(slope).max() < 1.5e-8 * E_STAR
    assert found[-1].found.residual == pytest.approx(np.abs(slope).max() / E_STAR, abs=1e-10)


@pytest.mark.validation
def test_loop_of_contact_pull_off_and_new_contact(tmp_path):
    contact_study.run(changed(**FLOW), "atomistic", output=tmp_path / "md.nc")
    groups, touching = groups_of(tmp_path / "md.nc"), [0, 1, 4]
    root, series = groups["/"], groups[f"/{TRAJECTORY}"]
    np.testing.assert_array_equal(root.detached, [0, 0, 1, 1, 0])
    np.testing.assert_array_equal(root.converged, 1)
    np.testing.assert_allclose(root.mean_pressure[touching], [1e9, -1e9, 0.5e9], atol=2e-8 * E_STAR)
    assert np.all(root.residual <= 1e-8)
    assert not [name for name in root if name.endswith("_standard_error")]
    np.testing.assert_allclose(root.gap.mean(("y", "x"))[touching] - R0, root.mean_gap[touching], rtol=1e-9)
    area = series.relative_contact_area.values
    lengths = np.sum(np.isfinite(area), axis=1)
    assert lengths[3] == 1
    np.testing.assert_array_equal(lengths[touching], root.iterations[touching])
    np.testing.assert_array_equal(area[touching, lengths[touching] - 1], root.relative_contact_area[touching])
    np.testing.assert_array_equal(root.overdamped_load[[0, 1, 3, 4]], root.applied_pressure[[0, 1, 3, 4]])
    assert -10e9 < root.overdamped_load[2] < -1e9  # torn off on the way
    # Half the loads are on their way, at the rate of the pace.
    pace = pace_of(make_study(changed(**FLOW)).cases[0], (62.4e-10, 62.4e-10))
    time, load = (series[name].values[0, : lengths[0]] for name in ("overdamped_time", "overdamped_load"))
    rates = np.diff(load) / np.diff(time) / pace.rate
    assert np.all(rates <= 1 + 1e-9)
    assert np.count_nonzero(rates > 1 - 1e-9) > 5
    assert np.diff(root.overdamped_time).min() >= 0 < np.diff(time).min()
    assert root.overdamped_time[1] > root.overdamped_time[0] == time[-1]
    assert np.all(root.force_evaluations[[0, 1, 2, 4]] > root.iterations[[0, 1, 2, 4]])
    quasi = {**FLOW, "atomistic": {"method": "quasi_static", "temperature": 0}}
    still = contact_study.run(changed(**quasi), "atomistic")
    np.testing.assert_allclose(root.relative_contact_area, still.relative_contact_area, atol=1e-9)


def test_atoms_in_slow_motion_come_to_rest_under_a_light_load():
    sections = {"surface": {**SMALL, "rms_height": "2 angstrom", "cutoff_mode": 3}, "interaction": {}}
    path = {"path": ["1 GPa", "1 kPa", "2 kPa"]}  # 1e-8 E*, the tolerance, is 940 Pa
    found = contact_study.run(changed(**{**FLOW, **sections, "loading": path}), "atomistic")
    np.testing.assert_array_equal(found.converged, 1)
    # What may be missing of a load: contact_study.numerics.balance.
    np.testing.assert_allclose(found.mean_pressure[1:], [1e3, 2e3], rtol=1.01e-5)


def test_work_of_a_point_is_told_whether_the_run_was_stopped_before_it_or_not():
    case = make_study(changed(**{**FLOW, "loading": {"path": ["1 GPa", "0.5 GPa"]}})).cases[0]
    surface = realise(case)
    first, whole = (list(point.states)[-1] for point in solve_path(case, surface))
    (resumed,) = (list(point.states)[-1] for point in solve_path(case, surface, first.restart, 1))
    assert resumed.report == whole.report
