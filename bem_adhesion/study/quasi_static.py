"""A loading path of equilibria: each step finds the equilibrium that the last state descends to."""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from bem_adhesion.contacts.rough_contact import Contact, contact_between
from bem_adhesion.solution import Solution
from bem_adhesion.study.adaptive import EnergyLedger, adaptive_step, ledger_of, passed_states
from bem_adhesion.study.state import interface_state, solver_options
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case

# Unaccounted work of a step that counts as none, over the work of adhesion.
_NOISE = 1e-6
# Tension at the rim, over the law's peak, below which no warning is given: grids that resolve a law err by about as
# much in the pull-off (docs/validation.md).
_RIM_TENSION = 0.01


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
