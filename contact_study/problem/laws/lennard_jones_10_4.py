"""Lennard-Jones atoms smeared over two facing layers: the 10-4 law.

One layer of the block and one of the substrate interact through V(r) = 4ε[(r0/r)¹² − (r0/r)⁶]; integrating over both
areal densities n_a, n_b gives φ(d) = −Δγ (5/3)[(r0/d)⁴ − (2/5)(r0/d)¹⁰] with Δγ = (6π/5) n_a n_b ε r0².
"""

from dataclasses import dataclass

import numpy as np

from contact_study.problem.laws.base import TractionLaw


def work_of_adhesion(well_depth: float, length: float, block_density: float, substrate_density: float) -> float:
    """Δγ = (6π/5) n_a n_b ε r0² of two smeared layers (J/m²).

    Parameters
    ----------
    well_depth : float
        ε of the pair potential (J).
    length : float
        r0 of the pair potential (m).
    block_density, substrate_density : float
        Atoms per area of each layer (1/m²).
    """
    return 6 * np.pi / 5 * block_density * substrate_density * well_depth * length**2


@dataclass(frozen=True)
class LennardJones104(TractionLaw):
    """The 10-4 law: σ(d) = (20Δγ/3r0)[(r0/d)⁵ − (r0/d)¹¹]; ``length`` is r0, the equilibrium distance."""

    title = "10-4"
    words = "smeared into the 10-4"
    of_pairs = True

    @property
    def _prefactor(self) -> float:
        return 20 * self.work_of_adhesion / (3 * self.length)

    def potential(self, gap):
        s = self.length / np.asarray(gap)
        return -self.work_of_adhesion * 5 / 3 * (s**4 - 0.4 * s**10)

    def traction(self, gap):
        s = self.length / np.asarray(gap)
        return self._prefactor * (s**5 - s**11)

    def stiffness(self, gap):
        s = self.length / np.asarray(gap)
        return self._prefactor / self.length * (11 * s**12 - 5 * s**6)

    def repulsive_gap(self, traction):
        y = -np.asarray(traction, dtype=float) / self._prefactor
        # s¹¹ − s⁵ = y for s >= 1: 1 + y/6 bounds the root of this convex function from above, and where s⁶ >= 2, hence
        # s¹¹ − s⁵ >= s¹¹/2, so does (2y)^(1/11); Newton descends from there, for any y, in at most six iterations.
        s = np.minimum(1 + y / 6, np.maximum(2 ** (1 / 6), (2 * y) ** (1 / 11)))
        for _ in range(6):
            s = s - (s**11 - s**5 - y) / (11 * s**10 - 5 * s**4)
        return self.length / s

    @property
    def equilibrium_distance(self) -> float:
        return self.length

    @property
    def peak_distance(self) -> float:
        return (11 / 5) ** (1 / 6) * self.length

    @property
    def equilibrium_stiffness(self) -> float:
        return 40 * self.work_of_adhesion / self.length**2

    @property
    def strongest_softening(self) -> float:
        # φ'' ∝ 11 s¹² − 5 s⁶ has its minimum at s⁶ = 5/22.
        return 25 / 44 * self._prefactor / self.length
