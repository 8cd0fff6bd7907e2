"""Morse's law: φ(d) = Δγ [e^(−2(d−d0)/w) − 2 e^(−(d−d0)/w)], for covalent and metallic bonds across an interface.

P. M. Morse, Phys. Rev. 34, 57 (1929). Its repulsion is finite at a gap of zero.
"""

from dataclasses import dataclass

import numpy as np

from contact_study.physics.laws.base import TractionLaw


@dataclass(frozen=True)
class Morse(TractionLaw):
    """Morse's law, σ(d) = (2Δγ/w)[y − y²] with y = e^(−(d−d0)/w).

    Parameters
    ----------
    work_of_adhesion : float
        Δγ (J/m²).
    length, range : float
        Equilibrium distance d0 and range w of the attraction (m).

    Examples
    --------
    >>> from bem_adhesion import Morse
    >>> f"{Morse(0.05, 3e-10, 1e-10).peak_tensile_stress:.3g}"
    '2.5e+08'
    """

    title = "Morse"
    words = "Morse's law"
    diverges = False
    own_lengths = ("range",)

    range: float

    def _decay(self, gap):
        return np.exp(-(np.asarray(gap) - self.length) / self.range)

    def potential(self, gap):
        y = self._decay(gap)
        return self.work_of_adhesion * y * (y - 2)

    def traction(self, gap):
        y = self._decay(gap)
        return 2 * self.work_of_adhesion / self.range * y * (1 - y)

    def stiffness(self, gap):
        y = self._decay(gap)
        return 2 * self.work_of_adhesion / self.range**2 * y * (2 * y - 1)

    def repulsive_gap(self, traction):
        # y² − y = x, with y − 1 written so that nothing cancels near equilibrium.
        x = -np.asarray(traction, dtype=float) * self.range / (2 * self.work_of_adhesion)
        return self.length - self.range * np.log1p(2 * x / (1 + np.sqrt(1 + 4 * x)))

    @property
    def equilibrium_distance(self) -> float:
        return self.length

    @property
    def peak_distance(self) -> float:
        return self.length + float(np.log(2)) * self.range

    @property
    def equilibrium_stiffness(self) -> float:
        return 2 * self.work_of_adhesion / self.range**2

    @property
    def strongest_softening(self) -> float:
        # y (2y − 1) is lowest, −1/8, at y = 1/4.
        return self.work_of_adhesion / (4 * self.range**2)
