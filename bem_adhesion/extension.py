"""Extend a field from a contact set to the whole surface, smoothly: the heart of the hard-wall preconditioner.

On a contact set A the compliance C_AA must be inverted. The whole surface's stiffness K = C⁻¹ gives that inverse
as an energy minimum over extensions E of a field from A to everywhere, C_AA⁻¹ = min_E Eᵀ K E, and any stable
extension gives a preconditioner Eᵀ K E that one pair of transforms applies (the fictitious-domain argument of
S. V. Nepomnyaschikh; from memory, unchecked). Extension by zero, Eᵀ K E = K_AA, is poor where contact is many small
islands: each island's edge costs as much as a crack in the surface. Here the gaps between islands are filled from
local averages instead.

With m_l and c_l the averages of the field (zero outside A) and of A's indicator over cells of 2^l points, and U the
bilinear interpolation to the next finer cells,

    e_l = m_l + (1 − c_l) U e_{l+1},        E r = e_0,

so a point of A keeps its value, a hole takes the average of its neighbourhood, and a lone island's extension decays
with distance as the island's share of the cell. E is linear and local, costs about two passes over memory, and its
exact transpose is as cheap.
"""

from itertools import pairwise

import numpy as np
from numba import njit

_FAST = {"contract", "reassoc", "arcp", "nsz"}


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _average(fine, coarse):
    """Average over cells of 2 × 2 points; the last cell of an odd axis has one point along it."""
    rows, columns = fine.shape
    for i in range(coarse.shape[0]):
        upper = 2 * i
        lower = min(upper + 1, rows - 1)
        for j in range(coarse.shape[1]):
            left = 2 * j
            right = min(left + 1, columns - 1)
            # A missing second point is the first once more: the average is over the points that exist.
            coarse[i, j] = 0.25 * (
                np.float32(fine[upper, left])
                + np.float32(fine[upper, right])
                + np.float32(fine[lower, left])
                + np.float32(fine[lower, right])
            )


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _spread(coarse, fine):
    """Transpose of :func:`_average`, added to ``fine``."""
    rows, columns = fine.shape
    for i in range(rows):
        height = 0.5 if i < rows - 1 or rows % 2 == 0 else 1.0
        for j in range(columns):
            width = 0.5 if j < columns - 1 or columns % 2 == 0 else 1.0
            fine[i, j] += np.float32(height * width) * coarse[i // 2, j // 2]


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _fill(averages, coverage, coarse, filled):
    """filled = averages + (1 − coverage) U coarse, U bilinear between the centres of cells, periodic."""
    near, far = np.float32(0.75), np.float32(0.25)
    one = np.float32(1.0)
    rows, columns = filled.shape
    coarse_rows, coarse_columns = coarse.shape
    line = np.empty(coarse_columns, coarse.dtype)
    for i in range(rows):
        centre = i // 2
        other = (centre + 2 * (i % 2) - 1) % coarse_rows
        for j in range(coarse_columns):
            line[j] = near * coarse[centre, j] + far * coarse[other, j]
        for j in range(columns):
            if coverage[i, j] < one:
                side = j // 2 + 2 * (j % 2) - 1
                if side < 0:
                    side = coarse_columns - 1
                elif side == coarse_columns:
                    side = 0
                between = near * line[j // 2] + far * line[side]
                filled[i, j] = averages[i, j] + (one - coverage[i, j]) * between
            else:
                filled[i, j] = averages[i, j]


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _collect(fine, coverage, coarse):
    """coarse = Uᵀ (1 − coverage) fine, the transpose of what :func:`_fill` adds."""
    near, far = np.float32(0.75), np.float32(0.25)
    one = np.float32(1.0)
    rows, columns = fine.shape
    coarse_rows, coarse_columns = coarse.shape
    coarse[...] = 0
    line = np.empty(coarse_columns, coarse.dtype)
    for i in range(rows):
        line[...] = 0
        for j in range(columns):
            if coverage[i, j] < one:
                side = j // 2 + 2 * (j % 2) - 1
                if side < 0:
                    side = coarse_columns - 1
                elif side == coarse_columns:
                    side = 0
                value = (one - coverage[i, j]) * fine[i, j]
                line[j // 2] += near * value
                line[side] += far * value
        centre = i // 2
        other = (centre + 2 * (i % 2) - 1) % coarse_rows
        for j in range(coarse_columns):
            coarse[centre, j] += near * line[j]
            coarse[other, j] += far * line[j]


class Extension:
    """Extension of single-precision fields from a contact set to a periodic grid, and its transpose.

    Parameters
    ----------
    contact : numpy.ndarray of bool, shape (ny, nx)
        The contact set; it is kept, not copied: call :meth:`update` after changing it.
    """

    def __init__(self, contact: np.ndarray):
        self._coverage = [contact]
        self._average = []
        shape = contact.shape
        while max(shape) > 1:
            shape = ((shape[0] + 1) // 2, (shape[1] + 1) // 2)
            self._coverage.append(np.empty(shape, np.float32))
            self._average.append(np.empty(shape, np.float32))

    def update(self) -> None:
        """Take note of a changed contact set."""
        for fine, coarse in pairwise(self._coverage):
            _average(fine, coarse)

    def extend(self, field: np.ndarray, extended: np.ndarray) -> None:
        """Write E field into ``extended``; ``field`` must vanish outside the contact set."""
        levels = [field, *self._average]
        for fine, coarse in pairwise(levels):
            _average(fine, coarse)
        for level in range(len(levels) - 2, 0, -1):
            _fill(levels[level], self._coverage[level], levels[level + 1], levels[level])
        _fill(field, self._coverage[0], levels[1], extended)

    def transpose(self, field: np.ndarray) -> None:
        """Add Eᵀ's share from outside the contact set to ``field`` inside it, in place.

        Values outside the contact set are left over and have no meaning.
        """
        levels = [field, *self._average]
        for level, coverage in enumerate(self._coverage[:-1]):
            _collect(levels[level], coverage, levels[level + 1])
        for level in range(len(levels) - 2, -1, -1):
            _spread(levels[level + 1], levels[level])
