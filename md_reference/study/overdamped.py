"""Overdamped relaxation at zero temperature: the atoms follow the steepest descent from point to point."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from contact_study.physics.surfaces.surface import Surface
from contact_study.results import overdamped_path
from contact_study.results.state import Ensemble, InterfaceState
from contact_study.study.case import Case
from md_reference.statics.contact import AtomisticContact
from md_reference.statics.overdamped import Moved, OverdampedBlock
from md_reference.study.system import Predictor, build_contact, interface_state


class OverdampedAtoms(OverdampedBlock):
    """The atoms of a case in overdamped motion, for :mod:`contact_study.campaign.worker.overdamped_path`."""

    def __init__(self, case: Case, contact: AtomisticContact, allowed: float):
        super().__init__(contact.energy, case.solver.tolerance, allowed)
        self._case = case
        self._contact = contact

    def separated(self) -> np.ndarray:
        """Return the displacement of the flat block just beyond the cutoff (m)."""
        return self._contact.separated()

    def described(self, found: Moved) -> InterfaceState:
        """Return a state of the atoms as one of the interface."""
        # Work done since then belongs to this state: a run that resumes from it repeats none of it.
        equilibrium = replace(found.equilibrium, fft_pairs=found.equilibrium.fft_pairs + self._work())
        return interface_state(self._case, self._contact.solution(equilibrium))


def solve_path(
    case: Case,
    surface: Surface,
    restart: Mapping[str, np.ndarray] | None = None,
    start: int = 0,
    predictor: Predictor | None = None,
) -> Iterator[Ensemble]:
    """Yield the states of each point, the last of them at rest; the predictor is not used.

    See :data:`md_reference.study.system.Method`.
    """
    pace = overdamped_path.pace_of(case, surface.size)
    moving = OverdampedAtoms(case, build_contact(case, surface), pace.allowed)
    return overdamped_path.solve_path(case, moving, pace, restart, start)
