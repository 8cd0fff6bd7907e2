"""Smooth extension of a field from a contact set to the whole surface: the core of the hard-wall preconditioner.

C_AA⁻¹ = min_E Eᵀ K E for any stable extension E. Here E r = e_0 of e_l = m_l + (1 − c_l) U e_{l+1}: m_l and c_l are
averages of the field and of A's indicator over cells of 2^l points, U interpolates to the next finer cells.
"""

from itertools import pairwise

import numpy as np

from contact_study.numerics.kernel import kernel

# Unsigned indices, which do not count from the end, and two points at a time: loops without a branch, which vectorise.
_ONE, _TWO = np.uint64(1), np.uint64(2)
_FULL = np.float32(1)
_NEAR, _FAR = np.float32(0.75), np.float32(0.25)  # weights of the centres of cells about a point


@kernel
def _average(fine, coarse):
    """Write averages over cells of 2 × 2 points; the last cell of an odd axis has one point along it."""
    rows, columns = fine.shape
    for i in range(coarse.shape[0]):
        # A missing second point is the first once more: the average is over the points that exist.
        upper, lower, cells = fine[2 * i], fine[min(2 * i + 1, rows - 1)], coarse[i]
        for j in range(np.uint64(columns // 2)):
            left = _TWO * j
            right = left + _ONE
            above = np.float32(upper[left]) + np.float32(upper[right])
            below = np.float32(lower[left]) + np.float32(lower[right])
            cells[j] = np.float32(0.25) * (above + below)
        if columns % 2:
            cells[-1] = np.float32(0.5) * (np.float32(upper[-1]) + np.float32(lower[-1]))


@kernel
def _spread(coarse, fine):
    """Add the transpose of :func:`_average` to ``fine``."""
    rows, columns = fine.shape
    for i in range(rows):
        share = np.float32(0.25 if i < rows - 1 or rows % 2 == 0 else 0.5)
        points, cells = fine[i], coarse[i // 2]
        for j in range(np.uint64(columns // 2)):
            part = share * cells[j]
            points[_TWO * j] += part
            points[_TWO * j + _ONE] += part
        if columns % 2:
            points[-1] += np.float32(2) * share * cells[-1]


@kernel
def _rows_about(coarse, i):
    """Return the row of cells that contains row i of the points, and the next nearest."""
    centre = i // 2
    return coarse[centre], coarse[(centre + 2 * (i % 2) - 1) % coarse.shape[0]]


@kernel
def _fill(averages, coverage, coarse, filled):
    """Write averages + (1 − coverage) U coarse, U bilinear between the centres of cells, periodic."""
    rows, columns = filled.shape
    coarse_columns = coarse.shape[1]
    line = np.empty(coarse_columns + 2, coarse.dtype)  # cells with the periodic image before and after
    for i in range(rows):
        near, far = _rows_about(coarse, i)
        for j in range(np.uint64(coarse_columns)):
            line[j + _ONE] = _NEAR * near[j] + _FAR * far[j]
        line[0], line[-1] = line[-2], line[1]
        means, covered, out = averages[i], coverage[i], filled[i]
        for j in range(np.uint64(columns // 2)):
            left = _TWO * j
            right = left + _ONE
            own = _NEAR * line[j + _ONE]
            out[left] = means[left] + (_FULL - np.float32(covered[left])) * (own + _FAR * line[j])
            out[right] = means[right] + (_FULL - np.float32(covered[right])) * (own + _FAR * line[j + _TWO])
        if columns % 2:
            between = _NEAR * line[-2] + _FAR * line[-3]
            out[-1] = means[-1] + (_FULL - np.float32(covered[-1])) * between


@kernel
def _collect(fine, coverage, coarse):
    """Write Uᵀ (1 − coverage) fine, the transpose of what :func:`_fill` adds."""
    rows, columns = fine.shape
    coarse_columns = coarse.shape[1]
    coarse[...] = 0
    line = np.empty(coarse_columns, coarse.dtype)
    # Points with the periodic image before and after; a missing second point of the last cell is zero.
    outside = np.zeros(2 * coarse_columns + 2, coarse.dtype)
    for i in range(rows):
        values, covered = fine[i], coverage[i]
        for j in range(np.uint64(columns)):
            outside[j + _ONE] = (_FULL - np.float32(covered[j])) * values[j]
        outside[0], outside[-1] = outside[-2], outside[1]
        for j in range(np.uint64(coarse_columns)):
            first = _TWO * j
            within = outside[first + _ONE] + outside[first + _TWO]
            line[j] = _NEAR * within + _FAR * (outside[first] + outside[first + _TWO + _ONE])
        near, far = _rows_about(coarse, i)
        for j in range(np.uint64(coarse_columns)):
            near[j] += _NEAR * line[j]
        for j in range(np.uint64(coarse_columns)):  # on a coarse grid of one row it is the same
            far[j] += _FAR * line[j]


class Extension:
    """Extension of float32 fields from a contact set, and its transpose; :meth:`update` it when the set changes."""

    def __init__(self, contact: np.ndarray):
        self._coverage = [contact]
        self._average = []
        shape = contact.shape
        while max(shape) > 1:
            shape = ((shape[0] + 1) // 2, (shape[1] + 1) // 2)
            self._coverage.append(np.empty(shape, np.float32))
            self._average.append(np.empty(shape, np.float32))

    def update(self) -> None:
        """Adapt to a changed contact set."""
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
        """Add Eᵀ's share from outside the contact set to ``field`` inside it; values outside are then meaningless."""
        levels = [field, *self._average]
        for level, coverage in enumerate(self._coverage[:-1]):
            _collect(levels[level], coverage, levels[level + 1])
        for level in range(len(levels) - 2, -1, -1):
            _spread(levels[level + 1], levels[level])
