"""A law that acts in a part of the grid only: around it there is no surface, hence no force and no limit to a step."""

import numpy as np

from bem_adhesion.kernels.law import LawPasses, free_gradient
from bem_adhesion.kernels.wrapped import WrappedPasses
from bem_adhesion.operators.free_space import Window


class WindowPasses(WrappedPasses):
    """The passes of a law inside a window.

    Parameters
    ----------
    inner : LawPasses
        Those of the law.
    window : Window
        Where it acts.
    """

    def __init__(self, inner: LawPasses, window: Window):
        super().__init__(inner)
        self._window = window

    def evaluate(self, gap, traction, stiffness):
        inside = np.ascontiguousarray(self._window.inside(gap))
        own_traction, own_stiffness = np.empty_like(inside), np.empty(inside.shape, stiffness.dtype)
        total = self._inner.evaluate(inside, own_traction, own_stiffness)
        traction[...] = 0
        stiffness[...] = 0
        self._window.inside(traction)[...] = own_traction
        self._window.inside(stiffness)[...] = own_stiffness
        return total

    def gradient(self, pressing, gap, traction, pressure, right_side, curvature):
        rows, columns = self._window.slices
        inside = rows, columns
        padding = (rows, slice(columns.stop, None)), (slice(rows.stop, None), slice(None))
        energy, largest, square, total = self._inner.gradient(
            pressing[inside], gap[inside], traction[inside], pressure, right_side[inside], curvature[inside]
        )
        for here in padding:
            fields = pressing[here], gap[here], traction[here]
            found = free_gradient(*fields, pressure, right_side[here], curvature[here])
            energy, largest = energy + found[0], max(largest, found[1])
            square, total = square + found[2], total + found[3]
        return energy, largest, square, total

    def pin(self, curvature, gap):
        held = np.zeros(gap.shape, bool)
        inside = self._window.inside
        inside(held)[...] = self._inner.pin(inside(curvature), inside(gap))
        return held

    def reaction(self, pressing, gap, pressure):
        inside = self._window.inside
        own = self._inner.reaction(inside(pressing), inside(gap), pressure)
        if np.ndim(own) == 0:
            return own
        reaction = np.zeros_like(gap)
        inside(reaction)[...] = own
        return reaction

    def advance(self, gap, step, limit, out):
        np.add(gap, step, out=out)
        inside, own_step = (np.ascontiguousarray(self._window.inside(field)) for field in (gap, step))
        moved = np.empty_like(inside)
        self._inner.advance(inside, own_step, limit, moved)
        self._window.inside(out)[...] = moved

    def _free(self, gap):
        free = np.ones(gap.shape, bool)
        self._window.inside(free)[...] = self._inner._free(self._window.inside(gap))
        return free
