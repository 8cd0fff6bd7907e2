"""A loading path with steps of its own length: short where the state jumps, long where it follows the load.

Between two states in equilibrium the load does the work −∫p ds, s the separation of the mean planes, and along a branch
all of it is stored. What is not, D = −∫p ds − ΔU > 0 by the trapezoidal rule, was dissipated in a jump, or the step was
too long for the rule. A step that leaves more than a given share unaccounted for, or that does not converge, is
halved, down to the least step; what is left then is a jump, whose place is known to that step and whose D is added up.
A step that succeeds is followed by one twice as long.
"""

from dataclasses import dataclass, replace

import numpy as np

from bem_adhesion.contact import Contact
from bem_adhesion.solution import Outcome, Solution
from contact_study.problem.elasticity import Elasticity

# Share of the work and of the energy exchanged that a smooth step may leave unaccounted for.
UNACCOUNTED = 0.02


@dataclass(frozen=True)
class Account:
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
    detachment_pressure : float
        Lowest mean pressure that was held before the surfaces came apart, in the last step (Pa); else not a number.
    """

    position: float
    pressure: float
    separation: float
    energy: float
    attached: bool
    dissipated: float = 0.0
    detachment_pressure: float = np.nan

    @property
    def array(self) -> np.ndarray:
        """To be stored between the points of a path."""
        return np.array(
            [self.position, self.pressure, self.separation, self.energy, float(self.attached), self.dissipated]
        )

    @classmethod
    def of(cls, array: np.ndarray) -> "Account":
        """What :attr:`array` was made of."""
        position, pressure, separation, energy, attached, dissipated = map(float, array)
        return cls(position, pressure, separation, energy, bool(attached), dissipated)


def separation_of(solution: Solution, solid: Elasticity) -> float:
    """Distance of the mean planes, without that of the heights (m)."""
    if solution.plane is not None and not solution.detached:
        return solution.plane
    # Nothing slides: all that parts mean gap and separation is the uniform compression of a layer, and what gave way.
    separation = float(np.mean(solution.gap)) - solid.compression(float(np.mean(solution.pressure)))
    yielded = solution.plastic_indentation
    return separation if yielded is None else separation - float(np.mean(yielded))


def account_of(solution: Solution, position: float, solid: Elasticity, dissipated: float = 0.0) -> Account:
    """The account of a state."""
    return Account(
        position,
        float(np.mean(solution.pressure)),
        separation_of(solution, solid),
        solution.elastic_energy + solution.interaction_energy,
        not solution.detached,
        dissipated,
    )


def follow(
    contact: Contact, state: np.ndarray, before: Account, target: float, least: float, solid: Elasticity
) -> tuple[Solution, Account]:
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

    Returns
    -------
    Solution
        At the target, with the work of all steps. A step that does not converge is halved, too; where the least does
        not, it ends the path: what it left is returned, and as the state to go on from the last that did converge.
    Account
        The same place in the books, of the last state that converged.
    """
    now, length = replace(before, detachment_pressure=np.nan), target - before.position
    pairs, iterations = 0.0, 0
    while True:
        last = abs(length) >= abs(target - now.position)
        found = contact.step(state, target if last else now.position + length)
        pairs, iterations = pairs + found.fft_pairs, iterations + found.iterations
        new = account_of(found, target if last else now.position + length, solid, now.dissipated)
        new = replace(new, detachment_pressure=now.detachment_pressure)
        lost, exchanged = _lost(now, new)
        jumped = (now.attached and not new.attached) or abs(lost) > UNACCOUNTED * exchanged
        if (jumped or not found.converged) and abs(new.position - now.position) > least:
            length = 0.5 * (new.position - now.position)
            continue
        if not found.converged:
            ended = replace(found, state=state, outcome=Outcome.LEAST_STEP, fft_pairs=pairs, iterations=iterations)
            return ended, now
        if now.attached and not new.attached:
            new = replace(new, detachment_pressure=now.pressure)
        elif jumped:
            new = replace(new, dissipated=now.dissipated + max(lost, 0.0))
        state, now, length = found.state, new, 2 * (new.position - now.position)
        if last:
            return replace(found, fft_pairs=pairs, iterations=iterations), now


def _lost(before: Account, after: Account) -> tuple[float, float]:
    """Work of the load that is not in the energy (J/m²), and what was exchanged; none where surfaces are apart."""
    if not after.attached:
        return 0.0, 0.0
    work = -0.5 * (before.pressure + after.pressure) * (after.separation - before.separation)
    stored = after.energy - before.energy
    return work - stored, abs(work) + abs(stored)
