"""Anderson's acceleration of a fixed point. D. G. Anderson, J. ACM 12, 547 (1965), doi:10.1145/321296.321305."""

from collections.abc import Callable

import numpy as np
from numba import njit

# Added to the normal equations of the least squares, relative to their trace: differences may be parallel.
_REGULARISATION = 1e-12

# Values that are worked on at a time: those of all remembered states fit into the cache of a core.
_BLOCK = 256


def accelerated(
    update: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, float]],
    values: np.ndarray,
    bounds: tuple[float, float],
    tolerance: float,
    iterations: int,
    mixing: float = 0.5,
    memory: int = 10,
) -> tuple[np.ndarray, float, int]:
    """Iterate until the change that ``update`` reports is within the tolerance.

    Parameters
    ----------
    update : callable
        The residual, image less argument, of values, the weight of each in the least squares, and the change to be
        stopped at.
    values : numpy.ndarray
        First values; they are not changed.
    bounds : pair of float
        Where values are kept.
    tolerance : float
        Largest change of the last iteration.
    iterations : int
        Updates at most.
    mixing : float, optional
        Share of the residual that a step takes in directions which are not remembered.
    memory : int, optional
        States that are remembered.

    Returns
    -------
    values : numpy.ndarray
        Those of the last update.
    change : float
        Its change; infinite if the next values were no numbers.
    count : int
        Updates made.
    """
    residual, weight, change = update(values)
    count = 1
    moves, turns = np.empty((2, memory, values.size))
    normal, right = np.empty((memory, memory)), np.empty(memory)
    while tolerance < change < np.inf and count < iterations:
        held = min(count - 1, memory)
        shares = np.zeros(held)
        if held:
            _normal_equations(turns[:held], weight.ravel(), residual.ravel(), normal, right)
            own = normal[:held, :held] + _REGULARISATION * np.trace(normal[:held, :held]) * np.eye(held)
            shares = np.linalg.solve(own, right[:held])
        step = np.empty_like(values)
        _step(shares, mixing, moves[:held], turns[:held], residual.ravel(), step.ravel())
        before, moved = residual, np.clip(values + step, *bounds)
        residual, weight, change = update(moved)
        if not np.isfinite(change):  # what the caller keeps of the last update is to be numbers
            update(values)
            return values, np.inf, count + 2
        oldest = (count - 1) % memory
        moves[oldest], turns[oldest] = (moved - values).ravel(), (residual - before).ravel()
        values = moved
        count += 1
    return values, change, count


# Products of a few long vectors, without the threads that a library of linear algebra would start for them.


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz", "reassoc"})
def _normal_equations(turns, weight, residual, normal, right):
    """Fill the weighted products of the turns with each other and with the residual."""
    held, size = turns.shape
    scaled, aim = np.empty((held, _BLOCK)), np.empty(_BLOCK)
    normal[:] = 0.0
    right[:] = 0.0
    for first in range(0, size, _BLOCK):
        count = min(_BLOCK, size - first)
        for k in range(count):
            aim[k] = weight[first + k] * residual[first + k]
        for i in range(held):
            for k in range(count):
                scaled[i, k] = weight[first + k] * turns[i, first + k]
        # Sums in loops that write nothing: otherwise their order depends on where the arrays lie in memory.
        for i in range(held):
            total = 0.0
            for k in range(count):
                total += scaled[i, k] * aim[k]
            right[i] += total
            for j in range(i + 1):
                total = 0.0
                for k in range(count):
                    total += scaled[i, k] * scaled[j, k]
                normal[i, j] += total
    for i in range(held):
        for j in range(i):
            normal[j, i] = normal[i, j]


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _step(shares, mixing, moves, turns, residual, step):
    """Fill the step from the residual and the shares of the remembered states."""
    held, size = moves.shape
    for first in range(0, size, _BLOCK):
        last = min(first + _BLOCK, size)
        for k in range(first, last):
            step[k] = mixing * residual[k]
        for j in range(held):
            for k in range(first, last):
                step[k] -= shares[j] * (moves[j, k] + mixing * turns[j, k])
