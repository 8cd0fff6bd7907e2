"""Elastic solids: the stiffness K(q) of a wave of their surface."""

from contact_study.physics.solids.base import Elasticity, HalfSpace, Layer, Layered, Viscoelastic, contact_modulus_of
from contact_study.physics.solids.function import FunctionSolid
from contact_study.physics.solids.plate import Plate
from contact_study.physics.solids.sheet import Sheet
from contact_study.physics.solids.tabulated import Measured, Tabulated

__all__ = [
    "Elasticity",
    "FunctionSolid",
    "HalfSpace",
    "Layer",
    "Layered",
    "Measured",
    "Plate",
    "Sheet",
    "Tabulated",
    "Viscoelastic",
    "contact_modulus_of",
    "elasticity_of",
]


def elasticity_of(solid: Elasticity | float) -> Elasticity:
    """Return the solid itself; a number is the contact modulus E* of a half-space (Pa), positive or ValueError."""
    return solid if isinstance(solid, Elasticity) else HalfSpace(solid)
