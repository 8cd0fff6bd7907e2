"""Elastic layers on a rigid base and on a half-space; the tests integrate the equations of elasticity."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from contact_study.numerics.arguments import finite, positive
from contact_study.physics.solids.base import Elasticity


def check_poissons_ratio(name: str, value: float) -> None:
    """Raise ValueError unless a number can be Poisson's ratio of an isotropic solid."""
    finite(name, value, "1")
    if not -1 < value <= 0.5:
        raise ValueError(f"{name} = {value:g}: must be above -1 and at most 0.5")


@dataclass(frozen=True)
class Layer(Elasticity):
    """A homogeneous isotropic layer bonded to a rigid base.

    A normal pressure p of wavenumber q, without shear, displaces the upper face of a layer 0 < z < d, whose lower face
    is held, by 2p/(E* q) times

        S = [(3−4ν) sinh 2qd − 2qd] / [(3−4ν) cosh 2qd + 2(qd)² + 5 − 12ν + 8ν²]:

    the four exponentials e^(±qz), z e^(±qz) that solve the equations of elasticity, under the four conditions of the
    two faces. Thick layers are half-spaces, S → 1. Thin compressible ones are springs side by side,
    K → (1−ν) E / [(1+ν)(1−2ν) d]; thin incompressible ones resist flow along the layer, K → 3E*/(4 q² d³).

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

    Examples
    --------
    >>> from contact_study.physics.solids import Layer
    >>> f"{float(Layer(1e9, 0.4, 1e-6).stiffness(1e7)):.3g}"
    '5e+15'
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

    def scaled(self, length: float, stress: float) -> Self:
        return replace(super().scaled(length, stress), thickness=self.thickness / length)


def _sinh_less_argument(y: np.ndarray) -> np.ndarray:
    """(sinh y − y) exp(−y) for y >= 0, without cancellation where y is small."""
    square = np.minimum(y, 1.0) ** 2
    # y³/3! + y⁵/5! + … + y¹⁷/17!, the rest of which is 1e-16 of it at y = 1.
    rest = np.zeros_like(square)
    for order in range(17, 3, -2):
        rest = (1 + rest) * square / (order * (order - 1))
    return np.where(y < 1, y**3 / 6 * (1 + rest) * np.exp(-y), 0.5 * (1 - np.exp(-2 * y)) - y * np.exp(-y))


@dataclass(frozen=True)
class Layered(Elasticity):
    """A homogeneous isotropic layer bonded to a half-space of another material: coatings, oxides, skins.

    A normal pressure p of wavenumber q, without shear, displaces the upper face of a layer 0 < z < d (shear modulus μ,
    Poisson's ratio ν) on a half-space (μ_b, ν_b) by 2p/(E* q) times

        S = [1 + 4 m qd e^(−2qd) − m n e^(−4qd)] / [1 − (m + n + 4 m (qd)²) e^(−2qd) + m n e^(−4qd)],

        m = (μ/μ_b − 1)/(μ/μ_b + 3 − 4ν),    n = 1 − 4(1 − ν)/[1 + (μ/μ_b)(3 − 4ν_b)],

    E* that of the layer. Short waves feel the layer, S → 1, long ones the base, S → E*/E*_b; on a rigid base it is the
    bonded layer.

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

    Examples
    --------
    >>> from contact_study.physics.solids import Layered
    >>> f"{float(Layered(1e9, 0.4, 1e-6, 1e11, 0.3).stiffness(1e7)):.3g}"
    '5e+15'
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

    def scaled(self, length: float, stress: float) -> Self:
        return replace(
            super().scaled(length, stress), thickness=self.thickness / length, base_modulus=self.base_modulus / stress
        )
