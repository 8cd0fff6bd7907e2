"""Adaptive steps along a path of equilibria, with the energy that jumps dissipate.

Along a branch the work of the load is stored, D = −∫p ds − ΔU is zero, s the separation of the mean planes. Behind a
spring s is that of its far end, and U includes its energy. An adaptive step with more D than a share, that fails, or
that passes over the largest tension is halved, down to the least: a jump. A step that succeeds is followed by one twice
as long.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bem_adhesion.contacts.rough_contact import Contact
from bem_adhesion.solution import Outcome, Solution
from bem_adhesion.study.interface import separation_of
from bem_adhesion.study.trigger import NO_TRIGGER, Trigger, step_to_trigger
from contact_study.numerics import life
from contact_study.physics.solids import Elasticity
from contact_study.results.path_results import UNACCOUNTED, beyond_spring, lowest_between, unaccounted, undecided

# First step over the way between two points: the error of the trapezoidal rule could hide a jump in all of it.
FIRST_STEP = 0.25
PASSED_OVER = 0.01  # relative excess of the tension between two states over that at both


class EnergyLedger(NamedTuple):
    """A state on a path, and the energy dissipated in jumps so far with its uncertainty; energies per area (J/m²)."""

    position: float  # prescribed mean pressure (Pa), mean gap or approach (m)
    pressure: float
    separation: float  # of the mean planes, from any origin, or of the far end of a spring (m)
    energy: float  # with that spring's, and the plastic work so far, which is no loss of a jump
    attached: bool
    dissipated: float = 0.0
    uncertain: float = 0.0

    @property
    def state(self) -> np.ndarray:
        """Mean pressure, separation and energy."""
        return np.array([self.pressure, self.separation, self.energy])


def ledger_of(
    solution: Solution,
    position: float,
    solid: Elasticity,
    before: EnergyLedger | None = None,
    compliance: float = 0.0,
) -> EnergyLedger:
    """Return the ledger of a state, behind a spring of ``compliance`` per area (m/Pa).

    Separated surfaces are where the next step starts from, out of reach.
    """
    separation = float(np.mean(solution.displacement)) if solution.detached else separation_of(solution, solid)
    energy = solution.elastic_energy + solution.interaction_energy + solution.plastic_work
    pressure, far, stored = beyond_spring(np.array([np.mean(solution.pressure), separation, energy]), compliance)
    return EnergyLedger(
        position,
        *(float(pressure), float(far), float(stored)),
        not solution.detached,
        *((before.dissipated, before.uncertain) if before else ()),
    )


def passed_states(passed: Sequence[EnergyLedger], equilibrium_distance: float, compliance: float = 0.0) -> np.ndarray:
    """Return the states of ledgers without a spring, as in a dataset, see :attr:`InterfaceState.passed`."""
    rows = [
        (at.pressure, at.separation - equilibrium_distance, at.energy)
        if at.attached
        else (at.position, np.inf, at.energy)
        for at in passed
    ]
    return beyond_spring(np.array(rows).reshape(-1, 3), -compliance)


def adaptive_step(
    contact: Contact,
    state: np.ndarray,
    before: EnergyLedger,
    target: float,
    least: float,
    solid: Elasticity,
    noise: float = 0.0,
    compliance: float = 0.0,
    trigger: Trigger = NO_TRIGGER,
) -> tuple[Solution, list[EnergyLedger]]:
    """Go to the next point in steps whose work is accounted for, but for a ``noise`` (J/m²), or fail at the least step.

    A way inwards ends at the trigger, behind a spring of ``compliance`` per area (m/Pa).

    Returns the last state that converged, with the work of all steps, and the ledgers passed from ``before`` on.
    """
    if trigger.missing(before.pressure) <= 0:
        target = min(target, before.position)
    passed, length = [before], FIRST_STEP * (target - before.position)
    earlier = None  # the state at the start of the last step
    pairs, iterations, torn = 0.0, 0, False
    while True:
        life.beat()
        now = passed[-1]
        last = abs(length) >= abs(target - now.position)
        found = contact.step(state, target if last else now.position + length)
        pairs, iterations = pairs + found.fft_pairs, iterations + found.iterations
        new = ledger_of(found, target if last else now.position + length, solid, now, compliance)
        lost, exchanged = map(float, unaccounted(now.state, new.state)) if new.attached else (0.0, 0.0)
        detached = now.attached and not new.attached
        jumped = detached or abs(lost) > max(UNACCOUNTED * exchanged, noise)
        way = new.position - now.position
        stronger = _skips_pull_off(now, new, noise)
        if found.converged and len(passed) > 1 and _turns_too_sharply(passed[-2], now, new):
            way_before = now.position - passed[-2].position
            stronger |= abs(way) >= abs(way_before)
            if abs(way_before) > max(abs(way), least) and earlier is not None:
                passed.pop()
                state, earlier, length = earlier, None, 0.5 * way_before
                continue
        if (jumped or stronger or not found.converged) and abs(way) > least:
            length = 0.5 * way
            continue
        if not found.converged:
            ended = replace(found, state=state, outcome=Outcome.LEAST_STEP, fft_pairs=pairs, iterations=iterations)
            return ended, passed
        if way > 0 and trigger.missing(new.pressure) < 0:
            last = True
            if not jumped:
                found, at = step_to_trigger(contact, state, now.position, new.position, trigger)
                pairs, iterations = pairs + found.fft_pairs, iterations + found.iterations
                new = ledger_of(found, at, solid, now, compliance)
        if jumped and not detached:
            unknown = float(undecided(now.state, new.state))
            new = new._replace(dissipated=now.dissipated + max(lost, 0.0), uncertain=now.uncertain + unknown)
        state, earlier, length = found.state, state, 2 * way
        passed.append(new)
        torn = torn or bool(detached)
        if last:
            # A tension on surfaces that detached on the way to this point finds them apart.
            outcome = Outcome.DETACHED if torn and found.outcome is Outcome.APART else found.outcome
            return replace(found, fft_pairs=pairs, iterations=iterations, outcome=outcome), passed


def _skips_pull_off(before: EnergyLedger, after: EnergyLedger, noise: float) -> bool:
    """Return whether the tension within a step outwards exceeds that at its ends, beyond noise (J/m²)."""
    way = after.separation - before.separation
    if not (before.attached and after.attached) or way <= 0:
        return False
    lowest = float(lowest_between(before.state, after.state))
    return min(before.pressure, after.pressure) - lowest > max(-PASSED_OVER * lowest, noise / way)


def _turns_too_sharply(before: EnergyLedger, lowest: EnergyLedger, after: EnergyLedger) -> bool:
    """Return whether steps outwards on both sides of the largest tension are too long to determine it."""
    if not (before.attached and lowest.attached and after.attached):
        return False
    pressures = before.pressure, after.pressure
    outwards = before.separation < lowest.separation < after.separation
    if not outwards or lowest.pressure >= min(pressures):
        return False
    # The minimum of a parabola through three points is lower by at most an eighth of the height of the outer ones.
    return max(pressures) - lowest.pressure > -8 * PASSED_OVER * lowest.pressure
