"""A traction-separation law as a Newton solver walks on it: all of it at every gap in one pass, and where a step lands.

:class:`LawPasses` does it for any law with a repulsive core, by the functions of the law; a law of many points has a
compiled pass of its own, which does the same. Laws with a wall are in :mod:`bem_adhesion.wall_passes`.
"""

from collections.abc import Iterator

import numpy as np
from numba import njit

from contact_study.problem.laws.base import TractionLaw

# Pressure at which a point lands that enters repulsion in one step, in units of the law's peak: enough to hold it
# there, not so much that its overshoot decides the line search. Zero costs half as many iterations again.
LANDING = 0.35

# An attracted point out of balance by a stress g gains the curvature CAUTION |g| / distance, with the distance to
# equilibrium if it is pulled into contact, its gap if it is pulled out: it then steps about there and not beyond. The
# term vanishes with g, so that Newton's quadratic convergence stays. It makes the descent follow a slow gradient flow
# more closely, at a quarter less work.
CAUTION = 1.0

# Points that a law written in NumPy is asked for at a time: its intermediate fields stay in the cache. Flat optimum;
# all points of 512² at once take three to four times as long.
BLOCK = 32768


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _gradient(elastic, gap, traction, load, equilibrium, peak, right_side, curvature):
    """Write −(K d + φ' + load), raise the curvature of points out of balance beyond the law's peak.

    Returns Σ ½ d·K d + load·d, max|gradient|, Σ gradient² and Σ gradient.
    """
    energy = 0.0
    largest = 0.0
    square = 0.0
    total = 0.0
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            d = gap[i, j]
            gradient = elastic[i, j] + traction[i, j] + load[i, j]
            right_side[i, j] = -gradient
            if d > peak:
                curvature[i, j] += CAUTION * abs(gradient) / (d - equilibrium if gradient > 0.0 else d)
            energy += (0.5 * elastic[i, j] + load[i, j]) * d
            largest = max(largest, abs(gradient))
            square += gradient * gradient
            total += gradient
    return energy, largest, square, total


class LawPasses:
    """The passes of any law.

    Parameters
    ----------
    law : TractionLaw
        The law.

    Attributes
    ----------
    margin : float
        Length to add to a gap where a relative change of it is meant (m).
    """

    margin = 0.0

    def __init__(self, law: TractionLaw):
        self.law = law

    def evaluate(self, gap: np.ndarray, traction: np.ndarray, stiffness: np.ndarray) -> float:
        """Write φ' and φ'' of ``gap`` into the two arrays; returns the sum of φ over all points (J/m²)."""
        total = 0.0
        for here in _blocks(gap):
            traction[here] = self.law.traction(gap[here])
            stiffness[here] = self.law.stiffness(gap[here])
            total += float(np.sum(self.law.potential(gap[here])))
        return total

    def gradient(
        self,
        elastic: np.ndarray,
        gap: np.ndarray,
        traction: np.ndarray,
        load: np.ndarray,
        right_side: np.ndarray,
        curvature: np.ndarray,
    ) -> tuple[float, float, float, float]:
        """Write −(K d + φ' + load) into ``right_side``, and raise ``curvature`` where points are out of balance.

        Returns Σ ½ d·K d + load·d, max|gradient|, Σ gradient² and Σ gradient.
        """
        law = self.law
        # Repulsion alone is convex: nothing to be cautious of, and its peak is no distance from its equilibrium.
        peak = law.peak_distance if law.attracts else np.inf
        return _gradient(elastic, gap, traction, load, law.equilibrium_distance, peak, right_side, curvature)

    def hold(self, curvature: np.ndarray, step: np.ndarray) -> None:
        """Take a wall's points out of a step; without a wall none."""

    def pin(self, curvature: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """Make points that touch a wall as stiff as those it holds; which they are. Without a wall none."""
        return np.zeros(gap.shape, bool)

    def reaction(
        self, elastic: np.ndarray, gap: np.ndarray, traction: np.ndarray, load: np.ndarray
    ) -> np.ndarray | float:
        """Pressure of a wall, K d + φ' + load where the gap is zero."""
        return 0.0

    def imbalance(self, pressure: np.ndarray, traction: np.ndarray, gap: np.ndarray) -> float:
        """Mean of pressure and traction over the points that are free to move."""
        return float(pressure.mean() + traction.mean())

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
        for here in _blocks(gap):
            _move(self.law, gap[here], step[here], limit, out[here])


def _blocks(field: np.ndarray) -> Iterator[slice]:
    """Rows of a field, so many at a time that they have some :data:`BLOCK` points."""
    rows = max(1, BLOCK // field[0].size)
    return (slice(first, first + rows) for first in range(0, len(field), rows))


def _move(law: TractionLaw, gap: np.ndarray, step: np.ndarray, limit: float, out: np.ndarray) -> None:
    """As :meth:`LawPasses.advance`."""
    equilibrium, tangent = law.equilibrium_distance, law.equilibrium_stiffness
    np.add(gap, np.clip(step, -limit * gap, limit * gap), out=out)
    # The law's functions are for these few alone.
    near = np.minimum(gap, out) < equilibrium
    gap, step, moved = gap[near], step[near], out[near]
    repelled = gap < equilibrium
    # Without a peak there is nothing to overshoot into: points land on the tangent.
    largest = LANDING * law.peak_tensile_stress or np.inf
    traction = np.maximum(tangent * (moved - equilibrium), -largest)
    traction[repelled] = law.traction(gap[repelled]) + law.stiffness(gap[repelled]) * step[repelled]
    moved[repelled] = equilibrium + np.minimum(traction[repelled] / tangent, limit * equilibrium)
    pressed = traction < 0
    moved[pressed] = law.repulsive_gap(traction[pressed])
    out[near] = moved


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
