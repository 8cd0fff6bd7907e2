"""Loading paths in time, of viscoelastic solids: the load changes at a constant rate, in equal or adaptive steps.

Adaptive steps hold work that is neither stored nor lost by the branches as that of a jump, at their least duration. It
is well below the shortest relaxation time, so that a jump meets the instantaneous modulus, and what takes longer is a
viscous slide.
"""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bem_adhesion.contacts.viscoelastic import ViscoelasticContact
from bem_adhesion.solution import Solution
from bem_adhesion.study.adaptive import NOISE, EnergyLedger, follow, ledger_of, losses_of, passed_states
from bem_adhesion.study.interface import approach_of, interface_state, solver_options
from bem_adhesion.study.ramps import Ramp, ramp_to, step_until_trigger
from bem_adhesion.study.trigger import NO_TRIGGER, Trigger, warn_of_trigger
from contact_study.physics.process_zone import TOO_COARSE
from contact_study.physics.solids import Viscoelastic
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case

# Unaccounted share of the work that a step exchanges. The error of a step's rates is of the same order in its duration.
ACCURACY = 0.002


class TimeState(NamedTuple):
    """Load on a path in time, time since its start (s), and energy dissipated so far (J/m²)."""

    position: float
    time: float = 0.0
    dissipated: float = 0.0


def steps_in_time(
    contact: ViscoelasticContact,
    state: np.ndarray,
    before: TimeState,
    target: float,
    duration: float,
    steps: int,
    trigger: Trigger = NO_TRIGGER,
    pressure: float = 0.0,
) -> Iterator[tuple[Solution, TimeState]]:
    """Yield states from one point of a path to the next, with the work so far; the load changes at a constant rate.

    The way ends at the trigger, its start at a mean pressure (Pa) below it.
    """
    now, pairs, iterations = before, 0.0, 0
    for number in range(1, steps + 1):
        share = number / steps
        position = target if number == steps else before.position + share * (target - before.position)
        solution, dissipated = contact.step(state, position, duration / steps)
        time = share * duration
        left = trigger.missing(float(solution.pressure.mean()))
        if solution.converged and left < 0:
            ramp, span = Ramp(before.position, target, duration), ((number - 1) / steps * duration, time)
            pairs, iterations = pairs + solution.fft_pairs, iterations + solution.iterations
            solution, dissipated, time = step_until_trigger(contact, state, pressure, ramp, span, trigger)
            position = ramp.at(time)
        now = TimeState(position, before.time + time, now.dissipated + dissipated)
        pairs, iterations = pairs + solution.fft_pairs, iterations + solution.iterations
        yield replace(solution, fft_pairs=pairs, iterations=iterations), now
        if not solution.converged or left <= 0:
            return
        state, pressure = solution.state, float(solution.pressure.mean())


def adaptive_interval(
    contact: ViscoelasticContact,
    state: np.ndarray,
    before: EnergyLedger,
    ramp: Ramp,
    least: float,
    noise: float,
    compliance: float = 0.0,
    trigger: Trigger = NO_TRIGGER,
) -> tuple[Solution, list[EnergyLedger]]:
    """Go along a ramp in adaptive steps of time, at least ``least`` (s), as :func:`follow`; positions are its times."""

    def booked(found: Solution, lost: float, now: EnergyLedger, time: float) -> tuple[Solution, EnergyLedger]:
        new = ledger_of(found, time, contact.solid, now, compliance)._replace(viscous=now.viscous + lost)
        return found, new._replace(separation=contact.first_gap) if found.detached else new

    def move(state: np.ndarray, now: EnergyLedger, time: float) -> tuple[Solution, EnergyLedger]:
        return booked(*contact.step(state, ramp.at(time), time - now.position), now, time)

    def stop(state: np.ndarray, now: EnergyLedger, beyond: float) -> tuple[Solution, EnergyLedger]:
        span = now.position, beyond
        found, lost, time = step_until_trigger(contact, state, now.pressure, ramp, span, trigger)
        return booked(found, lost, now, time)

    return follow(move, state, before._replace(position=0.0), ramp.duration, least, noise, ACCURACY, trigger, stop)


def path_in_time(
    case: Case, surface: Surface, solid: Viscoelastic, restart: Mapping[str, np.ndarray] | None, start: int
) -> Iterator[InterfaceState]:
    """Yield the states of a case's path with their times; parameters as for :func:`solve_path`."""
    loading, distance, compliance = case.loading, case.law.equilibrium_distance, case.machine_compliance
    shortest = min(solid.relaxation_times)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", TOO_COARSE)  # the review of the study warns for all cases
        options = solver_options(case, surface.grid)
        spring = loading.machine_stiffness
        contact = ViscoelasticContact(surface.sampled, surface.grid.size, solid, case.law, spring, **options)
    origin = 0.0 if loading.control == "pressure" else contact.first_gap - distance
    if loading.control == "approach":
        origin = float(surface.sampled.max() - surface.sampled.mean()) - origin
    state, now, ledger = contact.separated(), TimeState(origin), EnergyLedger(0.0, 0.0, contact.first_gap, 0.0, False)
    pressure = 0.0
    if restart is None and case.least_step and loading.control != "pressure":  # the law's far end has an energy, too
        begun, _ = contact.step(state, origin, 1e9 * max(solid.relaxation_times))
        state, ledger = begun.state, ledger_of(begun, 0.0, solid, compliance=compliance)
    elif restart is not None:
        state, now = restart["state"], TimeState(*restart["moment"].tolist())
        ledger = EnergyLedger(*restart["account"].tolist()) if case.least_step else ledger
        pressure = float(restart.get("held", 0.0))
    for number, duration in list(enumerate(case.loading.times(origin)))[start:]:
        target, before = case.path[number][0], case.path[number - 1][0] if number else origin
        ramp, trigger = ramp_to(case, number, Ramp(now.position, target, duration), before, pressure, shortest)
        further: dict[str, float] = {}
        account: dict[str, np.ndarray] = {}
        if case.least_step is None:
            ledgers = []
            way = ramp.target, ramp.duration, loading.time_steps, trigger, pressure
            for solution, moment in steps_in_time(contact, state, now, *way):
                if solution.converged:
                    ledgers.append(ledger_of(solution, moment.position, solid))
            now, passed = moment, passed_states(ledgers, distance)
        else:
            least = loading.resolution * shortest
            if ramp.target != ramp.begin:
                least = min(least, case.least_step * ramp.duration / abs(ramp.target - ramp.begin))
            noise = NOISE * max(case.law.work_of_adhesion, ledger.energy)
            given = ramp, least, noise, compliance, trigger
            solution, ledgers = adaptive_interval(contact, state, ledger, *given)
            ledger = ledgers[-1]
            loads = [at._replace(position=ramp.at(at.position)) for at in ledgers[1:]]
            viscous = [at.viscous for at in loads]
            passed = np.column_stack([passed_states(loads, distance, compliance), viscous])
            now = TimeState(ramp.at(ledger.position), now.time + ledger.position, ledger.viscous)
            further = {**losses_of(ledger), "unaccounted_work": ledger.open}
            account = {"account": np.array(ledger, float)}
        state = solution.state
        found = interface_state(case, solution, surface)
        pressure = float(found.pressure.mean())
        if compliance:
            further["approach"] = approach_of(found, compliance)
        if loading.trigger_force is not None:
            account["held"] = np.array(pressure)
            warn_of_trigger(case, number, pressure)
        yield replace(
            found,
            further={**found.further, "time": now.time, "viscous_dissipation": now.dissipated, **further},
            passed=passed,
            restart={**found.restart, "moment": np.array(now), **account},
        )
