"""The passes of a law with something around them, which takes all points at once."""

import numpy as np

from bem_adhesion.kernels.law import LawPasses


class WrappedPasses(LawPasses):
    """Those of a law as they are, for a subclass to change.

    Parameters
    ----------
    inner : LawPasses
        Those of the law.
    """

    def __init__(self, inner: LawPasses):
        super().__init__(inner.law)
        self.margin = inner.margin
        self._inner = inner

    def evaluate(self, gap, traction, stiffness):
        return self._inner.evaluate(gap, traction, stiffness)

    def gradient(self, pressing, gap, traction, pressure, right_side, curvature):
        return self._inner.gradient(pressing, gap, traction, pressure, right_side, curvature)

    def hold(self, curvature, step):
        self._inner.hold(curvature, step)

    def pin(self, curvature, gap):
        return self._inner.pin(curvature, gap)

    def reaction(self, pressing, gap, pressure):
        return self._inner.reaction(pressing, gap, pressure)

    def advance(self, gap, step, limit, out):
        self._inner.advance(gap, step, limit, out)

    def _parts(self, gap):
        yield slice(None), np.empty_like(gap)

    def _free(self, gap):
        return self._inner._free(gap)
