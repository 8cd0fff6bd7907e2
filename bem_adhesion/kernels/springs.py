"""A law on points that are dragged: springs tie each of them to where it was."""

import numpy as np

from bem_adhesion.kernels.law import LawPasses
from bem_adhesion.kernels.wrapped import WrappedPasses
from contact_study.numerics.inner_product import inner_product


class DraggedPasses(WrappedPasses):
    """The passes of a law, and of springs in parallel to it.

    Parameters
    ----------
    inner : LawPasses
        Those of the law.
    drag : float or numpy.ndarray
        Stiffness of the springs, of all or of each (Pa/m).
    anchor : numpy.ndarray
        Gap at which they are at rest (m).
    """

    def __init__(self, inner: LawPasses, drag: float | np.ndarray, anchor: np.ndarray):
        super().__init__(inner)
        self._drag = drag
        self._anchor = anchor

    def evaluate(self, gap, traction, stiffness):
        potential = super().evaluate(gap, traction, stiffness)
        stretch = gap - self._anchor
        pull = self._drag * stretch
        potential += 0.5 * inner_product(pull, stretch)
        traction += pull
        return potential

    def gradient(self, pressing, gap, traction, pressure, right_side, curvature):
        result = super().gradient(pressing, gap, traction, pressure, right_side, curvature)
        free = np.ones_like(curvature)
        self._inner.hold(curvature, free)
        curvature += np.asarray(self._drag, np.float32) * free
        return result
