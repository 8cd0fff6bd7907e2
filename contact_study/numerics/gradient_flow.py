"""Overdamped motion under a slowly changing load: η du/dt = −∂E/∂u until all is at rest; time is in units of η.

Implicit Euler: u_{n+1} minimises E(u) + |u − u_n|²/2τ at the load of its end. The local error, ½τ²ü, is the distance to
the point that the velocity before leads to, times τ/(τ + τ_before) (K. E. Brenan, S. L. Campbell and L. R. Petzold,
Numerical Solution of Initial-Value Problems in DAEs, 1989).
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any, Protocol

import numpy as np

from contact_study.numerics import life

# A step that errs by e of what is allowed is followed, or replaced, by one _SAFETY e^(−1/2) times as long, in limits.
_SAFETY, _SMALLEST_GROWTH, _LARGEST_GROWTH, _NOT_FOUND = 0.9, 0.2, 3.0, 0.3
# Limits of τ over the first one: rounding dominates shorter steps, longer ones feel no friction.
_SHORTEST, _LONGEST = 1e-12, 1e15


class Status(Enum):
    """State of a motion."""

    MOVING = "moving"
    AT_REST = "at rest"
    APART = "apart"
    TOO_LONG = "too long"
    STUCK = "stuck"


class Overdamped(Protocol):
    """A system in overdamped motion."""

    def advance(self, state: np.ndarray, load: float, drag: float) -> Any:
        """Find the minimum of E(u) + drag |u − state|²/2 next to ``state``; None without success.

        It has its ``state``, is ``at_rest`` if it balances without friction, ``apart`` if no force stops it any more.
        """

    def beside_saddle(self, state: np.ndarray, load: float) -> np.ndarray | None:
        """Find a state of lower energy next to one at rest that is no minimum; None for a minimum."""


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


def follow(system: Overdamped, at: Instant, target: float, pace: StepControl) -> Iterator[Instant]:
    """Bring the load to its target and wait for rest; yield every step, the last with a fate other than ``MOVING``."""
    while True:
        life.beat()
        moved = _stepped(system, at, target, pace)
        if moved is None:
            yield replace(at, fate=Status.STUCK)
            return
        at = moved
        if moved.found.apart:
            at = replace(at, fate=Status.APART)
        elif at.load == target and moved.found.at_rest:
            lower = system.beside_saddle(at.state, target)
            at = replace(at, fate=Status.AT_REST) if lower is None else replace(at, state=lower, move=0.0)
        if at.fate is Status.MOVING and at.steps >= pace.most:
            at = replace(at, fate=Status.TOO_LONG)
        yield at
        if at.fate is not Status.MOVING:
            return


def _stepped(system: Overdamped, at: Instant, target: float, pace: StepControl) -> Instant | None:
    """The next instant; None where no length of a step has a solution."""
    tau = at.wanted
    while tau > _SHORTEST * pace.first:
        change = target - at.load
        load = target if abs(change) <= pace.rate * tau else at.load + float(np.copysign(pace.rate * tau, change))
        found = system.advance(at.state, load, 1 / tau)
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
