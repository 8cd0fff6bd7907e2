"""A loading path of equilibria, and adaptive steps: short where the state jumps, long where it follows the load.

Along a branch the work of the load is stored. A step whose D = −∫p ds − ΔU, s the separation of the mean planes, is
more than a share of it, that does not converge, or that passes over the largest tension is halved, down to the least;
D that remains is that of a jump. A step that succeeds is followed by one twice as long.
"""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np

from bem_adhesion.contacts.rough_contact import Contact, contact_between
from bem_adhesion.solution import Outcome, Solution
from bem_adhesion.study.state import interface_state, separation_of, solver_options
from contact_study.numerics import life
from contact_study.physics.solids import Elasticity
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.path_results import UNACCOUNTED, lowest_between, unaccounted, undecided
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case

# First step over the way between two points: the error of the trapezoidal rule could hide a jump in all of it.
FIRST_STEP = 0.25
PASSED_OVER = 0.01  # relative excess of the tension between two states over that at both
# Unaccounted work of a step that counts as none, over the work of adhesion.
_NOISE = 1e-6
# Tension at the rim, over the law's peak, below which no warning is given: grids that resolve a law err by about as
# much in the pull-off (docs/validation.md).
_RIM_TENSION = 0.01


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

    ``noise`` is what tolerance and tail may leave (J/m²). Returns the state at the target, or the last that converged
    if the least step does not, with the work of all steps, and the ledgers of all states passed, from ``before`` on.
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


def path_of_equilibria(
    case: Case, surface: Surface, restart: Mapping[str, np.ndarray] | None, start: int
) -> Iterator[InterfaceState]:
    """Yield the equilibrium at each point of a case's path; parameters as for :func:`solve_path`."""
    kind = case.solid, case.law, case.elasticity.boundary, case.material.hardness
    contact = contact_between(surface.sampled, surface.grid, *kind, **solver_options(case, surface.grid.points))
    state, ledger = contact.separated() if restart is None else restart["state"], None
    if restart is not None:
        ledger = EnergyLedger.of(restart["account"]) if "account" in restart else None
    elif case.least_step is not None and case.loading.control == "pressure":  # with another control after one step
        ledger = EnergyLedger(0.0, 0.0, float(state.mean()), 0.0, False)
    # A flat punch has no surface beyond its rim.
    warned = set() if np.ptp(surface.sampled) else {"contact", "tension"}
    for number, (value, _) in enumerate(case.path[start:], start):
        solution, ledger, passed = _next(case, contact, state, ledger, value)
        state = solution.state
        stiffness = contact.stiffness(solution) if case.output.stiffness and solution.converged else None
        found = interface_state(case, solution, surface.grid.spacing, stiffness)
        if ledger is not None:
            losses = {"dissipated_energy": ledger.dissipated, "dissipated_energy_resolution_error": ledger.uncertain}
            found = replace(
                found,
                further={**found.further, **losses},
                passed=passed_states(passed, case.law.equilibrium_distance),
                restart={**found.restart, "account": ledger.array},
            )
        _warn_of_rim(case, number, found, warned)
        yield found


def _next(
    case: Case, contact: Contact, state: np.ndarray, ledger: EnergyLedger | None, target: float
) -> tuple[Solution, EnergyLedger | None, list[EnergyLedger]]:
    """Solve the next point; return its solution, its ledger on an adaptive path, and the states passed on the way."""
    if ledger is None:
        solution = contact.step(state, target)
        if case.least_step is None or not solution.converged:
            return solution, None, []
        ledger = ledger_of(solution, target, case.solid)
        return solution, ledger, [ledger]
    assert case.least_step is not None  # only adaptive paths have a ledger
    noise = _NOISE * case.law.work_of_adhesion
    solution, (_, *passed) = adaptive_step(contact, state, ledger, target, case.least_step, case.solid, noise)
    return solution, passed[-1] if passed else ledger, passed


def _warn_of_rim(case: Case, number: int, found: InterfaceState, warned: set[str]) -> None:
    """Warn once a path if, with free boundaries, the rim of the surface is in contact or under tension."""
    if case.elasticity.boundary != "free":
        return
    head, tail = f'elasticity.boundary = "free": at {case.point_in_words(number)} ', "a larger surface.size has it"
    if _rim(found.contact).any():
        if "contact" not in warned:
            warnings.warn(
                f"{head}contact reaches the rim of the surface; what would touch beyond it is missing: {tail}",
                stacklevel=3,
            )
        warned |= {"contact", "tension"}
    elif case.law.attracts and "tension" not in warned:
        pull = -_rim(found.pressure) / case.law.peak_tensile_stress
        if pull.max() > _RIM_TENSION:
            warnings.warn(
                f"{head}the law pulls at the rim of the surface, at {100 * np.mean(pull > _RIM_TENSION):.0f} % of its "
                f"points and with up to {100 * pull.max():.3g} % of its peak; what it would pull beyond is missing: "
                f"{tail}",
                stacklevel=3,
            )
            warned.add("tension")


def _rim(field: np.ndarray) -> np.ndarray:
    """Return the points of the first and last row and column."""
    return np.concatenate([field[[0, -1]].ravel(), field[1:-1, [0, -1]].ravel()])
