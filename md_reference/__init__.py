"""Atomistic reference: a harmonic block pressed on a rigid rough Lennard-Jones substrate.

A height array, a lattice, moduli and a pair potential make a contact; states follow from states under loads, see
:func:`rough_contact`. Whole studies are run by :func:`contact_study.run` or the command ``md-reference``.
"""

from contact_study import __version__
from md_reference.solution import Outcome, Solution
from md_reference.statics.contact import AtomisticContact, rough_contact

__all__ = ["AtomisticContact", "Outcome", "Solution", "__version__", "rough_contact"]


def __dir__() -> list[str]:
    return sorted(__all__)
