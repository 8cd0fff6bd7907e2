"""Lennard-Jones atoms smeared over two facing layers: the 10-4 law.

One layer of the block and one of the substrate interact through V(r) = 4ε[(r0/r)¹² − (r0/r)⁶]; integrating over both
areal densities n_a, n_b gives φ(d) = −Δγ (5/3)[(r0/d)⁴ − (2/5)(r0/d)¹⁰] with Δγ = (6π/5) n_a n_b ε r0².
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from contact_study.problem.laws.base import LANDING, TractionLaw


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


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _evaluate(gap, length, prefactor, traction, stiffness):
    """Fused pass over flat arrays; returns Σ[(r0/d)⁴ − (2/5)(r0/d)¹⁰]."""
    total = 0.0
    for i in range(gap.size):
        s = length / gap[i]
        s2 = s * s
        s4 = s2 * s2
        s6 = s4 * s2
        traction[i] = prefactor * s4 * s * (1.0 - s6)
        stiffness[i] = prefactor / length * s6 * (11.0 * s6 - 5.0)
        total += s4 - 0.4 * s4 * s6
    return total


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _advance(gap, step, limit, length, landing, out):
    """Newton step over flat arrays, see :meth:`TractionLaw.advance`; tractions in units of the prefactor."""
    tangent = 6.0 / length
    for i in range(gap.size):
        d = gap[i]
        x = step[i]
        s = length / d
        s2 = s * s
        s4 = s2 * s2
        s6 = s4 * s2
        moved = min(max(x, -limit * d), limit * d) + d
        if d < length:
            y = s4 * s * (s6 - 1.0) - s6 * (11.0 * s6 - 5.0) * x / length
            moved = length + min(-y / tangent, limit * length)
        else:
            y = min(tangent * (length - moved), landing)
        # s¹¹ − s⁵ = y for s >= 1. The root is a concave function of y, so its tangents (here at s = 1, 1.1, 1.25
        # and 1.6) bound it from above, as does the linear step; Newton descends from there.
        y_root = max(y, 0.0)
        root = min(1.0 + y_root / 6.0, 1.1 + (y_root - 1.2426067) / 21.210667)
        root = min(root, min(1.25 + (y_root - 8.5897744) / 90.238452, 1.6 + (y_root - 165.4361) / 1176.6948))
        if d < length:
            root = min(root, max(s - s * x / d, s))
        for _ in range(3):
            r2 = root * root
            r4 = r2 * r2
            r10 = r4 * r4 * r2
            root -= (r10 * root - r4 * root - y_root) / (11.0 * r10 - 5.0 * r4)
        out[i] = length / root if y > 0.0 else moved


@dataclass(frozen=True)
class LennardJones104(TractionLaw):
    """The 10-4 law: σ(d) = (20Δγ/3r0)[(r0/d)⁵ − (r0/d)¹¹]; ``length`` is r0, the equilibrium distance."""

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

    def evaluate(self, gap, traction, stiffness):
        total = _evaluate(gap.reshape(-1), self.length, self._prefactor, traction.reshape(-1), stiffness.reshape(-1))
        return -self.work_of_adhesion * 5 / 3 * float(total)

    def advance(self, gap, step, limit, out):
        landing = LANDING * self.peak_tensile_stress / self._prefactor
        _advance(gap.reshape(-1), step.reshape(-1), limit, self.length, landing, out.reshape(-1))
