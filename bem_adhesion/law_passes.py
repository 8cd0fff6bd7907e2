"""A traction-separation law as a Newton solver walks on it: all of it at every gap in one pass, and where a step lands.

:class:`LawPasses` does it for any law with a repulsive core, by the functions of the law; a law of many points has a
compiled pass of its own, which does the same.
"""

import numpy as np
from numba import njit

from contact_study.problem.laws.base import TractionLaw
from contact_study.problem.laws.lennard_jones_10_4 import LennardJones104

# Pressure at which a point lands that enters repulsion in one step, in units of the law's peak: enough to hold it
# there, not so much that its overshoot decides the line search. Zero costs half as many iterations again.
LANDING = 0.35


class LawPasses:
    """The passes of any law.

    Parameters
    ----------
    law : TractionLaw
        The law.
    """

    def __init__(self, law: TractionLaw):
        self.law = law

    def evaluate(self, gap: np.ndarray, traction: np.ndarray, stiffness: np.ndarray) -> float:
        """Write φ' and φ'' of ``gap`` into the two arrays; returns the sum of φ over all points (J/m²)."""
        traction[...] = self.law.traction(gap)
        stiffness[...] = self.law.stiffness(gap)
        return float(np.sum(self.law.potential(gap)))

    def advance(self, gap: np.ndarray, step: np.ndarray, limit: float, out: np.ndarray) -> None:
        """Write the gap after a Newton step into ``out``, moving each point in the variable it is nearly linear in.

        A point in repulsion moves by ``step`` in its linearised traction φ' + φ''·step, from which the gap follows by
        :meth:`TractionLaw.repulsive_gap`; another moves in its gap. No gap changes by more than the fraction ``limit``
        away from repulsion, and a point that enters repulsion does so along the tangent at equilibrium, down to a
        pressure of LANDING times the law's peak. Without this a single point deep in the repulsive wall would shorten
        the step of all.

        Parameters
        ----------
        gap, step : numpy.ndarray
            Present gap and Newton step (m).
        limit : float
            Largest relative change of an attracted gap, below one.
        out : numpy.ndarray
            The new gap (m).
        """
        law = self.law
        equilibrium, tangent = law.equilibrium_distance, law.equilibrium_stiffness
        repelled = gap < equilibrium
        moved = gap + np.clip(step, -limit * gap, limit * gap)
        landing = np.maximum(tangent * (moved - equilibrium), -LANDING * law.peak_tensile_stress)
        traction = np.where(repelled, law.traction(gap) + law.stiffness(gap) * step, landing)
        left = np.where(repelled, equilibrium + np.minimum(traction / tangent, limit * equilibrium), moved)
        out[...] = np.where(traction < 0, law.repulsive_gap(np.minimum(traction, 0.0)), left)


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
    """Newton step over flat arrays, see :meth:`LawPasses.advance`; tractions in units of the prefactor."""
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


class LennardJones104Passes(LawPasses):
    """The 10-4 law, compiled."""

    def evaluate(self, gap, traction, stiffness):
        law = self.law
        flat = gap.reshape(-1), law.length, _prefactor(law), traction.reshape(-1), stiffness.reshape(-1)
        return -law.work_of_adhesion * 5 / 3 * float(_evaluate(*flat))

    def advance(self, gap, step, limit, out):
        law = self.law
        landing = LANDING * law.peak_tensile_stress / _prefactor(law)
        _advance(gap.reshape(-1), step.reshape(-1), limit, law.length, landing, out.reshape(-1))


def _prefactor(law: TractionLaw) -> float:
    return 20 * law.work_of_adhesion / (3 * law.length)


_COMPILED: dict[type[TractionLaw], type[LawPasses]] = {LennardJones104: LennardJones104Passes}


def passes_of(law: TractionLaw) -> LawPasses:
    """The passes of a law: compiled ones where there are any."""
    return _COMPILED.get(type(law), LawPasses)(law)
