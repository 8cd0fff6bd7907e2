"""Adaptive load steps: short where the state jumps, long where it follows the load.

Between two states the load does the work −∫p ds, s the separation of the mean planes, and along a branch all of it is
stored. The difference D = −∫p ds − ΔU by the trapezoidal rule was dissipated in a jump, or the step was too long for
the rule. A step that leaves more than a given share unaccounted for, that does not converge, or that passes over the
largest tension is halved, down to the least step; D that remains is that of a jump. A step that succeeds is followed by
one twice as long.
"""

from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np

from bem_adhesion.contacts.rough_contact import Contact
from bem_adhesion.solution import Outcome, Solution
from bem_adhesion.study.state import separation_of
from contact_study.numerics import life
from contact_study.physics.solids import Elasticity
from contact_study.results.path_results import UNACCOUNTED, lowest_between, unaccounted, undecided

# First step over the way between two points: the error of the trapezoidal rule could hide a jump in all of it.
FIRST_STEP = 0.25
PASSED_OVER = 0.01  # relative excess of the tension between two states over that at both


@dataclass(frozen=True)
class EnergyLedger:
    """A state on a path, and the energy dissipated in jumps so far with its uncertainty; energies per area (J/m²)."""

    position: float  # prescribed mean pressure (Pa), mean gap or approach (m)
    pressure: float
    separation: float  # of the mean planes, from any origin (m)
    energy: float
    attached: bool
    dissipated: float = 0.0
    uncertain: float = 0.0

    @property
    def state(self) -> np.ndarray:
        """Mean pressure, separation and energy."""
        return np.array([self.pressure, self.separation, self.energy])

    @property
    def array(self) -> np.ndarray:
        """Numbers to store between the points of a path."""
        return np.array(astuple(self), float)

    @classmethod
    def of(cls, array: np.ndarray) -> "EnergyLedger":
        """Restore a ledger from its :attr:`array`."""
        position, pressure, separation, energy, attached, *dissipated = map(float, array)
        return cls(position, pressure, separation, energy, bool(attached), *dissipated)


def ledger_of(
    solution: Solution, position: float, solid: Elasticity, before: EnergyLedger | None = None
) -> EnergyLedger:
    """Return the ledger of a state; separated surfaces are where the next step starts from, out of reach."""
    return EnergyLedger(
        position,
        float(np.mean(solution.pressure)),
        float(np.mean(solution.state)) if solution.detached else separation_of(solution, solid),
        solution.elastic_energy + solution.interaction_energy,
        not solution.detached,
        *((before.dissipated, before.uncertain) if before else ()),
    )


def passed_states(passed: Sequence[EnergyLedger], equilibrium_distance: float) -> np.ndarray:
    """Return the states of ledgers as in a dataset, see :attr:`InterfaceState.passed`."""
    rows = [
        (at.pressure, at.separation - equilibrium_distance, at.energy) if at.attached else (at.position, np.inf, 0.0)
        for at in passed
    ]
    return np.array(rows).reshape(-1, 3)


def adaptive_step(
    contact: Contact,
    state: np.ndarray,
    before: EnergyLedger,
    target: float,
    least: float,
    solid: Elasticity,
    noise: float = 0.0,
) -> tuple[Solution, list[EnergyLedger]]:
    """Go from one point of a path to the next in steps for which the work of the load is accounted for.

    Steps are at least ``least`` long, in units of the target; ``noise`` is what tolerance and tail may leave (J/m²).
    Returns the state at the target, with the work of all steps, and the ledgers of all states passed, from ``before``
    on. If even the least step does not converge it ends the path, with the state of the last step that converged.
    """
    passed, length = [before], FIRST_STEP * (target - before.position)
    earlier = None  # the state at the start of the last step
    pairs, iterations, torn = 0.0, 0, False
    while True:
        life.beat()
        now = passed[-1]
        last = abs(length) >= abs(target - now.position)
        found = contact.step(state, target if last else now.position + length)
        pairs, iterations = pairs + found.fft_pairs, iterations + found.iterations
        new = ledger_of(found, target if last else now.position + length, solid, now)
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
        if jumped and not detached:
            unknown = float(undecided(now.state, new.state))
            new = replace(new, dissipated=now.dissipated + max(lost, 0.0), uncertain=now.uncertain + unknown)
        state, earlier, length = found.state, state, 2 * way
        passed.append(new)
        torn |= detached
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
