"""A law on points that are dragged: springs tie each of them to where it was."""

import numpy as np

from bem_adhesion.law_passes import LawPasses


class DraggedPasses(LawPasses):
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
        super().__init__(inner.law)
        self.margin = inner.margin
        self._inner = inner
        self._drag = drag
        self._anchor = anchor

    def evaluate(self, gap, traction, stiffness):
        potential = self._inner.evaluate(gap, traction, stiffness)
        stretch = gap - self._anchor
        pull = self._drag * stretch
        potential += 0.5 * float(np.vdot(pull, stretch))
        traction += pull
        return potential

    def gradient(self, elastic, gap, traction, load, pressure, right_side, curvature):
        result = self._inner.gradient(elastic, gap, traction, load, pressure, right_side, curvature)
        free = np.ones_like(curvature)
        self._inner.hold(curvature, free)
        curvature += np.asarray(self._drag, np.float32) * free
        return result

    def hold(self, curvature, step):
        self._inner.hold(curvature, step)

    def pin(self, curvature, gap):
        return self._inner.pin(curvature, gap)

    def reaction(self, elastic, gap, load):
        return self._inner.reaction(elastic, gap, load)

    def _parts(self, gap):
        yield slice(None), np.empty_like(gap)

    def _free(self, gap):
        return self._inner._free(gap)

    def advance(self, gap, step, limit, out):
        self._inner.advance(gap, step, limit, out)
