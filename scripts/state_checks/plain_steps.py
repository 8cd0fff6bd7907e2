"""A path of equilibria in plain steps, each point checked."""

import numpy as np

from bem_adhesion import rough_contact
from contact_study.problem.case import Case
from scripts.state_checks import equilibrium
from scripts.state_checks.equilibrium import Surfaces
from scripts.state_checks.point import Point
from scripts.state_checks.verdict import Verdict


def follow(case: Case, surfaces: Surfaces, rng: np.random.Generator, verdict: Verdict) -> None:
    """Solve a case's path and check its states.

    Parameters
    ----------
    case : Case
        The case, whose solver is asked.
    surfaces : Surfaces
        The same as the checks know it.
    rng : numpy.random.Generator
        Of the changes.
    verdict : Verdict
        What is found is added there.
    """
    contact = rough_contact(
        surfaces.heights,
        surfaces.grid.size,
        case.solid,
        case.law,
        case.loading.control,
        boundary=case.elasticity.boundary,
    )
    state = contact.separated()
    for target, _ in case.path:
        found = contact.step(state, target)
        state = found.state
        verdict.states += 1
        if found.detached:
            verdict.detached += 1
        elif not found.converged:
            verdict.flagged.append(found.message)
        else:
            point = Point.of(found)
            equilibrium.check(surfaces, point, target, lambda start, to=target: contact.step(start, to), rng, verdict)
            compression = case.solid.compression_energy(float(point.pressure.mean()))
            equilibrium.check_energies(surfaces, point, target, compression, verdict)
