"""A half-space that is stiffer or softer along its normal than in its plane: K(q) = E* q/2 with an E* of its own.

With Hooke's law in the plane (1, 2) and along the normal (3),

    E* = 2 √[(C₁₁C₃₃ − C₁₃²)/C₁₁ / (1/C₄₄ + 2/(√(C₁₁C₃₃) + C₁₃))]

(the tests hold it to an integration of the equations of elasticity). Isotropic, it is E/(1 − ν²).
"""

from dataclasses import dataclass

import numpy as np

from contact_study.errors import InputError
from contact_study.physics.solids.base import ElasticitySection
from contact_study.physics.solids.half_space import HalfSpace
from contact_study.study.schema.keys import key, quantity
from contact_study.study.schema.sections import MaterialSection


def stiffnesses(modulus: float, ratio: float, axial_modulus: float, axial_ratio: float) -> tuple[float, float, float]:
    """C₁₁, C₁₃ and C₃₃ (Pa).

    Parameters
    ----------
    modulus, ratio : float
        Young's modulus (Pa) and Poisson's ratio in the plane.
    axial_modulus, axial_ratio : float
        Young's modulus along the normal (Pa), and contraction in the plane over extension along the normal.

    Raises
    ------
    ValueError
        If no elastic solid has them: its energy would not be positive.
    """
    coupling = modulus / axial_modulus * axial_ratio**2
    rest = 1 - ratio - 2 * coupling
    if not rest > 0:
        raise ValueError(f"1 − ν − 2 ν_z² E/E_z = {rest:.3g} must be positive")
    return (
        modulus * (1 - coupling) / ((1 + ratio) * rest),
        modulus * axial_ratio / rest,
        axial_modulus * (1 - ratio) / rest,
    )


def indentation_modulus(c11: float, c13: float, c33: float, c44: float) -> float:
    """E* of a half-space whose normal is the axis of symmetry (Pa)."""
    along = 1 / c44 + 2 / (np.sqrt(c11 * c33) + c13)
    return 2 * float(np.sqrt((c11 * c33 - c13**2) / c11 / along))


@dataclass(frozen=True, kw_only=True)
class TransverselyIsotropicSection(ElasticitySection):
    """The material's E and ν are those in the plane."""

    words = (
        "transversely isotropic, along the normal E = {axial_modulus}, ν = {axial_poissons_ratio}, shear modulus "
        "{axial_shear_modulus}, in the plane "
    )
    may_be_free = True

    axial_modulus: float = key(quantity("Pa", positive=True), "Young's modulus along the normal of the surface")
    axial_poissons_ratio: float = key(
        quantity("1", minimum=-2.0, maximum=2.0), "contraction in the plane over extension along the normal"
    )
    axial_shear_modulus: float = key(quantity("Pa", positive=True), "shear modulus between plane and normal")

    def solid(self, material: MaterialSection) -> HalfSpace:
        try:
            known = stiffnesses(
                material.youngs_modulus, material.poissons_ratio, self.axial_modulus, self.axial_poissons_ratio
            )
        except ValueError as error:
            raise InputError(
                f"elasticity.axial_poissons_ratio = {self.axial_poissons_ratio:g}: no solid has it beside these "
                f"moduli, {error}"
            ) from None
        return HalfSpace(indentation_modulus(*known, self.axial_shear_modulus))
