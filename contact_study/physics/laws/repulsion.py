"""Laws that do not attract: a hard wall and a soft repulsion."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from contact_study.numerics.arguments import positive
from contact_study.physics.laws.base import LawAtLength, TractionLaw
from contact_study.physics.laws.lennard_jones import LennardJones93


@dataclass(frozen=True)
class HardWall(TractionLaw):
    """A hard wall without adhesion: gap >= 0, pressure >= 0, gap × pressure = 0 (Signorini conditions).

    A constraint, not a potential. Points of positive pressure are in contact.

    Parameters
    ----------
    work_of_adhesion, length : float, optional
        Zero.

    Examples
    --------
    >>> from bem_adhesion import HardWall
    >>> HardWall().attracts
    False
    """

    has_wall = True
    attracts = False
    title = "hard wall"
    words = "a hard wall without adhesion"
    counts_as_contact = "a positive pressure"

    work_of_adhesion: float = 0.0
    length: float = 0.0

    def __post_init__(self):
        if self.work_of_adhesion or self.length:
            raise ValueError("a hard wall has neither work of adhesion nor length")

    def potential(self, gap):
        return np.zeros(np.shape(gap))

    traction = stiffness = potential

    def in_contact(self, gap, pressure, contact_distance):
        return pressure > 0


@dataclass(frozen=True)
class Repulsive(LawAtLength):
    """The repulsive half of the 9-3 law, a soft repulsion of finite reach.

    φ(d) = U [(1/3)(z0/d)⁸ − (4/3)(z0/d)² + 1] for d < z0, zero from there on, with a continuous traction; the cut is
    that of J. D. Weeks, D. Chandler & H. C. Andersen, J. Chem. Phys. 54, 5237 (1971).

    Parameters
    ----------
    work_of_adhesion : float
        Zero.
    length : float
        Gap z0 at which the repulsion begins (m).
    repulsion : float
        U, the work of adhesion of the 9-3 law (J/m²).

    Examples
    --------
    >>> from bem_adhesion import Repulsive
    >>> Repulsive(0.0, 3e-10, 0.05).contact_distance
    3e-10
    """

    attracts = False
    title = "repulsive"
    words = "a soft repulsion"

    repulsion: float

    def __post_init__(self):
        if self.work_of_adhesion:
            raise ValueError("a law that does not attract has no work of adhesion")
        positive("length", self.length, "m")
        positive("repulsion", self.repulsion, "J/m²")

    @cached_property
    def _whole(self) -> LennardJones93:
        return LennardJones93(self.repulsion, self.length)

    def _below(self, gap, values, beyond=0.0):
        return np.where(np.asarray(gap).real < self.length, values, beyond)

    def potential(self, gap):
        return self._below(gap, self._whole.potential(gap) + self.repulsion)

    def traction(self, gap):
        return self._below(gap, self._whole.traction(gap))

    def stiffness(self, gap):
        return self._below(gap, self._whole.stiffness(gap))

    def repulsive_gap(self, traction):
        return self._whole.repulsive_gap(traction)

    @property
    def equilibrium_stiffness(self) -> float:
        return self._whole.equilibrium_stiffness

    @property
    def contact_distance(self) -> float:
        return self.length

    def scaled(self, length: float, stress: float) -> Self:
        return replace(super().scaled(length, stress), repulsion=self.repulsion / (length * stress))
