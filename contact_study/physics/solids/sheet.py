"""A thin sheet: bending, tension and an elastic foundation."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from contact_study.numerics.arguments import finite
from contact_study.physics.solids.base import Elasticity


@dataclass(frozen=True)
class Sheet(Elasticity):
    """A sheet of small slopes, K = κ q⁴ + σ q² + k: membranes, foils, graphene, also on a bed of springs.

    L. D. Landau & E. M. Lifshitz, Theory of Elasticity, ch. II. Without a foundation a uniform pressure on its other
    face carries the load.

    Parameters
    ----------
    contact_modulus : float
        E* to quote, and the unit of stresses (Pa).
    bending_stiffness, tension, foundation : float
        κ (J), σ (N/m) and k (Pa/m), none negative and not all zero.

    Examples
    --------
    >>> from contact_study.physics.solids import Sheet
    >>> f"{float(Sheet(1e9, 2e-19, 0.1).stiffness(1e9)):.3g}"
    '3e+17'
    """

    bending_stiffness: float
    tension: float = 0.0
    foundation: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        units = {"bending_stiffness": "J", "tension": "N/m", "foundation": "Pa/m"}
        values = {name: finite(name, getattr(self, name), unit) for name, unit in units.items()}
        for name, value in values.items():
            if value < 0:
                raise ValueError(f"{name} = {value:g}: must not be negative")
        if not any(values.values()):
            raise ValueError("bending_stiffness, tension and foundation are zero: one must be positive")

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        square = np.asarray(wavenumber, dtype=float) ** 2
        return (self.bending_stiffness * square + self.tension) * square + self.foundation

    def softest_modulus(self, longest: float, shortest: float) -> float:
        """That of waves of two shortest ones: longer ones bend more easily, but an edge is as wide as its own wave."""
        return super().softest_modulus(min(longest, 2 * shortest), shortest)

    @property
    def mean_compliance(self) -> float:
        """1/k, zero without a foundation (m/Pa)."""
        return 1 / self.foundation if self.foundation else 0.0

    def scaled(self, length: float, stress: float) -> Self:
        return replace(
            super().scaled(length, stress),
            bending_stiffness=self.bending_stiffness / (stress * length**3),
            tension=self.tension / (stress * length),
            foundation=self.foundation * (length / stress),
        )
