"""Lennard-Jones pairs summed over bodies: what the tractions of two layers, of a layer and a body, and of two share.

The traction is σ(d) = P [s^m − s^(m+6)], s = r0/d and r0 the equilibrium distance, from

    φ(d) = −P r0 [s^(m−1)/(m − 1) − s^(m+5)/(m + 5)],        P = Δγ (m − 1)(m + 5) / 6 r0.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact_study.physics.laws.base import TractionLaw


@dataclass(frozen=True)
class LennardJones(TractionLaw):
    """A law of that family; ``length`` is r0.

    Attributes
    ----------
    exponent : int
        m, three to five: with which power of the distance the attraction falls.
    """

    exponent: ClassVar[int]

    @property
    def prefactor(self) -> float:
        """P (Pa)."""
        m = self.exponent
        return (m - 1) * (m + 5) * self.work_of_adhesion / (6 * self.length)

    def _powers(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """s⁶ and s^m."""
        s3 = s * s * s
        power = s3
        for _ in range(self.exponent - 3):
            power = power * s
        return s3 * s3, power

    def potential(self, gap):
        m, s = self.exponent, self.length / np.asarray(gap)
        s6, power = self._powers(s)
        return self.prefactor * self.length * power / s * (s6 / (m + 5) - 1 / (m - 1))

    def traction(self, gap):
        s6, power = self._powers(self.length / np.asarray(gap))
        return self.prefactor * power * (1 - s6)

    def stiffness(self, gap):
        m, s = self.exponent, self.length / np.asarray(gap)
        s6, power = self._powers(s)
        return self.prefactor / self.length * power * s * ((m + 6) * s6 - m)

    def repulsive_gap(self, traction):
        m = self.exponent
        y = -np.asarray(traction, dtype=float) / self.prefactor
        # s^(m+6) − s^m = y for s >= 1: 1 + y/6 bounds the root of this convex function from above, and where s⁶ >= 2,
        # hence s^(m+6) − s^m >= s^(m+6)/2, so does (2y)^(1/(m+6)). Newton descends from there, for any y, in at most
        # six iterations.
        s = np.minimum(1 + y / 6, np.maximum(2 ** (1 / 6), (2 * y) ** (1 / (m + 6))))
        for _ in range(6):
            s6, power = self._powers(s)
            s = s - (power * (s6 - 1) - y) / (power / s * ((m + 6) * s6 - m))
        return self.length / s

    @property
    def equilibrium_distance(self) -> float:
        return self.length

    @property
    def peak_distance(self) -> float:
        m = self.exponent
        return ((m + 6) / m) ** (1 / 6) * self.length

    @property
    def equilibrium_stiffness(self) -> float:
        return 6 * self.prefactor / self.length

    @property
    def strongest_softening(self) -> float:
        # φ'' ∝ (m + 6) s^(m+7) − m s^(m+1) has its minimum, −6m/(m + 7) s^(m+1), at s⁶ = m(m + 1)/((m + 6)(m + 7)).
        m = self.exponent
        s6 = m * (m + 1) / ((m + 6) * (m + 7))
        return 6 * m / (m + 7) * s6 ** ((m + 1) / 6) * self.prefactor / self.length
