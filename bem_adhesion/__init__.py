"""Boundary-element solver of the adhesive contact of an elastic solid with a rough rigid one.

A height array, its size, a solid and a law make a contact; states follow from states under loads, see
:func:`rough_contact`. Whole studies are run by :func:`contact_study.run` or the command ``bem-adhesion``.
"""

from bem_adhesion.contacts.rough_contact import Contact, rough_contact
from bem_adhesion.contacts.viscoelastic import ViscoelasticContact
from bem_adhesion.gradients.gradient import Gradient, fold_gradient, gradient
from bem_adhesion.solution import Outcome, Solution
from contact_study import __version__
from contact_study.physics.laws import (
    Dugdale,
    DugdaleCore,
    Exponential,
    ExponentialCore,
    HardWall,
    LennardJones,
    LennardJones93,
    LennardJones104,
    Morse,
    Repulsive,
    TabulatedLaw,
    TractionLaw,
)
from contact_study.physics.solids import (
    Elasticity,
    FunctionSolid,
    HalfSpace,
    Layer,
    Layered,
    Measured,
    Plate,
    Sheet,
    Tabulated,
    Viscoelastic,
)

__all__ = [
    "Contact",
    "Dugdale",
    "DugdaleCore",
    "Elasticity",
    "Exponential",
    "ExponentialCore",
    "FunctionSolid",
    "Gradient",
    "HalfSpace",
    "HardWall",
    "Layer",
    "Layered",
    "LennardJones",
    "LennardJones93",
    "LennardJones104",
    "Measured",
    "Morse",
    "Outcome",
    "Plate",
    "Repulsive",
    "Sheet",
    "Solution",
    "Tabulated",
    "TabulatedLaw",
    "TractionLaw",
    "Viscoelastic",
    "ViscoelasticContact",
    "__version__",
    "fold_gradient",
    "gradient",
    "rough_contact",
]


def __dir__() -> list[str]:
    return sorted(__all__)
