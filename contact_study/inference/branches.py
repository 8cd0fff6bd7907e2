"""Equilibrium states of a model as polylines, and the distance of measured states from them."""

from typing import NamedTuple

import numpy as np

from contact_study.numerics.kernel import kernel

_TINY = 1e-300
_BLOCK = 16  # segments of a polyline in one box


class Branch(NamedTuple):
    """States of one way, each array (3, states): displacement (m), force (N) and contact radius (m).

    ``before`` holds states before contact, ``after`` those in contact, both from loose to pressed. Without a jump
    between them, ``after`` begins where ``before`` ends.
    """

    before: np.ndarray
    after: np.ndarray


def split(states: np.ndarray, compliance: float) -> Branch:
    """Part a whole curve of equilibrium, from loose to pressed, at its folds under a spring in series (m/N)."""
    machine = states[0] + compliance * states[1]
    falls = np.flatnonzero(np.diff(machine) <= 0)
    if not falls.size:
        return Branch(states[:, :2], states[:, 1:])
    return Branch(states[:, : falls[0] + 1], _from_fold(states[:, falls[0] :], machine[falls[0] :]))


def held(branch: Branch, compliance: float) -> Branch:
    """The states of a branch that a spring in series (m/N) holds."""
    before, after = branch
    top = int(np.argmax(before[0] + compliance * before[1]))
    return Branch(before[:, : top + 1], _from_fold(after, after[0] + compliance * after[1]))


def _from_fold(states: np.ndarray, machine: np.ndarray) -> np.ndarray:
    """States from the last fold on; the fold is the vertex of a parabola through three states."""
    rises = np.diff(machine) > 0
    at = 0 if rises.all() else rises.size - int(np.argmin(rises[::-1]))
    if not 0 < at < machine.size - 1:
        return states[:, at:]
    bend = machine[at - 1] - 2 * machine[at] + machine[at + 1]
    slope = 0.5 * (machine[at + 1] - machine[at - 1])
    t = float(np.clip(-slope / max(bend, _TINY), -1, 1))
    left, middle, right = states[:, at - 1], states[:, at], states[:, at + 1]
    fold = middle + 0.5 * t * (right - left) + 0.5 * t * t * (left - 2 * middle + right)
    return np.concatenate([fold[:, None], states[:, at + (t >= 0) :]], axis=1)


def nearest(points: np.ndarray, lines: list[np.ndarray], errors: np.ndarray) -> np.ndarray:
    """States of polylines nearest to points, distances measured in errors.

    Parameters
    ----------
    points : numpy.ndarray
        Measured states, shape (axes, points).
    lines : list of numpy.ndarray
        Polylines, each of shape (axes, vertices).
    errors : numpy.ndarray
        Standard error along each axis, shape (axes,).

    Returns
    -------
    numpy.ndarray
        Shape (axes, points).

    Examples
    --------
    >>> nearest(np.array([[0.5], [1.0]]), [np.array([[0.0, 2.0], [0.0, 0.0]])], np.ones(2))
    array([[0.5],
           [0. ]])
    """
    ends = np.concatenate([line / errors[:, None] for line in lines], axis=1).T
    ways = np.zeros_like(ends)  # from the vertex before; none at the start of a line
    ways[1:] = np.diff(ends, axis=0)
    ways[np.cumsum([0, *(line.shape[1] for line in lines[:-1])])] = 0.0
    inverse = 1 / np.maximum((ways**2).sum(1), _TINY)
    found = np.empty((points.shape[1], points.shape[0]))
    _nearest(np.ascontiguousarray((points / errors[:, None]).T), np.ascontiguousarray(ends), ways, inverse, found)
    return found.T * errors[:, None]


@kernel
def _nearest(points, ends, ways, inverse, found):
    axes, count = points.shape[1], ends.shape[0]
    blocks = (count + _BLOCK - 1) // _BLOCK
    low, high = np.empty((blocks, axes)), np.empty((blocks, axes))  # boxes around the segments of each block
    for block in range(blocks):
        for axis in range(axes):
            least, most = np.inf, -np.inf
            for v in range(block * _BLOCK, min(block * _BLOCK + _BLOCK, count)):
                least = min(least, ends[v, axis], ends[v, axis] - ways[v, axis])
                most = max(most, ends[v, axis], ends[v, axis] - ways[v, axis])
            low[block, axis], high[block, axis] = least, most
    close = 0
    for p in range(points.shape[0]):
        # Measured points follow each other: the block of the last one comes first and rules out most others.
        first, best, far = close // _BLOCK, np.inf, 0.0
        for turn in range(blocks):
            block = first if turn == 0 else turn - 1 if turn <= first else turn
            outside = 0.0
            for axis in range(axes):
                outside += max(low[block, axis] - points[p, axis], points[p, axis] - high[block, axis], 0.0) ** 2
            if outside > best:
                continue
            for v in range(block * _BLOCK, min(block * _BLOCK + _BLOCK, count)):
                back = 0.0
                for axis in range(axes):
                    back += ways[v, axis] * (ends[v, axis] - points[p, axis])
                back = min(max(back * inverse[v], 0.0), 1.0)
                distance = 0.0
                for axis in range(axes):
                    distance += (points[p, axis] - ends[v, axis] + back * ways[v, axis]) ** 2
                if distance < best:
                    best, close, far = distance, v, back
        for axis in range(axes):
            found[p, axis] = ends[close, axis] - far * ways[close, axis]
