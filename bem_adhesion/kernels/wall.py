"""Kernels of attraction outside a wall: the constraint gap >= 0 in a Newton solver, by projection.

A point that touches and is pressed against the wall is held: it leaves the linear solve, as if it were infinitely
stiff, and the wall's reaction balances it. All other points move, and stop at the wall (D. P. Bertsekas, SIAM J.
Control Optim. 20, 221 (1982): such a projected Newton step descends). A converged state satisfies gap >= 0, reaction
>= 0 and gap × reaction = 0 exactly, the equilibrium of the free points and the sign of the reaction to the tolerance.
"""

import numpy as np

from bem_adhesion.kernels.law import CAUTION, LawKernels, blocks
from contact_study.numerics.kernel import kernel
from contact_study.physics.laws import Dugdale, TractionLaw

# Stiffness of a held point over the largest of the solid: infinite to the accuracy of a linear solve in a descent, and
# far from the rounding of single precision; and, larger, where a contact stiffness is computed.
HELD, PINNED = 1e3, 1e6
# Smaller exponents are raised to it: where an exponential rounds to zero it takes fourteen times as long.
LEAST_EXPONENT = -700.0
# Negligible beside one in double precision.
NO_SUMMAND = 1e-17


@kernel
def _gradient(pressing, gap, traction, pressure, margin, held, right_side, curvature):
    """Form the gradient outside a wall; held points are balanced and have the curvature ``held``."""
    energy = 0.0
    largest = 0.0
    square = 0.0
    total = 0.0
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            d = gap[i, j]
            gradient = pressing[i, j] + traction[i, j] + pressure
            energy += (0.5 * pressing[i, j] + pressure) * d
            if d == 0.0 and gradient > 0.0:
                right_side[i, j] = 0.0
                curvature[i, j] = held
            else:
                right_side[i, j] = -gradient
                curvature[i, j] += CAUTION * abs(gradient) / (d + margin)
                largest = max(largest, abs(gradient))
                square += gradient * gradient
                total += gradient
    return energy, largest, square, total


@kernel
def _advance(gap, step, limit, margin, out):
    """Add each step, limited to the fraction ``limit`` of gap and margin, and stop at the wall."""
    for i in range(gap.size):
        d = gap[i]
        most = limit * (d + margin)
        out[i] = max(d + min(max(step[i], -most), most), 0.0)


class WallKernels(LawKernels):
    """Kernels of any law outside a wall."""

    def __init__(self, law: TractionLaw, largest: float):
        super().__init__(law)
        self.margin = law.length
        self.held = np.float32(HELD * largest)

    def gradient(self, pressing, gap, traction, pressure, right_side, curvature):
        return _gradient(pressing, gap, traction, pressure, self.margin, self.held, right_side, curvature)

    def advance(self, gap, step, limit, out):
        _advance(gap.reshape(-1), step.reshape(-1), limit, self.margin, out.reshape(-1))


class ExponentialKernels(WallKernels):
    """Kernels of the exponential law, by one exponential a point: NumPy's is vectorised, unlike a compiled loop's."""

    def evaluate(self, gap, traction, stiffness):
        law, total = self.law, 0.0
        for here in blocks(gap):
            tension = np.multiply(gap[here], -1 / law.length, out=traction[here])
            np.maximum(tension, LEAST_EXPONENT, out=tension)
            np.exp(tension, out=tension)
            tension *= law.work_of_adhesion / law.length
            np.multiply(tension, -1 / law.length, out=stiffness[here], casting="same_kind")
            total -= law.length * float(tension.sum())
        return total


class DugdaleKernels(WallKernels):
    """Kernels of Dugdale's law, by one exponential and one logarithm a point."""

    law: Dugdale

    def evaluate(self, gap, traction, stiffness):
        law, total = self.law, 0.0
        for here in blocks(gap):
            past = (gap[here] - law.length) / law.width
            exponent = np.maximum(-np.abs(past), LEAST_EXPONENT)
            fading = np.exp(exponent, out=exponent)
            share = 1 / (1 + fading)
            faded = share * fading
            np.multiply(law.plateau, np.where(past > 0, faded, share), out=traction[here])
            np.multiply(-law.plateau / law.width * share, faded, out=stiffness[here], casting="same_kind")
            # Off the ramp, where most points are, the logarithm vanishes.
            total += float(np.log1p(fading[fading > NO_SUMMAND]).sum() - np.minimum(past, 0.0).sum())
        return -law.plateau * law.width * total
