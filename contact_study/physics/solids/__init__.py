"""Elastic solids by the stiffness K(q) of their surface, one a file."""

from contact_study.physics.solids.base import Elasticity, contact_modulus_of
from contact_study.physics.solids.half_space import HalfSpace, HalfSpaceSection
from contact_study.physics.solids.layer import Layer, LayerSection
from contact_study.physics.solids.layered import Layered, LayeredSection
from contact_study.physics.solids.measured import Measured, MeasuredSection
from contact_study.physics.solids.tabulated import Tabulated
from contact_study.physics.solids.transversely_isotropic import TransverselyIsotropicSection
from contact_study.physics.solids.viscoelastic import Viscoelastic, ViscoelasticSection
from contact_study.study.schema.keys import TaggedUnion

__all__ = [
    "ELASTICITIES",
    "Elasticity",
    "HalfSpace",
    "Layer",
    "Layered",
    "Measured",
    "Tabulated",
    "Viscoelastic",
    "contact_modulus_of",
    "elasticity_of",
]

ELASTICITIES = TaggedUnion(
    "kind",
    {
        "half_space": HalfSpaceSection,
        "layer": LayerSection,
        "layered": LayeredSection,
        "transversely_isotropic": TransverselyIsotropicSection,
        "tabulated": MeasuredSection,
        "viscoelastic": ViscoelasticSection,
    },
)


def elasticity_of(solid: Elasticity | float) -> Elasticity:
    """The solid itself; a number is the contact modulus E* of a half-space (Pa).

    Raises
    ------
    ValueError
        If the number is not positive and finite.
    """
    return solid if isinstance(solid, Elasticity) else HalfSpace(solid)
