"""A traction-separation law as a Newton solver walks on it: all of it at every gap in one pass, and where a step lands.

:class:`LawPasses` does it for any law with a repulsive core, by the functions of the law; a law of many points has a
compiled pass of its own, which does the same. Laws with a wall are in :mod:`bem_adhesion.kernels.wall`.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numba import njit

from bem_adhesion.operators.load import Load
from contact_study.physics.laws.base import TractionLaw

# Pressure at which a point lands that enters repulsion in one step, in units of the law's peak: enough to hold it
# there, not so much that its overshoot decides the line search. Zero costs half as many iterations again.
LANDING = 0.35

# An attracted point out of balance by a stress g gains the curvature CAUTION |g| / distance, with the distance to
# equilibrium if it is pulled into contact, its gap if it is pulled out: it then steps about there and not beyond. The
# term vanishes with g, so that Newton's quadratic convergence stays. It makes the descent follow a slow gradient flow
# more closely, at a quarter less work.
CAUTION = 1.0

# Points at a time: what lies between the passes over them stays in the cache. Flat optimum; a law written in NumPy
# that is asked for all points of 512² at once takes three to four times as long.
BLOCK = 32768


class EnergyAndGradient(NamedTuple):
    """Energy, max|gradient|, Σ gradient² and Σ gradient at a gap; the sums run over all points."""

    energy: float
    largest: float
    square: float
    total: float


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _gradient(pressing, gap, traction, pressure, equilibrium, peak, right_side, curvature):
    """Write −(pressing + φ' + pressure), raise the curvature of points out of balance beyond the law's peak.

    Returns Σ (½ pressing + pressure)·d, max|gradient|, Σ gradient² and Σ gradient.
    """
    energy = 0.0
    largest = 0.0
    square = 0.0
    total = 0.0
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            d = gap[i, j]
            gradient = pressing[i, j] + traction[i, j] + pressure
            right_side[i, j] = -gradient
            if d > peak:
                curvature[i, j] += CAUTION * abs(gradient) / (d - equilibrium if gradient > 0.0 else d)
            energy += (0.5 * pressing[i, j] + pressure) * d
            largest = max(largest, abs(gradient))
            square += gradient * gradient
            total += gradient
    return energy, largest, square, total


def free_gradient(pressing, gap, traction, pressure, right_side, curvature):
    """As :meth:`LawPasses.gradient` of points on which no law acts."""
    return _gradient(pressing, gap, traction, pressure, 0.0, np.inf, right_side, curvature)


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
        for here in blocks(gap):
            traction[here] = self.law.traction(gap[here])
            stiffness[here] = self.law.stiffness(gap[here])
            total += float(np.sum(self.law.potential(gap[here])))
        return total

    def gradient(
        self,
        pressing: np.ndarray,
        gap: np.ndarray,
        traction: np.ndarray,
        pressure: float,
        right_side: np.ndarray,
        curvature: np.ndarray,
    ) -> tuple[float, float, float, float]:
        """Write −(pressing + φ' + pressure) into ``right_side``; raise ``curvature`` where points are out of balance.

        Returns Σ (½ pressing + pressure)·d, max|gradient|, Σ gradient² and Σ gradient.
        """
        law = self.law
        # Repulsion alone is convex: nothing to be cautious of, and its peak is no distance from its equilibrium.
        peak = law.peak_distance if law.attracts else np.inf
        return _gradient(pressing, gap, traction, pressure, law.equilibrium_distance, peak, right_side, curvature)

    def balance(
        self, pressing: np.ndarray, gap: np.ndarray, load: Load, right_side: np.ndarray, curvature: np.ndarray
    ) -> EnergyAndGradient:
        """Write −gradient and φ'', raised where points are out of balance, given K d + field; the law part by part."""
        energy, largest, square, total = load.energy, 0.0, 0.0, 0.0
        for here, traction in self._parts(gap):
            energy += self.evaluate(gap[here], traction, curvature[here])
            energy += load.rest_of_energy(pressing, gap, here)
            found = self.gradient(pressing[here], gap[here], traction, load.pressure, right_side[here], curvature[here])
            energy, largest = energy + found[0], max(largest, found[1])
            square, total = square + found[2], total + found[3]
        # A maximum passes over what is not a number.
        return EnergyAndGradient(energy, largest if np.isfinite(square) else np.inf, square, total)

    def act(self, gap: np.ndarray, traction: np.ndarray) -> float:
        """Write φ' alone, and return the sum of φ over all points (J/m²)."""
        total = 0.0
        for here, scratch in self._parts(gap):
            total += self.evaluate(gap[here], scratch, np.empty(scratch.shape, np.float32))
            traction[here] = scratch
        return total

    def imbalance(self, pressing: np.ndarray, gap: np.ndarray, pressure: float) -> float:
        """Mean of pressing + φ' + pressure over the points that are free to move."""
        total, free = 0.0, 0
        for here, traction in self._parts(gap):
            self.evaluate(gap[here], traction, np.empty(traction.shape, np.float32))
            traction += pressing[here]
            moving = self._free(gap[here])
            total, free = total + float(traction.sum(where=moving)), free + int(np.count_nonzero(moving))
        return total / free + pressure if free else 0.0

    def _parts(self, gap: np.ndarray) -> Iterable[tuple[slice, np.ndarray]]:
        """Rows to go through one after the other, and for each its part of a field that is not kept."""
        scratch = None
        for here in blocks(gap):
            rows = len(gap[here])
            scratch = np.empty_like(gap[here]) if scratch is None else scratch
            yield here, scratch[:rows]

    def _free(self, gap: np.ndarray) -> np.ndarray:
        """Which points are free to move; without a wall all."""
        return np.ones(gap.shape, bool)

    def hold(self, curvature: np.ndarray, step: np.ndarray) -> None:
        """Take a wall's points out of a step; without a wall none."""

    def pin(self, curvature: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """Make points that touch a wall as stiff as those it holds; which they are. Without a wall none."""
        return np.zeros(gap.shape, bool)

    def reaction(self, pressing: np.ndarray, gap: np.ndarray, pressure: float) -> np.ndarray | float:
        """Pressure of a wall, pressing + φ' + pressure where the gap is zero; without a wall none."""
        return 0.0

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
        for here in blocks(gap):
            _move(self.law, gap[here], step[here], limit, out[here])


def blocks(field: np.ndarray) -> Iterator[slice]:
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
