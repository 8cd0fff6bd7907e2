"""A loading path of the continuum in overdamped motion."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from bem_adhesion.contacts.overdamped import Moved, OverdampedContact
from bem_adhesion.study.state import interface_state
from contact_study.physics.surfaces.surface import Surface
from contact_study.results import overdamped_path
from contact_study.results.state import Ensemble, InterfaceState
from contact_study.study.case import Case


def overdamped_motion(
    case: Case, surface: Surface, restart: Mapping[str, np.ndarray] | None, start: int
) -> Iterator[Ensemble]:
    """Yield the motion through each point of a case's path; parameters as for :func:`solve_path`."""
    pace = overdamped_path.pace_of(case, surface.size)
    moving = _MovingContinuum(case, surface, pace.allowed)
    yield from overdamped_path.solve_path(case, moving, pace, restart, start)


class _MovingContinuum(OverdampedContact):
    """The contact of a case in overdamped motion, with states for the campaign."""

    def __init__(self, case: Case, surface: Surface, allowed: float):
        given = case.solver
        super().__init__(
            surface.sampled,
            surface.grid,
            case.solid,
            case.law,
            tolerance=given.tolerance,
            max_iterations=given.max_iterations,
            threads=max(1, given.threads),
            allowed=allowed,
        )
        self._case = case
        self._spacing = surface.grid.spacing

    def described(self, found: Moved) -> InterfaceState:
        """Return a state of the contact as one of the interface."""
        stiffness = None
        if self._case.output.stiffness:
            stiffness = self.stiffness(found.solution) if found.at_rest else np.nan
        # Work since then belongs to this state, too: a run that resumes from it does not repeat it.
        solution = replace(found.solution, fft_pairs=found.solution.fft_pairs + self._count_work())
        return interface_state(self._case, solution, self._spacing, stiffness)
