"""An elastic layer of finite thickness, bonded to a rigid base.

A layer 0 < z < d whose lower face is held, and whose upper face feels a normal pressure p of wavenumber q and no shear,
gives way there by 2p/(E* q) times

    S = [(3−4ν) sinh 2qd − 2qd] / [(3−4ν) cosh 2qd + 2(qd)² + 5 − 12ν + 8ν²]:

the four exponentials e^(±qz), z e^(±qz) that solve the equations of elasticity, under the four conditions of the two
faces; the tests hold it to an integration of the equations of elasticity.
Thick layers are half-spaces, S → 1. Thin compressible ones are a bed of springs, K → (1−ν) E / [(1+ν)(1−2ν) d]; thin
incompressible ones resist flow along the layer, K → 3E*/(4 q² d³).
"""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from contact_study.numerics.arguments import finite, positive
from contact_study.physics.solids.base import Elasticity, ElasticitySection
from contact_study.study.schema.keys import key, quantity
from contact_study.study.schema.sections import MaterialSection


def check_poissons_ratio(name: str, value: float) -> None:
    """Raise ValueError unless a number can be Poisson's ratio of an isotropic solid."""
    finite(name, value, "1")
    if not -1 < value <= 0.5:
        raise ValueError(f"{name} = {value:g}: must be above -1 and at most 0.5")


@dataclass(frozen=True)
class Layer(Elasticity):
    """A homogeneous isotropic layer on a rigid base.

    Parameters
    ----------
    contact_modulus : float
        E* = E/(1 − ν²) (Pa).
    poissons_ratio : float
        ν, above −1 and up to 0.5: incompressible.
    thickness : float
        d (m).

    Raises
    ------
    ValueError
        If a number is not possible.
    """

    poissons_ratio: float
    thickness: float

    def __post_init__(self) -> None:
        super().__post_init__()
        check_poissons_ratio("poissons_ratio", self.poissons_ratio)
        positive("thickness", self.thickness, "m")

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        q, ratio = np.asarray(wavenumber, dtype=float), self.poissons_ratio
        x = self.thickness * q
        # Both brackets of S times 2 exp(−2x), which no thickness overflows.
        decay = np.exp(-2 * x)
        above = 2 * (3 - 4 * ratio) * _sinh_less_argument(2 * x) + 8 * (1 - 2 * ratio) * x * decay
        below = (3 - 4 * ratio) * (1 + decay**2) + 2 * (2 * x**2 + 5 - 12 * ratio + 8 * ratio**2) * decay
        return 0.5 * self.contact_modulus * q * below / above

    @property
    def depth(self) -> float:
        return self.thickness

    @property
    def mean_compliance(self) -> float:
        """(1+ν)(1−2ν) d / [(1−ν) E]: compression without lateral strain, none if incompressible (m/Pa)."""
        ratio = self.poissons_ratio
        return (1 - 2 * ratio) * self.thickness / ((1 - ratio) ** 2 * self.contact_modulus)

    def keys(self, poissons_ratio: float) -> dict[str, Any]:
        return {"kind": "layer", "thickness": self.thickness}

    def scaled(self, length: float, stress: float) -> Self:
        return replace(super().scaled(length, stress), thickness=self.thickness / length)


@dataclass(frozen=True, kw_only=True)
class LayerSection(ElasticitySection):
    """A layer of the material."""

    words = "a layer of thickness {thickness} bonded to a rigid base, "

    thickness: float = key(quantity("m", positive=True), "thickness of the layer")

    def solid(self, material: MaterialSection) -> Layer:
        return Layer(material.contact_modulus, material.poissons_ratio, self.thickness)


def _sinh_less_argument(y: np.ndarray) -> np.ndarray:
    """(sinh y − y) exp(−y) for y >= 0, without cancellation where y is small."""
    square = np.minimum(y, 1.0) ** 2
    # y³/3! + y⁵/5! + … + y¹⁷/17!, the rest of which is 1e-16 of it at y = 1.
    rest = np.zeros_like(square)
    for order in range(17, 3, -2):
        rest = (1 + rest) * square / (order * (order - 1))
    return np.where(y < 1, y**3 / 6 * (1 + rest) * np.exp(-y), 0.5 * (1 - np.exp(-2 * y)) - y * np.exp(-y))
