"""Loading paths of equilibria, step by step or in adaptive steps."""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from bem_adhesion.adhesive.contact import reach
from bem_adhesion.study.adaptive import NOISE, EnergyLedger, adaptive_step, ledger_of, losses_of, passed_states
from bem_adhesion.study.interface import approach_of, contact_of, interface_state
from bem_adhesion.study.trigger import Trigger, step_to_trigger, warn_of_trigger
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case

_RIM_TENSION = 0.01  # over the law's peak, below which no warning is given: grids err by as much in the pull-off


def path_of_equilibria(
    case: Case, surface: Surface, restart: Mapping[str, np.ndarray] | None, start: int
) -> Iterator[InterfaceState]:
    """Yield the equilibrium at each point of a case's path; parameters as for :func:`solve_path`."""
    contact, compliance = contact_of(case, surface), case.machine_compliance
    state, ledger = contact.separated() if restart is None else restart["state"], None
    trigger, position = Trigger.of(case), min(0.0, case.law.equilibrium_distance - reach(case.law))  # out of reach
    if restart is not None:
        ledger = EnergyLedger(*restart["account"].tolist()) if "account" in restart else None
        position = float(restart.get("position", position))
    elif case.least_step is not None and case.loading.control == "pressure":  # with another control after one step
        apart = state if case.material.hardness is None else state[0]
        ledger = EnergyLedger(0.0, 0.0, float(apart.mean()), 0.0, False)
    # A flat punch has no surface beyond its rim.
    warned = set() if np.ptp(surface.sampled) else {"contact", "tension"}
    for number, (value, _) in enumerate(case.path[start:], start):
        passed: list[EnergyLedger] = []
        if ledger is None:
            solution, position = step_to_trigger(contact, state, position, value, trigger)
            if case.least_step is not None and solution.converged:
                ledger = ledger_of(solution, position, case.solid, compliance=compliance)
                passed.append(ledger)
        else:
            noise = NOISE * case.law.work_of_adhesion
            assert case.least_step is not None  # only adaptive paths have a ledger
            about = case.least_step, case.solid, noise, compliance, trigger, case.longest_step(ledger.position, value)
            solution, (_, *passed) = adaptive_step(contact, state, ledger, value, *about)
            ledger = passed[-1] if passed else ledger
        state = solution.state
        stiffness = contact.stiffness(solution) if case.output.stiffness and solution.converged else None
        found = interface_state(case, solution, surface, stiffness)
        if ledger is not None:
            found = replace(
                found,
                further={**found.further, **losses_of(ledger)},
                passed=passed_states(passed, case.law.equilibrium_distance, compliance),
                restart={**found.restart, "account": np.array(ledger, float)},
            )
        if compliance:
            found = replace(found, further={**found.further, "approach": approach_of(found, compliance)})
        if case.loading.trigger_force is not None:
            if ledger is None:
                found = replace(found, restart={**found.restart, "position": np.array(position)})
            warn_of_trigger(case, number, float(found.pressure.mean()))
        _warn_of_rim(case, number, found, warned)
        yield found


def _warn_of_rim(case: Case, number: int, found: InterfaceState, warned: set[str]) -> None:
    """Warn once a path if, with free boundaries, the rim of the surface is in contact or under tension."""
    boundary = case.elasticity.boundary
    if boundary == "periodic":
        return
    ends: list[tuple[Any, Any]] = []
    ends += [] if boundary == "free_x" else [([0, -1], slice(None))]
    ends += [] if boundary == "free_y" else [(slice(1, -1) if boundary == "free" else slice(None), [0, -1])]
    touches, pressure = (
        np.concatenate([field[end].ravel() for end in ends]) for field in (found.contact, found.pressure)
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
        head = f'elasticity.boundary = "{boundary}": at {case.point_in_words(number)} {words}'
        warnings.warn(f"{head} is missing: a larger surface.size has it", stacklevel=3)
    warned |= {kind, "tension"}
