"""The loading path by overdamped motion, which both simulations share; each gives its own forces."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.numerics.gradient_flow import Instant, Overdamped, Status, StepControl, at_rest, follow
from contact_study.results.state import Ensemble, InterfaceState
from contact_study.study.case import Case

_FIRST_STEP = 0.01  # in units of the relaxation time of the surface's longest wave
_MESSAGES = {
    Status.APART: "detached: no equilibrium in contact exists under this load, the surfaces separate",
    Status.TOO_LONG: "the iteration limit was reached before all was at rest: raise solver.max_iterations",
    Status.STUCK: "no step comes nearer to balance: raise solver.tolerance if the residual is close to it",
}


class Moving(Overdamped, Protocol):
    """A contact in overdamped motion: load as a mean pressure (Pa), drag in Pa/m, states in m."""

    def separated(self) -> np.ndarray:
        """The state of surfaces out of reach of each other."""

    def standing(self, state: np.ndarray, load: float) -> Any:
        """Evaluate a state at rest; apart if it is out of reach and the load does not close the gap."""

    def described(self, found: Any) -> InterfaceState:
        """Return the state for the campaign; its report counts the work of one step."""


def check(case: Case, key: str) -> None:
    """Raise InputError unless a case prescribes pressures; ``key`` is the key that selects overdamped motion."""
    if case.loading.control != "pressure":
        raise InputError(
            f'loading.control = "{case.loading.control}": {key} = "overdamped" brings the load to "pressure" only'
        )


def pace_of(case: Case, size: tuple[float, float]) -> StepControl:
    """Rate and accuracy of a case; the unit of time, over the friction, is that of an inverse stiffness (m/Pa)."""
    relaxation = 1 / float(case.solid.stiffness(2 * math.pi / max(size)))
    given = case.overdamped
    return StepControl(
        rate=given.loading_rate * case.solid.contact_modulus / relaxation,
        first=_FIRST_STEP * relaxation,
        allowed=given.step_error * case.law.length,
        most=case.solver.max_iterations,
    )


def solve_path(
    case: Case,
    moving: Moving,
    pace: StepControl,
    restart: Mapping[str, np.ndarray] | None = None,
    start: int = 0,
) -> Iterator[Ensemble]:
    """Yield the motion through each point of the path from number ``start`` on; its last state is the point's.

    It starts from ``restart``, kept after the point before or on the way; by default the surfaces are apart.
    """
    at = _Place(at_rest(moving.separated(), 0.0, pace)) if restart is None else _Place.unpacked(restart)
    for number in range(start, len(case.path)):
        yield Ensemble(_states(moving, pace, at, case.path[number][0]), discarded=None)


@dataclass
class _Place:
    """State of a motion, and the work of the present point so far."""

    instant: Instant
    pairs: float = 0.0
    evaluations: int = 0

    @property
    def packed(self) -> dict[str, np.ndarray]:
        at = self.instant
        return {
            "state": at.state,
            "move": np.atleast_1d(at.move),
            "clock": np.array([at.load, at.duration, at.wanted, at.time, self.pairs]),
            "counts": np.array([at.steps, self.evaluations]),
        }

    @classmethod
    def unpacked(cls, arrays: Mapping[str, np.ndarray]) -> "_Place":
        load, duration, wanted, time, pairs = map(float, arrays["clock"])
        steps, evaluations = map(int, arrays["counts"])
        return cls(Instant(arrays["state"], load, arrays["move"], duration, wanted, steps, time), pairs, evaluations)


def _states(moving: Moving, pace: StepControl, at: _Place, target: float) -> Iterator[InterfaceState]:
    """Yield the states on the way to a load and update ``at``; ends ready for the next load."""
    if target <= 0 and at.instant.steps == 0:
        first = moving.standing(at.instant.state, target)
        if first.apart:
            yield _timed(moving.described(first), at, at.instant.time, target)
            return
    for instant in follow(moving, at.instant, target, pace):
        fate = instant.fate
        found = moving.standing(instant.state, instant.load) if fate is Status.STUCK else instant.found
        state = moving.described(found)
        at.instant = instant
        at.pairs += state.report.fft_pairs
        at.evaluations += state.report.force_evaluations or 0
        report = replace(
            state.report,
            converged=fate in (Status.AT_REST, Status.APART),
            detached=fate is Status.APART,
            iterations=instant.steps,
            fft_pairs=at.pairs,
            force_evaluations=None if state.report.force_evaluations is None else at.evaluations,
            message=_MESSAGES.get(fate, ""),
        )
        if fate is not Status.MOVING:
            next_state, load = (moving.separated(), 0.0) if fate is Status.APART else (instant.state, instant.load)
            at.instant, at.pairs, at.evaluations = at_rest(next_state, load, pace, instant.time), 0.0, 0
        yield _timed(replace(state, report=report), at, instant.time, instant.load)


def _timed(state: InterfaceState, at: _Place, time: float, load: float) -> InterfaceState:
    further = {**state.further, "overdamped_time": time, "overdamped_load": load}
    return replace(state, further=further, restart=at.packed)
