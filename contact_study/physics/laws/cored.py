"""Attraction of a law that has a wall, with an exponential repulsion in the wall's place.

σ(d) = σ_wall(x) − σ_wall(0) e^(−x/c),    x = d − d0: the attraction of the wall's law from the equilibrium distance d0
on, and a core of decay length c, the shorter the nearer to a wall. The core is finite at a gap of zero.
"""

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.physics.laws.base import TractionLaw

_INVERSE_STEPS = 12


@dataclass(frozen=True)
class CoredLaw(TractionLaw):
    """A wall's attraction with a smooth repulsion.

    Parameters
    ----------
    work_of_adhesion : float
        Δγ (J/m²).
    length : float
        Equilibrium distance d0 (m).
    range : float
        Range of the attraction (m).
    core : float
        Decay length c of the repulsion (m).
    """

    diverges = False
    own_lengths = ("range", "core")

    range: float
    core: float

    @abstractmethod
    def _outside_wall(self, work_of_adhesion: float) -> TractionLaw:
        """The law with the wall."""

    @cached_property
    def _attraction(self) -> TractionLaw:
        """The law with the wall whose Δγ leaves this one's beside the core."""
        unit = self._outside_wall(1.0)
        return self._outside_wall(self.work_of_adhesion / (1 - self.core * float(unit.traction(np.array(0.0)))))

    @cached_property
    def _repulsion(self) -> float:
        """Pressure of the core at equilibrium."""
        return float(self._attraction.traction(np.array(0.0)))

    def _decay(self, x):
        return np.exp(-x / self.core)

    def potential(self, gap):
        x = np.asarray(gap) - self.length
        return self._attraction.potential(x) + self.core * self._repulsion * self._decay(x)

    def traction(self, gap):
        x = np.asarray(gap) - self.length
        return self._attraction.traction(x) - self._repulsion * self._decay(x)

    def stiffness(self, gap):
        x = np.asarray(gap) - self.length
        return self._attraction.stiffness(x) + self._repulsion / self.core * self._decay(x)

    def repulsive_gap(self, traction):
        # x = −c ln((σ_wall(x) − σ)/σ_wall(0)): nearly linear, the attraction changing little over a core.
        wanted = -np.asarray(traction, dtype=float)
        x = np.zeros(wanted.shape)
        for _ in range(_INVERSE_STEPS):
            pressure = wanted + self._attraction.traction(x)
            excess = x / self.core + np.log(pressure / self._repulsion)
            x = x - excess / (1 / self.core + self._attraction.stiffness(x) / pressure)
        return self.length + np.minimum(x, 0.0)

    @property
    def equilibrium_distance(self) -> float:
        return self.length

    @cached_property
    def peak_distance(self) -> float:
        return self._lowest_outside(lambda gap: -self.traction(gap))

    @cached_property
    def strongest_softening(self) -> float:
        return -float(self.stiffness(np.array(self._lowest_outside(self.stiffness))))

    def _lowest_outside(self, function):
        """As :meth:`lowest`, looked for in units of the range."""
        shifted = self._attraction.lowest(lambda x: function(self.length + np.asarray(x)))
        return self.length + shifted
