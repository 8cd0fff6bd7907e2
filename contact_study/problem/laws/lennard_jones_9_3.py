"""Lennard-Jones half-spaces facing each other: the 9-3 law.

All atoms of the one half-space attract all of the other, where the 10-4 law knows the two outermost layers only:
φ(d) = −Δγ[(4/3)(z0/d)² − (1/3)(z0/d)⁸], σ(d) = (8Δγ/3z0)[(z0/d)³ − (z0/d)⁹]; used for
adhesive spheres since V. M. Muller, V. S. Yushchenko & B. V. Derjaguin, J. Colloid Interface Sci. 77, 91 (1980).
"""

from dataclasses import dataclass

import numpy as np

from contact_study.problem.errors import InputError
from contact_study.problem.laws.base import TractionLaw
from contact_study.problem.laws.interaction import SmoothInteraction


@dataclass(frozen=True, kw_only=True)
class HalfSpacesInteraction(SmoothInteraction):
    """Keys of the 9-3 law, whose adhesion no pair of layers gives."""

    def __post_init__(self):
        super().__post_init__()
        if self.well_depth is not None:
            raise InputError(
                'interaction.well_depth: law = "lennard_jones_9_3" is that of two half-spaces, whose adhesion needs '
                "the number of atoms per volume of both; give interaction.work_of_adhesion and length = z0 "
                "(docs/conventions.md has both from ε, r0 and the densities)"
            )


@dataclass(frozen=True)
class LennardJones93(TractionLaw):
    """The 9-3 law; ``length`` is z0, the equilibrium distance."""

    title = "9-3"
    words = "in the 9-3"
    of_pairs = True
    section = HalfSpacesInteraction

    @property
    def _prefactor(self) -> float:
        return 8 * self.work_of_adhesion / (3 * self.length)

    def potential(self, gap):
        s2 = (self.length / np.asarray(gap)) ** 2
        return -self.work_of_adhesion / 3 * s2 * (4 - s2 * s2 * s2)

    def traction(self, gap):
        s = self.length / np.asarray(gap)
        s3 = s * s * s
        return self._prefactor * s3 * (1 - s3 * s3)

    def stiffness(self, gap):
        s = self.length / np.asarray(gap)
        s2 = s * s
        return self._prefactor / self.length * s2 * s2 * (9 * s2 * s2 * s2 - 3)

    def repulsive_gap(self, traction):
        y = -np.asarray(traction, dtype=float) / self._prefactor
        # s⁹ − s³ = y for s >= 1: 1 + y/6 bounds the root of this convex function from above, and where s⁶ >= 2, hence
        # s⁹ − s³ >= s⁹/2, so does (2y)^(1/9); Newton descends from there, for any y, in at most six iterations.
        s = np.minimum(1 + y / 6, np.maximum(2 ** (1 / 6), (2 * y) ** (1 / 9)))
        for _ in range(6):
            s2 = s * s
            s6 = s2 * s2 * s2
            s = s - (s2 * s * (s6 - 1) - y) / (s2 * (9 * s6 - 3))
        return self.length / s

    @property
    def equilibrium_distance(self) -> float:
        return self.length

    @property
    def peak_distance(self) -> float:
        return 3 ** (1 / 6) * self.length

    @property
    def equilibrium_stiffness(self) -> float:
        return 16 * self.work_of_adhesion / self.length**2

    @property
    def strongest_softening(self) -> float:
        # φ'' ∝ 9 s¹⁰ − 3 s⁴ has its minimum, −(9/5) s⁴, at s⁶ = 2/15.
        return 9 / 5 * (2 / 15) ** (2 / 3) * self._prefactor / self.length
