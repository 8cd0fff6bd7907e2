"""A loading path with steps of its own length: short where the state jumps, long where it follows the load.

Between two states in equilibrium the load does the work −∫p ds, s the separation of the mean planes, and along a branch
all of it is stored. What is not, D = −∫p ds − ΔU > 0 by the trapezoidal rule, was dissipated in a jump, or the step was
too long for the rule. A step that leaves more than a given share unaccounted for, or that does not converge, is
halved, down to the least step; what is left then is a jump, whose place is known to that step and whose D is added up:
to half the product of what pressure and separation change by in it. A step that succeeds is followed by one twice as
long.

On the way outwards the strongest pull is the pull-off. A step is halved, too, where the energy that it stores says that
a stronger pull than at its ends was passed in it; of two steps between which the pull is strongest the longer is, until
it hardly changes in them.
"""

from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np

from bem_adhesion.contacts.rough_contact import Contact
from bem_adhesion.solution import Outcome, Solution
from contact_study.physics.solids import Elasticity
from contact_study.results.path_results import UNACCOUNTED, lowest_between, unaccounted, undecided

# Share of the way between two points that the first step tries. In a step of the whole way a jump may be lost in what
# the rule makes of so long a way; that one is in each of three is less likely.
FIRST_STEP = 0.25

# Share of the pressure by which a pull between two states may be stronger than at both.
PASSED_OVER = 0.01


@dataclass(frozen=True)
class EnergyLedger:
    """Where a path has come to.

    Parameters
    ----------
    position : float
        What is prescribed there: mean pressure (Pa), mean gap or approach (m).
    pressure : float
        Mean pressure (Pa).
    separation : float
        Of the mean planes, from any origin (m).
    energy : float
        Elastic and of the interaction, per area (J/m²).
    attached : bool
        Whether the surfaces are within reach of each other.
    dissipated : float
        In jumps so far, per area (J/m²).
    uncertain : float
        By how much that may be off: where within its step a jump lies is not known (J/m²).
    """

    position: float
    pressure: float
    separation: float
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
        """To be stored between the points of a path."""
        return np.array([float(value) for value in astuple(self)])

    @classmethod
    def of(cls, array: np.ndarray) -> "EnergyLedger":
        """What :attr:`array` was made of."""
        position, pressure, separation, energy, attached, *books = map(float, array)
        return cls(position, pressure, separation, energy, bool(attached), *books)


def separation_of(solution: Solution, solid: Elasticity) -> float:
    """Distance of the mean planes, without that of the heights (m)."""
    if solution.plane is not None and not solution.detached:
        return solution.plane
    # Nothing slides: all that parts mean gap and separation is the uniform compression of a layer, and what gave way.
    separation = float(np.mean(solution.gap)) - solid.compression(float(np.mean(solution.pressure)))
    yielded = solution.plastic_indentation
    return separation if yielded is None else separation - float(np.mean(yielded))


def account_of(
    solution: Solution, position: float, solid: Elasticity, before: EnergyLedger | None = None
) -> EnergyLedger:
    """The account of a state, the books carried on; surfaces apart are where the next step finds them, out of reach."""
    return EnergyLedger(
        position,
        float(np.mean(solution.pressure)),
        float(np.mean(solution.state)) if solution.detached else separation_of(solution, solid),
        solution.elastic_energy + solution.interaction_energy,
        not solution.detached,
        *((before.dissipated, before.uncertain) if before else ()),
    )


def states_of(passed: Sequence[EnergyLedger], equilibrium_distance: float) -> np.ndarray:
    """The states of the books as a dataset has them, see :attr:`InterfaceState.passed`."""
    rows = [
        (at.pressure, at.separation - equilibrium_distance, at.energy) if at.attached else (at.position, np.inf, 0.0)
        for at in passed
    ]
    return np.array(rows).reshape(-1, 3)


def follow(
    contact: Contact,
    state: np.ndarray,
    before: EnergyLedger,
    target: float,
    least: float,
    solid: Elasticity,
    noise: float = 0.0,
) -> tuple[Solution, list[EnergyLedger]]:
    """Go from one point of a path to the next in steps as long as the work of the load can be accounted for.

    Parameters
    ----------
    contact : Contact
        The contact.
    state : numpy.ndarray
        Where the path has come to, see :attr:`Solution.state`.
    before : Account
        The same place in the books.
    target : float
        The next point.
    least : float
        Least step, the resolution of a jump's place, in units of the target.
    solid : Elasticity
        The solid.
    noise : float, optional
        Work that is none (J/m²): what the solver's tolerance leaves, and the last of a law's reach.

    Returns
    -------
    Solution
        At the target, with the work of all steps. A step that does not converge is halved, too; where the least does
        not, it ends the path: what it left is returned, and as the state to go on from the last that did converge.
    list of Account
        The books of every state passed, from ``before`` on to the last that converged.
    """
    passed, length = [before], FIRST_STEP * (target - before.position)
    earlier = None  # the state that the last step began from
    pairs, iterations, torn = 0.0, 0, False
    while True:
        now = passed[-1]
        last = abs(length) >= abs(target - now.position)
        found = contact.step(state, target if last else now.position + length)
        pairs, iterations = pairs + found.fft_pairs, iterations + found.iterations
        new = account_of(found, target if last else now.position + length, solid, now)
        lost, exchanged = map(float, unaccounted(now.state, new.state)) if new.attached else (0.0, 0.0)
        parted = now.attached and not new.attached
        jumped = parted or abs(lost) > max(UNACCOUNTED * exchanged, noise)
        way = new.position - now.position
        stronger = _passes_over_pull(now, new, noise)
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
        if jumped and not parted:
            unknown = float(undecided(now.state, new.state))
            new = replace(new, dissipated=now.dissipated + max(lost, 0.0), uncertain=now.uncertain + unknown)
        state, earlier, length = found.state, state, 2 * way
        passed.append(new)
        torn |= parted
        if last:
            # Surfaces that this point has torn apart, and a tension that finds them so, are none that never met.
            outcome = Outcome.DETACHED if torn and found.outcome is Outcome.APART else found.outcome
            return replace(found, fft_pairs=pairs, iterations=iterations, outcome=outcome), passed


def _passes_over_pull(before: EnergyLedger, after: EnergyLedger, noise: float) -> bool:
    """Whether a step outwards leaves out a stronger pull than at its ends, beyond noise (J/m²)."""
    way = after.separation - before.separation
    if not (before.attached and after.attached) or way <= 0:
        return False
    lowest = float(lowest_between(before.state, after.state))
    left_out = min(before.pressure, after.pressure) - lowest
    return left_out > max(-PASSED_OVER * lowest, noise / way)


def _turns_too_sharply(before: EnergyLedger, lowest: EnergyLedger, after: EnergyLedger) -> bool:
    """Whether steps outwards on both sides of the strongest pull are too long to tell it."""
    if not (before.attached and lowest.attached and after.attached):
        return False
    pressures = before.pressure, after.pressure
    outwards = before.separation < lowest.separation < after.separation
    if not outwards or lowest.pressure >= min(pressures):
        return False
    # A parabola through three points goes an eighth of what the higher ones are above the lowest below it at most.
    return max(pressures) - lowest.pressure > -8 * PASSED_OVER * lowest.pressure
