"""The loading path by overdamped motion, which both simulations share; each gives its own forces.

η du/dt = −∂E/∂u under a slowly changing load until all is at rest; time is in units of η. Implicit Euler: u_{n+1}
minimises E(u) + |u − u_n|²/2τ at the load of its end. The local error, ½τ²ü, is the distance to the point that the
velocity before leads to, times τ/(τ + τ_before) (K. E. Brenan, S. L. Campbell and L. R. Petzold, Numerical Solution of
Initial-Value Problems in DAEs, 1989).
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any, Protocol

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.numerics import life
from contact_study.results.state import Ensemble, InterfaceState
from contact_study.study.case import Case

# A step that errs by e of what is allowed is followed, or replaced, by one _SAFETY e^(−1/2) times as long, in limits.
_SAFETY, _SMALLEST_GROWTH, _LARGEST_GROWTH, _NOT_FOUND = 0.9, 0.2, 3.0, 0.3
# Limits of τ over the first one: rounding dominates shorter steps, longer ones feel no friction.
_SHORTEST, _LONGEST = 1e-12, 1e15
_FIRST_STEP = 0.01  # in units of the relaxation time of the surface's longest wave


class Status(Enum):
    """State of a motion."""

    MOVING = "moving"
    AT_REST = "at rest"
    APART = "apart"
    TOO_LONG = "too long"
    STUCK = "stuck"


_MESSAGES = {
    Status.APART: "detached: no equilibrium in contact exists under this load, the surfaces separate",
    Status.TOO_LONG: "the iteration limit was reached before all was at rest: raise solver.max_iterations",
    Status.STUCK: "no step comes nearer to balance: raise solver.tolerance if the residual is close to it",
}


class Moving(Protocol):
    """A contact in overdamped motion: load as a mean pressure (Pa), drag in Pa/m, states in m."""

    def advance(self, state: np.ndarray, load: float, drag: float) -> Any:
        """Find the minimum of E(u) + drag |u − state|²/2 next to ``state``; None without success.

        It has its ``state``, is ``at_rest`` if it balances without friction, ``apart`` if no force stops it any more.
        """

    def beside_saddle(self, state: np.ndarray, load: float) -> np.ndarray | None:
        """Find a state of lower energy next to one at rest that is no minimum; None for a minimum."""

    def separated(self) -> np.ndarray:
        """The state of surfaces out of reach of each other."""

    def standing(self, state: np.ndarray, load: float) -> Any:
        """Evaluate a state at rest; apart if it is out of reach and the load does not close the gap."""

    def described(self, found: Any) -> InterfaceState:
        """Return the state for the campaign; its report counts the work of one step."""


@dataclass(frozen=True)
class Instant:
    """A motion at one time: u, the load, the last step and its result."""

    state: np.ndarray
    load: float
    move: np.ndarray | float  # change of u in the last step
    duration: float  # τ of the last step
    wanted: float  # τ to try next
    steps: int = 0
    time: float = 0.0  # since the motion began
    fate: Status = Status.MOVING
    found: Any = None


@dataclass(frozen=True)
class StepControl:
    """Speed and accuracy of a motion."""

    rate: float  # largest change of the load in a unit of time
    first: float  # τ to try first
    allowed: float  # largest local error of a step, in the unit of the state
    most: int  # steps


def at_rest(state: np.ndarray, load: float, pace: StepControl, time: float = 0.0) -> Instant:
    """Begin a motion at rest."""
    return Instant(state, load, 0.0, pace.first, pace.first, time=time)


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
    case: Case, moving: Moving, pace: StepControl, restart: Mapping[str, np.ndarray] | None = None, start: int = 0
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


def follow(moving: Moving, at: Instant, target: float, pace: StepControl) -> Iterator[Instant]:
    """Bring the load to its target and wait for rest; yield every step, the last with a fate other than ``MOVING``."""
    while True:
        life.beat()
        moved = _stepped(moving, at, target, pace)
        if moved is None:
            yield replace(at, fate=Status.STUCK)
            return
        at = moved
        if moved.found.apart:
            at = replace(at, fate=Status.APART)
        elif at.load == target and moved.found.at_rest:
            lower = moving.beside_saddle(at.state, target)
            at = replace(at, fate=Status.AT_REST) if lower is None else replace(at, state=lower, move=0.0)
        if at.fate is Status.MOVING and at.steps >= pace.most:
            at = replace(at, fate=Status.TOO_LONG)
        yield at
        if at.fate is not Status.MOVING:
            return


def _stepped(moving: Moving, at: Instant, target: float, pace: StepControl) -> Instant | None:
    """The next instant; None where no length of a step has a solution."""
    tau = at.wanted
    while tau > _SHORTEST * pace.first:
        change = target - at.load
        load = target if abs(change) <= pace.rate * tau else at.load + float(np.copysign(pace.rate * tau, change))
        found = moving.advance(at.state, load, 1 / tau)
        if found is None:
            tau *= _NOT_FOUND
            continue
        move = found.state - at.state
        ratio = tau / at.duration
        error = float(np.max(np.abs(move - ratio * at.move))) * ratio / (1 + ratio)
        growth = _LARGEST_GROWTH if error == 0 else _SAFETY * (pace.allowed / error) ** 0.5
        growth = min(max(growth, _SMALLEST_GROWTH), _LARGEST_GROWTH)
        if error <= pace.allowed:
            wanted = min(growth * tau, _LONGEST * pace.first)
            return Instant(found.state, load, move, tau, wanted, at.steps + 1, at.time + tau, found=found)
        tau *= growth
    return None
