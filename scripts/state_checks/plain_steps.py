"""A path of equilibria in plain steps, each point checked."""

import numpy as np

from bem_adhesion import Solution
from contact_study.study.case import Case
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
    contact = equilibrium.contact_of(case, surfaces)
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

            def again(start: np.ndarray, target: float = target) -> Solution:
                return contact.step(start, target)

            equilibrium.check_with_energies(case, surfaces, Point.of(found), target, again, rng, verdict)
