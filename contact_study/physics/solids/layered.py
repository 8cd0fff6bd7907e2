"""An elastic layer bonded to an elastic half-space of another material: coatings, oxides, skins.

A layer 0 < z < d of shear modulus μ and Poisson's ratio ν on a half-space of μ_b, ν_b, whose upper face feels a normal
pressure p of wavenumber q and no shear, gives way there by 2p/(E* q) times

    S = [1 + 4 m qd e^(−2qd) − m n e^(−4qd)] / [1 − (m + n + 4 m (qd)²) e^(−2qd) + m n e^(−4qd)],

    m = (μ/μ_b − 1)/(μ/μ_b + 3 − 4ν),    n = 1 − 4(1 − ν)/[1 + (μ/μ_b)(3 − 4ν_b)],

E* that of the layer; the tests hold it to an integration of the equations of elasticity. On a rigid base it is the
bonded layer's. Short waves feel the layer, S → 1, long ones the base, S → E*/E*_b.
"""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from contact_study.numerics.arguments import positive
from contact_study.physics.solids.base import Elasticity, ElasticitySection
from contact_study.physics.solids.layer import check_poissons_ratio
from contact_study.study.schema.keys import key, quantity
from contact_study.study.schema.sections import MaterialSection


@dataclass(frozen=True)
class Layered(Elasticity):
    """A homogeneous isotropic layer on a half-space.

    Parameters
    ----------
    contact_modulus : float
        E* = E/(1 − ν²) of the layer (Pa).
    poissons_ratio : float
        ν of the layer, above −1 and up to 0.5.
    thickness : float
        d (m).
    base_modulus : float
        E*_b, the contact modulus of the half-space (Pa).
    base_poissons_ratio : float
        ν_b.

    Raises
    ------
    ValueError
        If a number is not possible.
    """

    poissons_ratio: float
    thickness: float
    base_modulus: float
    base_poissons_ratio: float

    def __post_init__(self) -> None:
        super().__post_init__()
        check_poissons_ratio("poissons_ratio", self.poissons_ratio)
        check_poissons_ratio("base_poissons_ratio", self.base_poissons_ratio)
        positive("thickness", self.thickness, "m")
        positive("base_modulus", self.base_modulus, "Pa")

    @property
    def layer_thickness(self) -> float:
        return self.thickness

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        q, ratio, base_ratio = np.asarray(wavenumber, dtype=float), self.poissons_ratio, self.base_poissons_ratio
        # E* = 2μ/(1 − ν).
        shear = self.contact_modulus * (1 - ratio) / (self.base_modulus * (1 - base_ratio))
        m = (shear - 1) / (shear + 3 - 4 * ratio)
        n = 1 - 4 * (1 - ratio) / (1 + shear * (3 - 4 * base_ratio))
        x = self.thickness * q
        decay = np.exp(-2 * x)
        above = 1 + 4 * m * x * decay - m * n * decay**2
        below = 1 - (m + n + 4 * m * x**2) * decay + m * n * decay**2
        return 0.5 * self.contact_modulus * q * below / above

    def keys(self, poissons_ratio: float) -> dict[str, Any]:
        return {
            "kind": "layered",
            "thickness": self.thickness,
            "base_youngs_modulus": self.base_modulus * (1 - self.base_poissons_ratio**2),
            "base_poissons_ratio": self.base_poissons_ratio,
        }

    def scaled(self, length: float, stress: float) -> Self:
        return replace(
            super().scaled(length, stress), thickness=self.thickness / length, base_modulus=self.base_modulus / stress
        )


@dataclass(frozen=True, kw_only=True)
class LayeredSection(ElasticitySection):
    """A layer of the material on a half-space of another."""

    words = (
        "a layer of thickness {thickness} bonded to a half-space of modulus {base_youngs_modulus} and Poisson's ratio "
        "{base_poissons_ratio}, "
    )

    thickness: float = key(quantity("m", positive=True), "thickness of the layer")
    base_youngs_modulus: float = key(quantity("Pa", positive=True), "Young's modulus of the half-space under the layer")
    base_poissons_ratio: float = key(
        quantity("1", minimum=-0.999, maximum=0.5), "Poisson's ratio of the half-space under the layer"
    )

    def solid(self, material: MaterialSection) -> Layered:
        return Layered(
            material.contact_modulus,
            material.poissons_ratio,
            self.thickness,
            self.base_youngs_modulus / (1 - self.base_poissons_ratio**2),
            self.base_poissons_ratio,
        )
