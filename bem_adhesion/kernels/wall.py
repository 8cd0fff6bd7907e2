"""Attraction outside a wall: the constraint gap >= 0 in a Newton solver, by projection.

A point that touches and is pressed against the wall is held: it leaves the linear solve, as if it were infinitely
stiff, and the wall takes up what is out of balance there, its reaction. All others move; who would pass through the
wall stops at it (D. P. Bertsekas, SIAM J. Control Optim. 20, 221 (1982): a projected Newton step whose matrix leaves
the held points alone descends). A converged state satisfies gap >= 0, reaction >= 0 and gap × reaction = 0 exactly, the
equilibrium of the free points and the sign of the reaction to the tolerance.
"""

import numpy as np
from numba import njit

from bem_adhesion.kernels.law import CAUTION, LawPasses, blocks
from bem_adhesion.kernels.lennard_jones import LennardJonesPasses
from bem_adhesion.kernels.window import WindowPasses
from bem_adhesion.linear.contact_stiffness import PINNED
from bem_adhesion.operators.free_space import Window
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.laws.dugdale import Dugdale
from contact_study.physics.laws.exponential import Exponential
from contact_study.physics.laws.lennard_jones import LennardJones

# Stiffness of a point that is held, over the largest of the solid: infinite to the accuracy of a linear solve, and far
# from the rounding of single precision.
HELD = 1e3

# Exponents below it are raised to it: where an exponential rounds to zero it takes fourteen times as long.
LEAST_EXPONENT = -700.0
# Beside one, in double precision.
NO_SUMMAND = 1e-17


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _gradient(pressing, gap, traction, pressure, margin, held, right_side, curvature):
    """As ``law_passes._gradient`` outside a wall; held points are balanced and get the curvature ``held``."""
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


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _advance(gap, step, limit, margin, out):
    """Each gap plus its step, by no more than the fraction ``limit`` of gap and margin, and not through the wall."""
    for i in range(gap.size):
        d = gap[i]
        most = limit * (d + margin)
        out[i] = max(d + min(max(step[i], -most), most), 0.0)


class WallPasses(LawPasses):
    """The passes of a law outside a wall.

    Parameters
    ----------
    law : TractionLaw
        The law.
    largest : float
        Largest stiffness of the elastic solid (Pa/m).
    """

    def __init__(self, law: TractionLaw, largest: float):
        super().__init__(law)
        self.margin = law.length
        self._held = np.float32(HELD * largest)

    def gradient(self, pressing, gap, traction, pressure, right_side, curvature):
        return _gradient(pressing, gap, traction, pressure, self.margin, self._held, right_side, curvature)

    def hold(self, curvature, step):
        step[curvature == self._held] = 0

    def pin(self, curvature, gap):
        held = gap == 0
        curvature[held] = np.float32(PINNED / HELD) * self._held
        return held

    def reaction(self, pressing, gap, pressure):
        reaction = np.zeros_like(gap)
        for here, traction in self._parts(gap):
            self.evaluate(gap[here], traction, np.empty(traction.shape, np.float32))
            np.copyto(reaction[here], pressing[here] + traction + pressure, where=gap[here] == 0)
        return reaction

    def _free(self, gap):
        return gap > 0

    def advance(self, gap, step, limit, out):
        _advance(gap.reshape(-1), step.reshape(-1), limit, self.margin, out.reshape(-1))


class ExponentialPasses(WallPasses):
    """The exponential law, by one exponential a point; NumPy's is a vector's, unlike that of a compiled loop."""

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


class DugdalePasses(WallPasses):
    """Dugdale's law, by one exponential and one logarithm a point."""

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
            # Off the ramp, where most points are, the logarithm is none.
            total += float(np.log1p(fading[fading > NO_SUMMAND]).sum() - np.minimum(past, 0.0).sum())
        return -law.plateau * law.width * total


def passes_of(law: TractionLaw, largest: float = 1.0, window: Window | None = None) -> LawPasses:
    """The passes of a law, compiled ones where there are any.

    Parameters
    ----------
    law : TractionLaw
        The law.
    largest : float, optional
        Largest stiffness of the elastic solid (Pa/m).
    window : Window, optional
        Where on the grid there is a surface; everywhere without one.
    """
    passes = _passes_of(law, largest)
    return passes if window is None else WindowPasses(passes, window)


def _passes_of(law: TractionLaw, largest: float) -> LawPasses:
    if isinstance(law, LennardJones):
        return LennardJonesPasses(law)
    if isinstance(law, Exponential):
        return ExponentialPasses(law, largest)
    if isinstance(law, Dugdale):
        return DugdalePasses(law, largest)
    return WallPasses(law, largest) if law.has_wall else LawPasses(law)
