"""Adaptive steps along a path, of equilibria or in time, with the energy that jumps dissipate.

Along a branch the work of the load is stored, or lost by the solid's viscosity: D = −∫p ds − ΔU − ΔV is zero, s the
separation of the mean planes. Behind a spring s is that of its far end, and U includes its energy. An adaptive step
with more D than a share, that fails, or that passes over the largest tension is halved, down to the least: a jump. A
step that succeeds is followed by one twice as long, up to the longest.
"""

import math
from collections.abc import Callable, Sequence
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
NOISE = 1e-6  # unaccounted work of a step that counts as none, over the work of adhesion
PASSED_OVER = 0.01  # relative excess of the tension between two states over that at both


class EnergyLedger(NamedTuple):
    """A state on a path, and the energy dissipated in jumps so far with its uncertainty; energies per area (J/m²)."""

    position: float  # prescribed mean pressure (Pa), mean gap or approach (m); of a path in time the time (s)
    pressure: float
    separation: float  # of the mean planes, from any origin, or of the far end of a spring (m)
    energy: float  # with that spring's, and the plastic work so far, which is no loss of a jump
    attached: bool
    dissipated: float = 0.0
    uncertain: float = 0.0
    viscous: float = 0.0  # dissipated by the solid so far
    open: float = 0.0  # work of the steps that are no jumps, not accounted for so far

    @property
    def state(self) -> np.ndarray:
        """Mean pressure, separation, energy and viscous dissipation."""
        return np.array([self.pressure, self.separation, self.energy, self.viscous])


_CARRIED = ("dissipated", "uncertain", "viscous", "open")

# Takes a step from a solver's state and its ledger to a position; the ledger that it returns has the jumps so far.
Move = Callable[[np.ndarray, EnergyLedger, float], tuple[Solution, EnergyLedger]]


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
    state = np.array([np.mean(solution.pressure), separation, energy])
    pressure, far, stored = beyond_spring(state, compliance).tolist()
    found = EnergyLedger(position, pressure, far, stored, not solution.detached)
    return found if before is None else found._replace(**{name: getattr(before, name) for name in _CARRIED})


def losses_of(ledger: EnergyLedger) -> dict[str, float]:
    """Return what jumps have dissipated so far and its uncertainty (J/m²), by names in a dataset."""
    return {"dissipated_energy": ledger.dissipated, "dissipated_energy_resolution_error": ledger.uncertain}


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
    longest: float = math.inf,
) -> tuple[Solution, list[EnergyLedger]]:
    """Go to the next equilibrium of a path, behind a spring of ``compliance`` per area (m/Pa), see :func:`follow`."""

    def move(state: np.ndarray, now: EnergyLedger, position: float) -> tuple[Solution, EnergyLedger]:
        found = contact.step(state, position)
        return found, ledger_of(found, position, solid, now, compliance)

    def stop(state: np.ndarray, now: EnergyLedger, beyond: float) -> tuple[Solution, EnergyLedger]:
        found, position = step_to_trigger(contact, state, now.position, beyond, trigger)
        return found, ledger_of(found, position, solid, now, compliance)

    return follow(move, state, before, target, least, noise, UNACCOUNTED, trigger, stop, longest)


def follow(
    move: Move,
    state: np.ndarray,
    before: EnergyLedger,
    target: float,
    least: float,
    noise: float,
    accuracy: float,
    trigger: Trigger = NO_TRIGGER,
    stop: Move | None = None,
    longest: float = math.inf,
) -> tuple[Solution, list[EnergyLedger]]:
    """Go to the next point in steps whose work is accounted for, but for a ``noise`` (J/m²), or fail at the least step.

    The work is accounted for up to the ``accuracy``, a share of what is exchanged; a jump is a loss beyond UNACCOUNTED.
    A way inwards ends at the trigger, to which ``stop`` steps, given a position beyond it.

    Returns the last state that converged, with the work of all steps, and the ledgers passed from ``before`` on.
    """
    if trigger.missing(before.pressure) <= 0:
        target = min(target, before.position)
    passed, length = [before], float(np.clip(FIRST_STEP * (target - before.position), -longest, longest))
    earlier = None  # the state at the start of the last step
    pairs, iterations, torn = 0.0, 0, False
    while True:
        life.beat()
        now = passed[-1]
        last = abs(length) >= abs(target - now.position)
        found, new = move(state, now, target if last else now.position + length)
        pairs, iterations = pairs + found.fft_pairs, iterations + found.iterations
        detached = now.attached and not new.attached
        lost, exchanged = (0.0, 0.0) if detached else map(float, unaccounted(now.state, new.state))
        jumped = detached or abs(lost) > max(UNACCOUNTED * exchanged, noise)
        rough = detached or abs(lost) > max(accuracy * exchanged, noise)
        way = new.position - now.position
        stronger = _skips_pull_off(now, new, noise)
        if found.converged and len(passed) > 1 and _turns_too_sharply(passed[-2], now, new):
            way_before = now.position - passed[-2].position
            stronger |= abs(way) >= abs(way_before)
            if abs(way_before) > max(abs(way), least) and earlier is not None:
                passed.pop()
                state, earlier, length = earlier, None, 0.5 * way_before
                continue
        if (rough or stronger or not found.converged) and abs(way) > least:
            length = 0.5 * way
            continue
        if not found.converged:
            ended = replace(found, state=state, outcome=Outcome.LEAST_STEP, fft_pairs=pairs, iterations=iterations)
            return ended, passed
        if way > 0 and (left := trigger.missing(new.pressure)) <= 0:
            last = True
            if left < 0 and not jumped and stop is not None:
                found, new = stop(state, now, new.position)
                pairs, iterations = pairs + found.fft_pairs, iterations + found.iterations
                lost = float(unaccounted(now.state, new.state)[0])
        if jumped and not detached:
            unknown = float(undecided(now.state, new.state))
            new = new._replace(dissipated=now.dissipated + max(lost, 0.0), uncertain=now.uncertain + unknown)
        else:
            new = new._replace(open=now.open + lost)
        state, earlier, length = found.state, state, float(np.clip(2 * way, -longest, longest))
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
