"""Laws of summed Lennard-Jones pairs, of two layers (10-4) and of two half-spaces (9-3), and laws that only repel."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from contact_study.numerics.arguments import positive
from contact_study.physics.laws.base import LawAtLength, TractionLaw


@dataclass(frozen=True)
class LennardJones(LawAtLength):
    """The family σ(d) = P [s^m − s^(m+6)], s = r0/d with ``length`` r0, P = Δγ(m − 1)(m + 5)/6r0.

    Parameters
    ----------
    work_of_adhesion, length : float
        Δγ (J/m²) and r0 (m).

    Examples
    --------
    >>> from bem_adhesion import LennardJones, LennardJones93
    >>> issubclass(LennardJones93, LennardJones)
    True
    """

    exponent: ClassVar[int]  # m, three to five

    @property
    def prefactor(self) -> float:
        """P (Pa)."""
        m = self.exponent
        return (m - 1) * (m + 5) * self.work_of_adhesion / (6 * self.length)

    def _powers(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """s⁶ and s^m."""
        power = s3 = s * s * s
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
        # s^(m+6) − s^m = y for s >= 1, convex: 1 + y/6 bounds the root from above and, where s⁶ >= 2, (2y)^(1/(m+6)).
        # Newton descends from there, for any y, in at most six iterations.
        s = np.minimum(1 + y / 6, np.maximum(2 ** (1 / 6), (2 * y) ** (1 / (m + 6))))
        for _ in range(6):
            s6, power = self._powers(s)
            s = s - (power * (s6 - 1) - y) / (power / s * ((m + 6) * s6 - m))
        return self.length / s

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


@dataclass(frozen=True)
class LennardJones104(LennardJones):
    """The 10-4 law of two facing layers of atoms, σ(d) = (20Δγ/3r0)[(r0/d)⁵ − (r0/d)¹¹].

    One layer of the block and one of the substrate interact through V(r) = 4ε[(r0/r)¹² − (r0/r)⁶]. Integration over
    both areal densities gives φ(d) = −Δγ (5/3)[(r0/d)⁴ − (2/5)(r0/d)¹⁰], Δγ as :func:`work_of_adhesion`.

    Parameters
    ----------
    work_of_adhesion, length : float
        Δγ (J/m²) and the equilibrium distance r0, the zero of the pair potential (m).

    Examples
    --------
    >>> from bem_adhesion import LennardJones104
    >>> LennardJones104(0.05, 3e-10).equilibrium_distance
    3e-10
    """

    title = "10-4"
    words = "smeared into the 10-4"
    exponent = 5


@dataclass(frozen=True)
class LennardJones93(LennardJones):
    """The 9-3 law of two half-spaces of atoms, σ(d) = (8Δγ/3z0)[(z0/d)³ − (z0/d)⁹].

    φ(d) = −Δγ[(4/3)(z0/d)² − (1/3)(z0/d)⁸]; used for adhesive spheres since V. M. Muller, V. S. Yushchenko &
    B. V. Derjaguin, J. Colloid Interface Sci. 77, 91 (1980).

    Parameters
    ----------
    work_of_adhesion, length : float
        Δγ (J/m²) and the equilibrium distance z0 (m).

    Examples
    --------
    >>> from bem_adhesion import LennardJones93
    >>> LennardJones93(0.05, 3e-10).equilibrium_distance
    3e-10
    """

    title = "9-3"
    words = "in the 9-3"
    exponent = 3


@dataclass(frozen=True)
class HardWall(TractionLaw):
    """A hard wall without adhesion: gap >= 0, pressure >= 0, gap × pressure = 0 (Signorini conditions), no potential.

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
    work_of_adhesion, length, repulsion : float
        Zero, the gap z0 at which the repulsion begins (m), and U, the work of adhesion of the 9-3 law (J/m²).

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

    def _below(self, gap, values):
        return np.where(np.asarray(gap).real < self.length, values, 0.0)

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


def work_of_adhesion(well_depth: float, length: float, block_density: float, substrate_density: float) -> float:
    """Calculate Δγ = (6π/5) n_a n_b ε r0² of two smeared layers (J/m²) by ε (J), r0 (m) and atoms per area (1/m²)."""
    return 6 * np.pi / 5 * block_density * substrate_density * well_depth * length**2
