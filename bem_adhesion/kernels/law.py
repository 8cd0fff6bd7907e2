"""Kernels of a traction-separation law for a Newton solver: energy and derivatives, gradient, and where a step ends.

:class:`LawKernels` calls the functions of any law with a repulsive core. Laws that large grids need have compiled
kernels with the same meaning; laws outside a wall are in :mod:`bem_adhesion.kernels.wall`.
"""

from collections.abc import Iterator

import numpy as np

from contact_study.numerics.kernel import kernel
from contact_study.physics.laws.base import TractionLaw

# Pressure at which a point ends that enters repulsion in one step, in units of the law's peak: it holds the point there
# and its overshoot does not decide the line search (research/notes/adhesive_solver.md).
LANDING = 0.35
# An attracted point out of balance by a stress g gains the curvature CAUTION |g| / distance, so that it steps about to
# equilibrium and not beyond. The term vanishes with g: Newton's quadratic convergence stays.
CAUTION = 1.0
# Points at a time: arrays between two loops over so many stay in the cache.
BLOCK = 32768


def blocks(field: np.ndarray) -> Iterator[slice]:
    """Yield slices of rows with about :data:`BLOCK` points each."""
    rows = max(1, BLOCK // field[0].size)
    return (slice(first, first + rows) for first in range(0, len(field), rows))


@kernel
def _gradient(pressing, gap, traction, pressure, equilibrium, peak, right_side, curvature):
    """Write −(pressing + φ' + pressure); raise the curvature of points beyond the peak that are out of balance."""
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


def free_gradient(
    pressing: np.ndarray,
    gap: np.ndarray,
    traction: np.ndarray,
    pressure: float,
    right_side: np.ndarray,
    curvature: np.ndarray,
) -> tuple[float, float, float, float]:
    """Form the gradient as :meth:`LawKernels.gradient` for points on which no law acts."""
    return _gradient(pressing, gap, traction, pressure, 0.0, np.inf, right_side, curvature)


class LawKernels:
    """Kernels of any law."""

    margin = 0.0

    def __init__(self, law: TractionLaw):
        self.law = law

    def evaluate(self, gap: np.ndarray, traction: np.ndarray, stiffness: np.ndarray) -> float:
        """Write φ' and φ'' of ``gap`` into the two arrays; return Σ φ over all points (J/m²)."""
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
        # Repulsion alone is convex: it needs no caution, and its peak is not beyond its equilibrium.
        peak = law.peak_distance if law.attracts else np.inf
        return _gradient(pressing, gap, traction, pressure, law.equilibrium_distance, peak, right_side, curvature)

    def advance(self, gap: np.ndarray, step: np.ndarray, limit: float, out: np.ndarray) -> None:
        """Write the gap after a Newton step, moving each point in the variable in which it is nearly linear.

        A point in repulsion moves by ``step`` in its linearised traction φ' + φ''·step, from which the gap follows by
        :meth:`TractionLaw.repulsive_gap`; another moves in its gap. A point that enters repulsion does so along the
        tangent at equilibrium, down to a pressure of LANDING times the law's peak. Otherwise one point deep in
        repulsion would shorten the step of all.
        """
        for here in blocks(gap):
            _advance(self.law, gap[here], step[here], limit, out[here])


def _advance(law: TractionLaw, gap: np.ndarray, step: np.ndarray, limit: float, out: np.ndarray) -> None:
    equilibrium, tangent = law.equilibrium_distance, law.equilibrium_stiffness
    np.add(gap, np.clip(step, -limit * gap, limit * gap), out=out)
    # The law's functions are called for these few points alone.
    near = np.minimum(gap, out) < equilibrium
    gap, step, moved = gap[near], step[near], out[near]
    repelled = gap < equilibrium
    # Without a peak there is nothing to overshoot: points end on the tangent.
    largest = LANDING * law.peak_tensile_stress or np.inf
    traction = np.maximum(tangent * (moved - equilibrium), -largest)
    traction[repelled] = law.traction(gap[repelled]) + law.stiffness(gap[repelled]) * step[repelled]
    moved[repelled] = equilibrium + np.minimum(traction[repelled] / tangent, limit * equilibrium)
    pressed = traction < 0
    moved[pressed] = law.repulsive_gap(traction[pressed])
    out[near] = moved
