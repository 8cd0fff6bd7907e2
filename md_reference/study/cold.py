"""Paths at zero temperature: the minimum reached from the state before, or steepest descent against friction."""

import warnings
from collections.abc import Iterator
from dataclasses import replace

from contact_study.physics.surfaces.surface import Surface
from contact_study.results import overdamped_path
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case
from md_reference.statics.contact import AtomisticContact
from md_reference.statics.overdamped import Moved, OverdampedBlock
from md_reference.study.system import Predictor, Restart, States, build_contact, interface_state


def quasi_static(case: Case, surface: Surface, restart: Restart, start: int, predictor: Predictor) -> States:
    """Yield equilibria along the loading path."""
    return equilibria(case, build_contact(case, surface), restart, start, predictor)


def equilibria(
    case: Case, contact: AtomisticContact, restart: Restart, start: int, predictor: Predictor
) -> Iterator[InterfaceState]:
    """Yield the equilibria of a contact along the loading path.

    With a predictor's gap field the atoms start at rest laterally, at that gap. Where there is none a warning names the
    point, and the atoms start from the state before.
    """
    state = contact.separated() if restart is None else restart["state"]
    for number in range(start, len(case.path)):
        value, branch = case.path[number]
        gap = None
        # Tension does not bring separated blocks together.
        if predictor is not None and not (contact.is_separated(state) and contact.control == "pressure" and value <= 0):
            gap = predictor(number)
            if gap is None:
                unit = "Pa" if contact.control == "pressure" else "m"
                warnings.warn(
                    f"the predictor holds no state in contact for point {number + 1} of the path, {value:g} {unit} "
                    f"({branch}): the atoms start from where they were",
                    stacklevel=2,
                )
        found = contact.step(state if gap is None else contact.predicted(gap), value)
        state = found.state
        yield interface_state(case, found)


class OverdampedAtoms(OverdampedBlock):
    """The atoms of a case in overdamped motion, for :mod:`contact_study.results.overdamped_path`."""

    def __init__(self, case: Case, contact: AtomisticContact, allowed: float):
        super().__init__(contact.energy, case.solver.tolerance, allowed)
        self._case = case
        self._contact = contact
        self.separated = contact.separated

    def described(self, found: Moved) -> InterfaceState:
        """Return a state of the atoms as one of the interface."""
        # Work done since then belongs to this state: a run that resumes from it repeats none of it.
        equilibrium = replace(found.equilibrium, fft_pairs=found.equilibrium.fft_pairs + self._work())
        return interface_state(self._case, self._contact.solution(equilibrium))


def overdamped(case: Case, surface: Surface, restart: Restart, start: int, predictor: Predictor) -> States:
    """Yield the states of each point, the last of them at rest."""
    pace = overdamped_path.pace_of(case, surface.size)
    moving = OverdampedAtoms(case, build_contact(case, surface), pace.allowed)
    return overdamped_path.solve_path(case, moving, pace, restart, start)
