"""The force at which a way in ends under a prescribed approach: the state that has it, and warnings without it."""

import math
import warnings
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bem_adhesion.contacts.rough_contact import Contact
from bem_adhesion.solution import Solution
from contact_study.inputs.units import force
from contact_study.numerics.balance import LARGEST_SHARE, LIGHT
from contact_study.study.case import Case


class Trigger(NamedTuple):
    """Mean pressure beyond which no step leads inwards (Pa), and the share of it that a state may miss."""

    pressure: float = math.inf
    share: float = 0.0

    @classmethod
    def of(cls, case: Case) -> "Trigger":
        """Return the trigger of a case, out of reach without ``loading.trigger_force``; met as a load would be."""
        given = case.loading.trigger_force
        share = min(case.solver.tolerance / LIGHT, LARGEST_SHARE)
        return cls() if given is None else cls(given / case.nominal_area, share)

    def missing(self, pressure: float) -> float:
        """Return what a mean pressure lacks of the trigger, over the trigger; zero within the share."""
        missing = 1 - pressure / self.pressure
        return missing if abs(missing) > self.share else 0.0


NO_TRIGGER = Trigger()


def step_to_trigger(
    contact: Contact, state: np.ndarray, position: float, target: float, trigger: Trigger
) -> tuple[Solution, float]:
    """Go from an approach (m) to another one, or to the state between them that has the trigger's force.

    Returns the state, with the work of all solves, and its approach.
    """
    pairs, iterations = 0.0, 0
    found, below = contact.step(state, target), state  # the state to start from is that of the largest lower force

    def missing(solution: Solution) -> float:
        return trigger.missing(float(np.mean(solution.pressure)))

    if target <= position or not found.converged or missing(found) >= 0:
        return found, target

    def left(at: float) -> float:
        nonlocal found, below, pairs, iterations
        pairs, iterations = pairs + found.fft_pairs, iterations + found.iterations
        found = contact.step(below, at)
        if (away := missing(found)) > 0:
            below = found.state
        return away

    beyond, start = missing(found), left(position)
    root = position
    if start > 0:
        from scipy.optimize import brentq  # slow to import

        ends = {position: start, target: beyond}
        exact = 1e-15 * (target - position)  # SciPy's default is a length in metres
        root = brentq(lambda at: ends[at] if at in ends else left(at), position, target, xtol=exact)
    return replace(found, fft_pairs=pairs + found.fft_pairs, iterations=iterations + found.iterations), root


def warn_of_trigger(case: Case, number: int, mean_pressure: float) -> None:
    """Warn if a way in ends at this point of the path with another force than the trigger's."""
    values = [value for value, _ in case.path]
    here = values[number]
    arrives = not number or values[number - 1] < here  # in a dwell the force may relax
    after = next((value for value in values[number + 1 :] if value != here), here)
    if arrives and here > after and Trigger.of(case).missing(mean_pressure):
        warnings.warn(
            f"at {case.point_in_words(number)} the force is {force(mean_pressure * case.nominal_area)}, not yet "
            f"loading.trigger_force = {force(case.loading.trigger_force or 0.0)}, and the path goes back: use a larger "
            "value",
            stacklevel=2,
        )
