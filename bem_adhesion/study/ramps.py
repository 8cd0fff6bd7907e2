"""Ways of a load in time: at a constant rate to the next point of a path, or until the force reaches a trigger."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bem_adhesion.contacts.viscoelastic import ViscoelasticContact
from bem_adhesion.solution import Solution
from bem_adhesion.study.trigger import NO_TRIGGER, Trigger
from contact_study.study.case import Case

INSTANT = 1e-9  # time over the shortest relaxation time of a point that no way leads to: nothing relaxes in it


class Ramp(NamedTuple):
    """A load (Pa or m) that changes at a constant rate in a time (s)."""

    begin: float
    target: float
    duration: float

    def at(self, time: float) -> float:
        """Return the load after a time (s)."""
        way = self.target - self.begin
        return self.target if time == self.duration else self.begin + time / self.duration * way


def ramp_to(
    case: Case, number: int, ramp: Ramp, before: float, pressure: float, shortest: float
) -> tuple[Ramp, Trigger]:
    """Return the way to a point of a path from where a trigger has left the machine, and the trigger that may end it.

    A point that repeats the one before is a dwell: the machine stays where it is. A way further in from the trigger
    takes no time. Others go at their speed, or in their duration.

    Parameters
    ----------
    case : Case
        The case.
    number : int
        Of the point.
    ramp : Ramp
        From the machine's position to the point, in the time that the path gives (m, s).
    before : float
        Load at the point before, which a trigger may have kept the machine from (m).
    pressure : float
        Mean pressure at the start (Pa).
    shortest : float
        Shortest relaxation time (s).
    """
    trigger = Trigger.of(case)
    if case.loading.trigger_force is None:
        return ramp, trigger
    held = ramp._replace(target=ramp.begin)
    if number and ramp.target == before:
        return held, NO_TRIGGER
    if case.loading.speed is not None and ramp.begin != before:
        way = abs((ramp.target - ramp.begin) / (ramp.target - before))
        ramp = ramp._replace(duration=ramp.duration * way)
    if not ramp.duration or (ramp.target > ramp.begin and trigger.missing(pressure) <= 0):
        return held._replace(duration=INSTANT * shortest), NO_TRIGGER
    return ramp, trigger if ramp.target > ramp.begin else NO_TRIGGER


def step_until_trigger(
    contact: ViscoelasticContact,
    state: np.ndarray,
    pressure: float,
    ramp: Ramp,
    span: tuple[float, float],
    trigger: Trigger,
) -> tuple[Solution, float, float]:
    """Find within a step along a ramp when the force reaches the trigger, which its end exceeds; ``pressure`` begins.

    Returns the state, with the work of all solves, the energy dissipated on the way (J/m²), and the time (s). Of a jump
    across the trigger it is the state after it.
    """
    begin, end = span
    pairs, iterations, first = 0.0, 0, 1.0
    latest: tuple[float, Solution, float] | None = None

    def solve(share: float) -> tuple[Solution, float]:
        nonlocal pairs, iterations, latest
        way = share * (end - begin)
        found, lost = contact.step(state, ramp.at(end if share == 1 else begin + way), way)
        pairs, iterations = pairs + found.fft_pairs, iterations + found.iterations
        latest = share, found, lost
        return found, lost

    def missing(share: float) -> float:
        nonlocal first
        if share == 0:
            return 1 - pressure / trigger.pressure
        left = trigger.missing(float(np.mean(solve(share)[0].pressure)))
        if left <= 0:
            first = min(first, share)
        return left

    from scipy.optimize import brentq  # slow to import

    brentq(missing, 0.0, 1.0, xtol=1e-15)
    assert latest is not None  # both ends have been looked at
    found, lost = latest[1:] if latest[0] == first else solve(first)
    time = end if first == 1 else begin + first * (end - begin)
    return replace(found, fft_pairs=pairs, iterations=iterations), lost, time
