"""Paths with steps of their own: jumps are found, located and paid for; smooth branches cost nothing."""

from itertools import pairwise

import numpy as np
import pytest

import contact_study
from bem_adhesion import HardWall, LennardJones104, rough_contact
from bem_adhesion.solution import Outcome, Solution
from bem_adhesion.study.adaptive import EnergyLedger, _skips_pull_off, _turns_too_sharply, adaptive_step
from contact_study.physics.solids import HalfSpace
from tests.bem_adhesion.paper_system import E_STAR, R0, study_table

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

SOLID = HalfSpace(E_STAR)
LAW = LennardJones104(0.69, R0)


def test_flat_surfaces_jump_in_for_their_work_of_adhesion_and_let_go_at_the_peak():
    contact = rough_contact(np.zeros((8, 8)), 4e-9, SOLID, LAW)
    state = contact.separated()
    account = EnergyLedger(0.0, 0.0, float(state.mean()), 0.0, False)
    least = 0.01 * LAW.peak_tensile_stress
    found, (*_, account) = adaptive_step(contact, state, account, 0.1 * LAW.peak_tensile_stress, least, SOLID)
    # Under no more than the least pressure, whose work over the reach of 3.6 r0 is what is left: Δγ + p Δs/2.
    reach = contact.separated().mean() - R0
    assert account.dissipated == pytest.approx(0.69, abs=0.51 * least * reach + 5e-3 * 0.69)
    gone, passed = adaptive_step(contact, found.state, account, -1.2 * LAW.peak_tensile_stress, least, SOLID)
    assert gone.outcome is Outcome.DETACHED
    after = passed[-1]
    assert after.dissipated == account.dissipated, "flying apart under the load is no dissipation between contacts"
    lowest = -min(place.pressure for place in passed) / LAW.peak_tensile_stress
    assert 0.99 <= lowest <= 1
    assert not after.attached
    still, _ = adaptive_step(contact, gone.state, after, -1.3 * LAW.peak_tensile_stress, least, SOLID)
    assert still.outcome is Outcome.APART
    _, (*_, again) = adaptive_step(contact, gone.state, after, 0.1 * LAW.peak_tensile_stress, least, SOLID)
    # As the first time; steps of another length meet the load at another pressure below the least.
    assert again.dissipated - after.dissipated == pytest.approx(account.dissipated, abs=0.51 * least * reach + 5e-3)


class Curve:
    """A contact of given pressures and energies along its separation; it converges up to a step and a load."""

    def __init__(self, pressure, energy, longest=np.inf, largest=np.inf, separation=lambda at: at):
        self.pressure, self.energy, self.separation = pressure, energy, separation
        self.longest, self.largest, self.steps = longest, largest, []

    def step(self, state, target):
        self.steps.append((float(state.mean()), target))
        fails = abs(target - state.mean()) > self.longest or target > self.largest
        outcome = Outcome.ITERATION_LIMIT if fails else Outcome.CONVERGED
        at, gap, pressure = (
            np.full((2, 2), value) for value in (target, self.separation(target), self.pressure(target))
        )
        return Solution(at, at, gap, pressure, self.energy(target), 0.0, 0.0, 1, 1.0, outcome, law=HardWall())


def test_a_jump_is_not_lost_in_what_the_rule_leaves_of_a_long_way():
    """Pulled by 2s − s², and at s = 0.6 falling by 1/6: by what the rule leaves of the way to s = 1."""
    dropping = Curve(lambda s: s**2 - 2 * s, lambda s: s**2 - s**3 / 3 - (s > 0.6) / 6)
    begin = EnergyLedger(0.0, 0.0, 0.0, 0.0, True)
    _, passed = adaptive_step(dropping, np.zeros((2, 2)), begin, 1.0, 0.01, HalfSpace(1.0))
    # The jump, and what the rule leaves of the least step it is in.
    assert passed[-1].dissipated == pytest.approx(1 / 6, abs=1e-5)
    assert 0 < passed[-1].uncertain < 0.01**2


