"""Loading paths of equilibria, in adaptive steps, and in time; solutions as the campaign's state of the interface.

Along a branch the work of the load is stored, D = −∫p ds − ΔU is zero, s the separation of the mean planes. An adaptive
step with more D than a share, that fails, or that passes over the largest tension is halved, down to the least: a jump.
A step that succeeds is followed by one twice as long. In time the load changes at a constant rate, in equal steps.
"""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from bem_adhesion.contacts.rough_contact import Contact, contact_between
from bem_adhesion.contacts.viscoelastic import ViscoelasticContact
from bem_adhesion.operators import Progress
from bem_adhesion.solution import Outcome, Solution
from contact_study.numerics import life
from contact_study.physics.process_zone import TOO_COARSE
from contact_study.physics.solids import Elasticity, Viscoelastic
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.path_results import UNACCOUNTED, lowest_between, unaccounted, undecided
from contact_study.results.state import InterfaceState, SolverReport
from contact_study.study.case import Case

# First step over the way between two points: the error of the trapezoidal rule could hide a jump in all of it.
FIRST_STEP = 0.25
PASSED_OVER = 0.01  # relative excess of the tension between two states over that at both
_NOISE = 1e-6  # unaccounted work of a step that counts as none, over the work of adhesion
_RIM_TENSION = 0.01  # over the law's peak, below which no warning is given: grids err by as much in the pull-off
_TRACED = 128**2  # points of a grid from which on iterations are reported; on smaller ones that costs some per cent


def solver_options(case: Case, points: int) -> dict[str, Any]:
    """Return the options of a contact of so many points that a case gives its solver."""
    given = case.solver
    limits = {"tolerance": given.tolerance, "max_iterations": given.max_iterations, "threads": max(1, given.threads)}
    return {"control": case.loading.control, "trace": _beat if points >= _TRACED else None, **limits}


def _beat(progress: Progress) -> None:
    """Pass on the beginning of an iteration."""
    if progress.phase == "iteration":
        life.beat(progress.residual)


def separation_of(solution: Solution, solid: Elasticity) -> float:
    """Return the distance of the mean planes, without that of the heights (m)."""
    if solution.plane is not None and not solution.detached:
        return solution.plane
    # Mean gap and separation differ by the uniform compression of a layer and by the indentation.
    separation = float(np.mean(solution.gap)) - solid.compression(float(np.mean(solution.pressure)))
    yielded = solution.plastic_indentation
    return separation if yielded is None else separation - float(np.mean(yielded))


def interface_state(
    case: Case, solution: Solution, spacing: tuple[float, float], stiffness: float | None = None
) -> InterfaceState:
    """Return the state of a case's interface; ``spacing`` (m) along y and x, ``stiffness`` −dp/dū if known (Pa/m)."""
    gap, pressure, yielded = solution.gap, solution.pressure, solution.plastic_indentation
    separation = separation_of(solution, case.solid) - case.law.equilibrium_distance
    further = {} if stiffness is None else {"contact_stiffness": stiffness}
    if yielded is not None:  # the pressure on a yielding point is the hardness throughout
        further["plastic_work"] = (case.material.hardness or 0.0) * float(np.mean(yielded))
    touching = case.law.in_contact(gap, pressure, case.contact_distance)
    numbers = case.law.equilibrium_distance, separation, solution.elastic_energy, solution.interaction_energy
    return InterfaceState(
        *(gap, pressure, touching, *numbers),
        report=SolverReport.of(solution, complementarity_residual=solution.complementarity_residual),
        restart={"state": solution.state},
        spacing=spacing,
        plastic_indentation=yielded,
        further=further,
        periodic=case.elasticity.boundary == "periodic",
    )


