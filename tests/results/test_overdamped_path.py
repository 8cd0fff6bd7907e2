from collections.abc import Callable
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from contact_study.results.overdamped_path import Instant, Status, StepControl, at_rest, follow

PACE = StepControl(rate=1.0, first=0.01, allowed=1e-3, most=100_000)


@dataclass
class Spring:
    stiffness: float = 2.0
    apart: Callable = lambda state: False
    lower: Callable = lambda state: None
    tolerance: float = 1e-6

    def advance(self, state, load, drag):
        u = (drag * state - load) / (self.stiffness + drag)
        at_rest = abs(self.stiffness * u[0] + load) <= self.tolerance
        return SimpleNamespace(state=u, at_rest=at_rest, apart=self.apart(u))

    def beside_saddle(self, state, load):
        return self.lower(state)


def moments(system, start, target, pace=PACE):
    return list(follow(system, at_rest(np.array(start), 0.0, pace), target, pace))


def test_spring_relaxes_in_its_own_time_and_no_step_errs_by_more_than_is_allowed():
    """u = (F/k)(1 − e^(−kt)) under a load that is there at once; errors fall with the root of the one allowed."""
    errors = []
    for allowed in (4e-3, 1e-3):
        found = moments(Spring(), [0.0], -3.0, replace(PACE, rate=1e9, allowed=allowed))
        states, duration = np.array([(each.state[0], each.duration) for each in found]).T
        errors.append(np.max(np.abs(states - 1.5 * (1 - np.exp(-2.0 * np.cumsum(duration))))))
        assert states[-1] == pytest.approx(1.5, abs=1e-6)
        own = np.abs(states - 1.5 - (np.append(0.0, states[:-1]) - 1.5) * np.exp(-2.0 * duration)) / allowed
        # The estimate is the leading term; steps of 0.03/k and more know it to some ten per cent.
        assert np.max(own) < 1.2
    assert np.sum(own > 0.5) > len(found) / 2
    # First order in the step, whose square the local error is.
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.3)
    assert errors[1] < 0.05


@pytest.mark.parametrize(("allowed", "tries"), [(0.76, 1), (0.74, 2)])
def test_error_of_a_step_of_another_length_than_the_one_before(allowed, tries):
    """From rest a move of 1 in a time of 3 after one of 1 is off by τ/(τ + τ_before) of it, ¾."""
    calls = []

    class Moving(Spring):
        def advance(self, state, load, drag):
            calls.append(drag)
            return SimpleNamespace(state=state + 1 / (3 * drag), at_rest=False, apart=False)

    next(follow(Moving(), Instant(np.array([0.0]), 0.0, 0.0, 1.0, 3.0), 0.0, replace(PACE, allowed=allowed)))
    assert len(calls) == tries


def test_load_rises_at_its_rate_and_is_then_held():
    found = moments(Spring(tolerance=1.0), [0.0], -0.5, replace(PACE, rate=0.1))  # any state would be one of rest
    load, duration, time = np.array([(0.0, 0.0, 0.0)] + [(each.load, each.duration, each.time) for each in found]).T
    rising = load[1:] > -0.5
    assert rising.sum() > 5
    np.testing.assert_allclose(-np.diff(load)[rising], 0.1 * duration[1:][rising], rtol=1e-9)
    np.testing.assert_allclose(time, np.cumsum(duration), rtol=1e-9)
    assert load.min() == load[-1] == -0.5
    # Behind a steady load the spring lags by rate × η/k²; the first step's own error apart.
    last = np.flatnonzero(rising)[-1]
    assert -found[last].load / 2.0 - found[last].state[0] == pytest.approx(0.1 / 4, rel=0.1)


def test_ends_of_a_motion_are_told_apart():
    found = moments(Spring(), [1.0], -3.0, replace(PACE, most=5))
    assert (len(found), found[-1].fate) == (5, Status.TOO_LONG)
    gone = moments(Spring(apart=lambda state: state[0] > 1.0), [0.0], -3.0)
    assert gone[-1].fate is Status.APART
    assert gone[-1].state[0] > 1.0 >= gone[-2].state[0]
    beside = [np.array([9.0]), None]  # of a saddle at 1.5, then of none
    end = moments(Spring(lower=lambda state: beside.pop(0)), [0.0], -3.0)
    assert (end[-1].fate, end[-1].state[0]) == (Status.AT_REST, pytest.approx(1.5, abs=1e-6))
    assert max(each.state[0] for each in end) == 9.0

    class Rough(Spring):
        def advance(self, state, load, drag):
            return None if state[0] > 1.0 else super().advance(state, load, drag)

    stuck = moments(Rough(0.0), [0.0], -3.0)
    assert stuck[-1].fate is Status.STUCK
    assert stuck[-1].state is stuck[-2].state
