"""A plate whose faces are both free, by the elasticity of its thickness."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from contact_study.numerics.arguments import positive
from contact_study.physics.solids.base import Elasticity, sinh_less_argument


@dataclass(frozen=True)
class Plate(Elasticity):
    """A homogeneous isotropic plate that nothing supports; a uniform pressure on its other face carries the load.

    K = E* q/2 · (sinh² x − x²)/(sinh x cosh x + x), x = qd: half of the load squeezes the plate, a displacement of
    (cosh x − 1)/(sinh x + x) times the half-space's, half bends it, (cosh x + 1)/(sinh x − x). Thick plates are
    half-spaces; thin ones bend, K → D q⁴, D = E* d³/12.

    Parameters
    ----------
    contact_modulus, thickness : float
        E* = E/(1 − ν²) (Pa), and d (m).

    Examples
    --------
    >>> from contact_study.physics.solids import Plate
    >>> f"{float(Plate(1e9, 1e-6).stiffness(1e4)) / (1e9 * 1e-18 / 12 * 1e16):.3f}"
    '1.000'
    """

    thickness: float

    def __post_init__(self) -> None:
        super().__post_init__()
        positive("thickness", self.thickness, "m")

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        q = np.asarray(wavenumber, dtype=float)
        x = self.thickness * q
        # Both brackets times exp(−2x), which no thickness overflows.
        odd, even = sinh_less_argument(x), 0.5 * (1 - np.exp(-2 * x)) + x * np.exp(-x)
        return 0.5 * self.contact_modulus * q * odd * even / (0.25 * (1 - np.exp(-4 * x)) + x * np.exp(-2 * x))

    def softest_modulus(self, longest: float, shortest: float) -> float:
        """That of waves of two shortest ones: longer ones bend more easily, but an edge is as wide as its own wave."""
        return super().softest_modulus(min(longest, 2 * shortest), shortest)

    @property
    def layer_thickness(self) -> float:
        return self.thickness

    def scaled(self, length: float, stress: float) -> Self:
        return replace(super().scaled(length, stress), thickness=self.thickness / length)