class EnergyLedger(NamedTuple):
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
    """Go to the next point in steps whose work is accounted for, but for a ``noise`` (J/m²), or fail at the least step.

    Returns the last state that converged, with the work of all steps, and the ledgers passed from ``before`` on.
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


def path_of_equilibria(
    case: Case, surface: Surface, restart: Mapping[str, np.ndarray] | None, start: int
) -> Iterator[InterfaceState]:
    """Yield the equilibrium at each point of a case's path; parameters as for :func:`solve_path`."""
    kind = case.solid, case.law, case.elasticity.boundary, case.material.hardness
    contact = contact_between(surface.sampled, surface.grid, *kind, **solver_options(case, surface.grid.points))
    state, ledger = contact.separated() if restart is None else restart["state"], None
    if restart is not None:
        ledger = EnergyLedger(*restart["account"].tolist()) if "account" in restart else None
    elif case.least_step is not None and case.loading.control == "pressure":  # with another control after one step
        ledger = EnergyLedger(0.0, 0.0, float(state.mean()), 0.0, False)
    # A flat punch has no surface beyond its rim.
    warned = set() if np.ptp(surface.sampled) else {"contact", "tension"}
    for number, (value, _) in enumerate(case.path[start:], start):
        passed: list[EnergyLedger] = []
        if ledger is None:
            solution = contact.step(state, value)
            if case.least_step is not None and solution.converged:
                ledger = ledger_of(solution, value, case.solid)
                passed.append(ledger)
        else:
            noise = _NOISE * case.law.work_of_adhesion
            assert case.least_step is not None  # only adaptive paths have a ledger
            solution, (_, *passed) = adaptive_step(contact, state, ledger, value, case.least_step, case.solid, noise)
            ledger = passed[-1] if passed else ledger
        state = solution.state
        stiffness = contact.stiffness(solution) if case.output.stiffness and solution.converged else None
        found = interface_state(case, solution, surface.grid.spacing, stiffness)
        if ledger is not None:
            losses = {"dissipated_energy": ledger.dissipated, "dissipated_energy_resolution_error": ledger.uncertain}
            found = replace(
                found,
                further={**found.further, **losses},
                passed=passed_states(passed, case.law.equilibrium_distance),
                restart={**found.restart, "account": np.array(ledger, float)},
            )
        _warn_of_rim(case, number, found, warned)
        yield found


def _warn_of_rim(case: Case, number: int, found: InterfaceState, warned: set[str]) -> None:
    """Warn once a path if, with free boundaries, the rim of the surface is in contact or under tension."""
    if case.elasticity.boundary != "free":
        return
    touches, pressure = (
        np.concatenate([field[[0, -1]].ravel(), field[1:-1, [0, -1]].ravel()])
        for field in (found.contact, found.pressure)
    )
    pull = -pressure / case.law.peak_tensile_stress if case.law.attracts else np.zeros(1)
    if touches.any():
        kind, words = "contact", "contact reaches the rim of the surface; what would touch beyond it"
    elif pull.max() > _RIM_TENSION:
        share, most = 100 * np.mean(pull > _RIM_TENSION), 100 * pull.max()
        kind, words = "tension", f"the law pulls at the rim of the surface, at {share:.0f} % of its points and with up"
        words += f" to {most:.3g} % of its peak; what it would pull beyond"
    else:
        return
    if kind not in warned:
        head = f'elasticity.boundary = "free": at {case.point_in_words(number)} {words}'
        warnings.warn(f"{head} is missing: a larger surface.size has it", stacklevel=3)
    warned |= {kind, "tension"}


class TimeState(NamedTuple):
    """Load on a path in time, time since its start (s), and energy dissipated so far (J/m²)."""

    position: float
    time: float = 0.0
    dissipated: float = 0.0


def steps_in_time(
    contact: ViscoelasticContact, state: np.ndarray, before: TimeState, target: float, duration: float, steps: int
) -> Iterator[tuple[Solution, TimeState]]:
    """Yield states from one point of a path to the next, with the work so far; the load changes at a constant rate."""
    now, pairs, iterations = before, 0.0, 0
    for number in range(1, steps + 1):
        share = number / steps
        position = target if number == steps else before.position + share * (target - before.position)
        solution, dissipated = contact.step(state, position, duration / steps)
        now = TimeState(position, before.time + share * duration, now.dissipated + dissipated)
        pairs, iterations = pairs + solution.fft_pairs, iterations + solution.iterations
        yield replace(solution, fft_pairs=pairs, iterations=iterations), now
        if not solution.converged:
            return
        state = solution.state


def path_in_time(
    case: Case, surface: Surface, solid: Viscoelastic, restart: Mapping[str, np.ndarray] | None, start: int
) -> Iterator[InterfaceState]:
    """Yield the states of a case's path with their times; parameters as for :func:`solve_path`."""
    loading = case.loading
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", TOO_COARSE)  # the review of the study warns for all cases
        options = solver_options(case, surface.grid.points)
        contact = ViscoelasticContact(surface.sampled, surface.grid.size, solid, case.law, **options)
    if restart is None:
        out_of_reach = contact.first_gap - case.law.equilibrium_distance
        state, now = contact.separated(), TimeState(0.0 if loading.control == "pressure" else out_of_reach)
    else:
        state, now = restart["state"], TimeState(*restart["moment"].tolist())
    for (target, _), duration in list(zip(case.path, case.durations, strict=True))[start:]:
        passed = []
        for solution, moment in steps_in_time(contact, state, now, target, duration, loading.time_steps):
            if solution.converged:
                passed.append(ledger_of(solution, moment.position, case.solid))
        state, now = solution.state, moment
        found = interface_state(case, solution, surface.grid.spacing)
        yield replace(
            found,
            further={"time": now.time, "viscous_dissipation": now.dissipated},
            passed=passed_states(passed, case.law.equilibrium_distance),
            restart={**found.restart, "moment": np.array(now)},
        )
