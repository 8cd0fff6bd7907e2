"""Overdamped motion of small systems with a known answer: a spring, two wells, a saddle."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.optimize import minimize

from contact_study.numerics.gradient_flow import Instant, Status, StepControl, at_rest, follow

PACE = StepControl(rate=1.0, first=0.01, allowed=1e-3, most=100_000)


@dataclass(frozen=True)
class Point:
    state: np.ndarray
    at_rest: bool
    apart: bool = False


@dataclass
class System:
    """Of an energy E(u) and its gradient, pushed along −u_0 by the load; steps are solved for by SciPy."""

    energy: Callable
    gradient: Callable
    lower: Callable = lambda state: None
    apart: Callable = lambda state: False
    tolerance: float = 1e-6

    def force(self, state, load):
        return self.gradient(state) + load * np.eye(state.size)[0]

    def advance(self, state, load, drag):
        found = minimize(
            lambda u: self.energy(u) + load * u[0] + 0.5 * drag * np.sum((u - state) ** 2),
            state,
            jac=lambda u: self.force(u, load) + drag * (u - state),
            method="BFGS",
            options={"gtol": 1e-9},
        )
        residual = float(np.abs(self.force(found.x, load)).max())
        return Point(found.x, residual <= self.tolerance, self.apart(found.x))

    def beside_saddle(self, state, load):
        return self.lower(state)


def spring(stiffness=2.0, **options):
    return System(lambda u: 0.5 * stiffness * u @ u, lambda u: stiffness * u, **options)


def moments(system, start, target, pace):
    return list(follow(system, at_rest(np.array(start), 0.0, pace), target, pace))


def test_spring_relaxes_in_its_own_time_and_no_step_errs_by_more_than_is_allowed():
    """u = (F/k)(1 − e^(−kt)) under a load that is there at once; errors fall with the root of the one allowed."""
    errors = []
    for allowed in (4e-3, 1e-3):
        found = moments(spring(), [0.0], -3.0, replace(PACE, rate=1e9, allowed=allowed))
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

    class Moving(System):
        def advance(self, state, load, drag):
            calls.append(drag)
            return Point(state + 1 / (3 * drag), False)

    at = Instant(np.array([0.0]), 0.0, 0.0, 1.0, 3.0)
    next(follow(Moving(None, None), at, 0.0, replace(PACE, allowed=allowed)))
    assert len(calls) == tries


def test_load_rises_at_its_rate_and_is_then_held():
    found = moments(spring(tolerance=1.0), [0.0], -0.5, replace(PACE, rate=0.1))  # any state would be one of rest
    load = np.array([0.0] + [each.load for each in found])
    duration = np.array([each.duration for each in found])
    rising = load[1:] > -0.5
    assert rising.sum() > 5
    np.testing.assert_allclose(-np.diff(load)[rising], 0.1 * duration[rising], rtol=1e-9)
    assert load.min() == load[-1] == -0.5
    # Behind a steady load the spring lags by rate × η/k²; the first step's own error apart.
    last = np.flatnonzero(rising)[-1]
    assert -found[last].load / 2.0 - found[last].state[0] == pytest.approx(0.1 / 4, rel=0.1)


def test_rest_on_a_saddle_is_left_and_rest_in_a_valley_is_not():
    def lower(u):
        return u + np.array([0.0, 0.01]) if abs(u[1]) < 0.5 else None

    wells = System(lambda u: 0.25 * (u[1] ** 2 - 1) ** 2 + u[0] ** 2, lambda u: u * [2, u[1] ** 2 - 1], lower)
    end = moments(wells, [0.5, 0.0], 0.0, PACE)[-1]
    assert end.fate is Status.AT_REST
    np.testing.assert_allclose(end.state, [0, 1], atol=1e-5)


def test_ends_of_a_motion_are_told_apart():
    found = moments(spring(), [1.0], -3.0, replace(PACE, most=5))
    assert (len(found), found[-1].fate) == (5, Status.TOO_LONG)
    gone = moments(spring(apart=lambda state: state[0] > 1.0), [0.0], -3.0, PACE)
    assert gone[-1].fate is Status.APART
    assert gone[-1].state[0] > 1.0 >= gone[-2].state[0]

    class Rough(System):
        def advance(self, state, load, drag):
            return None if state[0] > 1.0 else super().advance(state, load, drag)

    stuck = moments(Rough(lambda u: 0.0 * u[0], lambda u: 0.0 * u), [0.0], -3.0, PACE)
    assert stuck[-1].fate is Status.STUCK
    assert stuck[-1].state is stuck[-2].state
