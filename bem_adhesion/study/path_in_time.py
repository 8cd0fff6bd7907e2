"""Loading paths in time, of viscoelastic solids: the load changes at a constant rate, in equal steps."""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bem_adhesion.contacts.viscoelastic import ViscoelasticContact
from bem_adhesion.solution import Solution
from bem_adhesion.study.adaptive import ledger_of, passed_states
from bem_adhesion.study.interface import adhesion_of, interface_state, solver_options
from contact_study.physics.process_zone import TOO_COARSE
from contact_study.physics.solids import Viscoelastic
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case


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
        options = solver_options(case, surface.grid.points) | {"work_of_adhesion": adhesion_of(case, surface.grid)}
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
        found = interface_state(case, solution, surface)
        yield replace(
            found,
            further={"time": now.time, "viscous_dissipation": now.dissipated},
            passed=passed_states(passed, case.law.equilibrium_distance),
            restart={**found.restart, "moment": np.array(now)},
        )