# Either rule alone finds it: that of two states by their energies, from 0 or 0.5 on, or that of three.
@pytest.mark.parametrize(
    ("begin", "first"), [(0.0, 2.0), (0.5, 1.875), *((0.0, first) for first in (0.45, 0.6, 1.2, 2.4))]
)
def test_the_strongest_pull_is_not_passed_over(begin, first, monkeypatch):
    """Pulled by s exp(1 − s) at a separation s, at most by one."""
    monkeypatch.setattr("bem_adhesion.study.adaptive.UNACCOUNTED", np.inf)  # unaccounted work shortens steps, too
    if first in (0.45, 0.6, 1.2, 2.4):  # of 0.45 the last step is shorter than the one over the largest pull
        monkeypatch.setattr("bem_adhesion.study.adaptive._skips_pull_off", lambda *_: False)
    contact = Curve(lambda s: -s * np.exp(1 - s), lambda s: np.e - (1 + s) * np.exp(1 - s))
    found = contact.step(np.zeros((2, 2)), begin)
    account = EnergyLedger(begin, float(found.pressure.mean()), begin, found.elastic_energy, True)
    _, passed = adaptive_step(contact, found.state, account, begin + 4 * first, 1e-3, HalfSpace(1.0))
    # A hundredth, and what the parabola leaves.
    assert min(at.pressure for at in passed) < -0.98
    distances = [at.position for at in passed]
    assert distances == sorted(distances), "a step that was taken back is in no book"
    assert distances[-1] == begin + 4 * first
    assert set(pairwise(distances)) <= set(contact.steps), "each state follows from the one before it"
    # It costs a few steps, not the least one after the other.
    assert len(passed) < 40


def test_a_strongest_pull_is_told_by_energies_or_by_three_states():
    states = ((0, -0.93, 0), (1, -1, 1), (3, -0.5, 2.25))
    before, lowest, after = (EnergyLedger(x, p, x, e, True) for x, p, e in states)
    # Stored: the pull is one on average, and one at the end.
    assert [_skips_pull_off(before, lowest, noise) for noise in (0.0, 1.0)] == [True, False]
    assert not _skips_pull_off(lowest, before, 0.0), "inwards"
    # A pull of one at both ends that stores 1 + x is at most 1 + 1.5 x in between: a hundredth is let pass.
    even = EnergyLedger(0, -1, 0, 0, True)
    beyond = [even._replace(separation=1, energy=1 + x) for x in (0.006, 0.008)]
    assert [_skips_pull_off(even, after, 0.0) for after in beyond] == [False, True]
    assert _turns_too_sharply(before, lowest, after)
    assert not _turns_too_sharply(before, lowest, after._replace(pressure=-0.93))
    assert not _turns_too_sharply(before, lowest._replace(attached=False), after)


def test_where_the_least_step_does_not_converge_the_path_says_so_and_keeps_the_state_before():
    spring, solid = Curve(lambda p: p, lambda p: 0.5 * p**2, 1.0, 0.7, lambda p: 10 - p), HalfSpace(1.0)
    begin = EnergyLedger(0.0, 0.0, 10.0, 0.0, True)
    found, (*_, account) = adaptive_step(spring, np.zeros((2, 2)), begin, 1.0, 0.01, solid)
    assert found.outcome is Outcome.LEAST_STEP
    assert "loading.resolution" in found.message
    assert 0.69 <= account.position <= 0.7 < found.pressure.mean(), "beside it what the step left"
    assert found.state.mean() == account.position, "the last state that converged"
    back, (*_, account) = adaptive_step(spring, found.state, account, 0.2, 0.01, solid)
    assert back.converged
    assert account.position == 0.2


def test_a_reversible_path_dissipates_nothing_however_far_it_begins():
    table = study_table(32, size=100e-9, surface={"rms_height": 0.5e-9, "cutoff_mode": 6})
    table["material"]["youngs_modulus"] = 20e9
    table["interaction"] = {"law": "exponential", "work_of_adhesion": 0.1, "length": 0.5e-9}
    table["loading"] = {"control": "gap", "adaptive": True, "path": [40e-9, 0.1e-9, 40e-9]}
    found = contact_study.run(table, "continuum")
    assert float(found.dissipated_energy[-1]) == 0
    assert float(found["dissipated_energy_resolution_error"][-1]) == 0
    assert "jump_in_separation" not in found
    # What the branches store is exact; the balance lies between two states. A path in steps of 0.01 nm: 0.02002.
    assert float(found.work_of_separation) == pytest.approx(0.02002, rel=5e-3)
    assert float(found["work_of_separation_resolution_error"]) < 0.05 * 0.02
