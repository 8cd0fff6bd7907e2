"""A loading path of equilibria: each point, or each step of the path's own, is the one that the last falls into."""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from bem_adhesion.contact import Contact, rough_contact
from bem_adhesion.interface import interface_state
from bem_adhesion.paths import Account, account_of, follow
from contact_study.observables.base import InterfaceState
from contact_study.problem.case import Case
from contact_study.problem.surface import Surface


def path_of_equilibria(
    case: Case, surface: Surface, restart: Mapping[str, np.ndarray] | None, start: int
) -> Iterator[InterfaceState]:
    """The equilibrium at each point of a case's path; parameters as :func:`bem_adhesion.run.solve_path`."""
    contact = _contact_of(case, surface)
    state = contact.separated() if restart is None else restart["state"]
    account = (
        _first_account(case, state) if restart is None or "account" not in restart else Account.of(restart["account"])
    )
    for value, _ in case.path[start:]:
        if account is None:
            solution = contact.step(state, value)
            if _adaptive(case):
                account = account_of(solution, value, case.solid)
        else:
            least = case.loading.resolution * max(map(abs, case.loading.path))
            solution, account = follow(contact, state, account, value, least, case.solid)
        state = solution.state
        stiffness = contact.stiffness(solution) if case.output.stiffness and solution.converged else None
        found = interface_state(case, solution, surface.grid.spacing, stiffness)
        if account is not None:
            found = replace(
                found,
                dissipated_energy=account.dissipated,
                detachment_pressure=account.detachment_pressure,
                restart={**found.restart, "account": account.array},
            )
        _warn_of_rim(case, found.contact)
        yield found


def _contact_of(case: Case, surface: Surface) -> Contact:
    solver = case.solver
    return rough_contact(
        surface.sampled,
        surface.grid.size,
        case.solid,
        case.law,
        case.loading.control,
        solver.tolerance,
        solver.max_iterations,
        max(1, solver.threads),
        case.elasticity.boundary,
        case.material.hardness,
    )


def _adaptive(case: Case) -> bool:
    return case.loading.adaptive and case.law.attracts


def _first_account(case: Case, separated: np.ndarray) -> Account | None:
    """Where a path with steps of its own begins: without load, out of reach; under other control at its first point."""
    if not (_adaptive(case) and case.loading.control == "pressure"):
        return None
    return Account(0.0, 0.0, float(separated.mean()), 0.0, False)


def _warn_of_rim(case: Case, contact: np.ndarray) -> None:
    """With free boundaries, where a point of the first or last row or column is in contact."""
    if case.elasticity.boundary == "free" and (contact[[0, -1]].any() or contact[:, [0, -1]].any()):
        warnings.warn(
            'elasticity.boundary = "free": contact reaches the rim of the surface; what would touch beyond it is '
            "missing: a larger surface.size has it",
            stacklevel=3,
        )
