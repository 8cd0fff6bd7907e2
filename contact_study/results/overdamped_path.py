"""The loading path by overdamped motion, which both simulations share; each gives its own forces.

The mean pressure changes from point to point at a steady rate and is then held until the contact is at rest.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.numerics.gradient_flow import Advance, Instant, Overdamped, Status, StepControl, at_rest, follow
from contact_study.results.state import Ensemble, InterfaceState, SlowMotion, SolverReport
from contact_study.study.case import Case

# First time step, in units of the relaxation time of the surface's longest wave.
_FIRST_STEP = 0.01

_MESSAGES = {
    Status.MOVING: "",
    Status.AT_REST: "",
    Status.APART: "detached: no equilibrium in contact exists under this load, the surfaces separate",
    Status.TOO_LONG: "the iteration limit was reached before all was at rest: raise solver.max_iterations",
    Status.STUCK: "no step comes nearer to balance: raise solver.tolerance if the residual is close to it",
}

Found = TypeVar("Found", bound=Advance)


class Moving(Overdamped[Found], Protocol[Found]):
    """A contact in overdamped motion: load as a mean pressure (Pa), drag in Pa/m, states in m."""

    def separated(self) -> np.ndarray:
        """Return the state of surfaces out of reach of each other."""

    def standing(self, state: np.ndarray, load: float) -> Found:
        """Evaluate a state at rest; apart if it is out of reach and the load does not close the gap."""

    def described(self, found: Found) -> InterfaceState:
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
    moving: Moving[Found],
    pace: StepControl,
    restart: Mapping[str, np.ndarray] | None = None,
    start: int = 0,
) -> Iterator[Ensemble]:
    """Yield the motion through each point of the path from number ``start`` on; its last state is the point's.

    Parameters
    ----------
    case : Case
        The case.
    moving : Moving
        The contact.
    pace : StepControl
        :func:`pace_of` the case.
    restart : mapping, optional
        State after the point before ``start``, or on the way to it; default: separation.
    start : int, optional
        First point of the path.
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


def _states(moving: Moving[Found], pace: StepControl, at: _Place, target: float) -> Iterator[InterfaceState]:
    """Yield the states on the way to a load and update ``at``; ends ready for the next load."""
    if target <= 0 and at.instant.steps == 0:
        found = moving.standing(at.instant.state, target)
        if found.apart:
            slow = SlowMotion(at.instant.time, target)
            yield replace(moving.described(found), slow_motion=slow, restart=at.packed)
            return
    for instant in follow(moving, at.instant, target, pace):
        stuck = instant.fate is Status.STUCK
        state = moving.described(moving.standing(instant.state, instant.load) if stuck else _known(instant))
        at.instant = instant
        at.pairs += state.report.fft_pairs
        at.evaluations += state.report.force_evaluations or 0
        report, slow = _report(at, state.report), SlowMotion(instant.time, instant.load)
        if instant.fate is not Status.MOVING:
            _settle(moving, pace, at)
        yield replace(state, report=report, slow_motion=slow, restart=at.packed)


def _known(instant: Instant[Found]) -> Found:
    assert instant.found is not None
    return instant.found


def _report(at: _Place, of_step: SolverReport) -> SolverReport:
    """Report the work so far and the status of the motion."""
    fate = at.instant.fate
    return replace(
        of_step,
        converged=fate in (Status.AT_REST, Status.APART),
        detached=fate is Status.APART,
        iterations=at.instant.steps,
        fft_pairs=at.pairs,
        force_evaluations=None if of_step.force_evaluations is None else at.evaluations,
        message=_MESSAGES[fate],
    )


def _settle(moving: Moving[Found], pace: StepControl, at: _Place) -> None:
    """Prepare for the next load: at rest, or out of reach."""
    apart = at.instant.fate is Status.APART
    state, load = (moving.separated(), 0.0) if apart else (at.instant.state, at.instant.load)
    at.instant, at.pairs, at.evaluations = at_rest(state, load, pace, at.instant.time), 0.0, 0
