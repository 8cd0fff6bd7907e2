"""Equilibria at zero temperature: each point of the path is the minimum reached from the state before it."""

import warnings
from collections.abc import Iterator, Mapping

import numpy as np

from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case
from md_reference.statics.contact import AtomisticContact
from md_reference.study.system import Predictor, build_contact, interface_state


def solve_path(
    case: Case,
    surface: Surface,
    restart: Mapping[str, np.ndarray] | None = None,
    start: int = 0,
    predictor: Predictor | None = None,
) -> Iterator[InterfaceState]:
    """Yield equilibria along the loading path, see :data:`md_reference.study.system.Method`.

    With a predictor's gap field the atoms start at their lateral rest positions, at the surface's height plus that gap.
    Where it returns None a warning names the point, and the atoms start from the state before.
    """
    return states(case, build_contact(case, surface), restart, start, predictor)


def states(
    case: Case,
    contact: AtomisticContact,
    restart: Mapping[str, np.ndarray] | None = None,
    start: int = 0,
    predictor: Predictor | None = None,
) -> Iterator[InterfaceState]:
    """Yield the states of :func:`solve_path` of an existing contact."""
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
