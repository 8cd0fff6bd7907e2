"""Slow motion against friction at zero temperature: the atoms go down the steepest descent from point to point."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from contact_study.campaign.worker import overdamped_path
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import Ensemble, InterfaceState
from contact_study.study.case import Case
from md_reference.statics.contact import AtomisticContact
from md_reference.statics.overdamped import Moved, OverdampedBlock
from md_reference.study.system import Predictor, build_contact, interface_state


class MovingAtoms(OverdampedBlock):
    """The atoms of a case in motion, as the campaign takes them."""

    def __init__(self, case: Case, contact: AtomisticContact, allowed: float):
        super().__init__(contact.energy, case.solver.tolerance, allowed)
        self._case = case
        self._contact = contact

    def separated(self) -> np.ndarray:
        """Displacement of the flat block just beyond the cutoff (m)."""
        return self._contact.separated()

    def described(self, found: Moved) -> InterfaceState:
        """A state of the atoms as one of the interface."""
        # What was done since belongs to this state, too: a run that goes on from it does none of it.
        equilibrium = replace(found.equilibrium, fft_pairs=found.equilibrium.fft_pairs + self._work())
        return interface_state(self._case, self._contact.solution(equilibrium))


def solve_path(
    case: Case,
    surface: Surface,
    restart: Mapping[str, np.ndarray] | None = None,
    start: int = 0,
    predictor: Predictor | None = None,
) -> Iterator[Ensemble]:
    """The motion along the path; at each point its states, the last of them at rest.

    Parameters
    ----------
    case, surface, restart, start
        As :data:`md_reference.study.system.Method`.
    predictor : callable, optional
        Not used: the atoms come down by themselves.
    """
    pace = overdamped_path.pace_of(case, surface.size)
    moving = MovingAtoms(case, build_contact(case, surface), pace.allowed)
    return overdamped_path.solve_path(case, moving, pace, restart, start)
