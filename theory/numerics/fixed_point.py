"""Anderson's acceleration of a fixed point. D. G. Anderson, J. ACM 12, 547 (1965), doi:10.1145/321296.321305."""

from collections.abc import Callable

import numpy as np
from numba import njit

from contact_study.numerics import life

_REGULARISATION = 1e-12  # of the least squares, relative to their trace: differences may be parallel
_BLOCK = 256  # values that are worked on at a time: those of all remembered states fit into the cache of a core


def accelerated(
    update: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, float]],
    values: np.ndarray,
    bounds: tuple[float, float],
    tolerance: float,
    iterations: int,
    mixing: float = 0.5,
    memory: int = 10,
    largest_step: float = np.inf,
    restarts: int = 0,
) -> tuple[np.ndarray, float, int]:
    """Iterate until the change that ``update`` reports is within the tolerance; values, change and count of updates.

    ``update`` gives the residual, image less argument, of values, the weight of each in the least squares, and the
    change. A step takes the share ``mixing`` of the residual in directions which are not among the ``memory`` last
    ones; one that leads to no numbers is halved up to ``restarts`` times in a row, and then the change is infinite.
    """
    residual, weight, change = update(values)
    count, held, oldest = 1, 0, 0
    moves, turns = np.empty((2, memory, values.size))
    products = np.empty((memory + 2, memory + 2))
    halvings = 0
    while tolerance < change < np.inf and count < iterations:
        life.beat(change)
        shares: np.ndarray = np.zeros(held)
        if held:
            _weighted_products(turns[:held], weight.ravel(), residual.ravel(), products)
            own = products[:held, :held].copy()
            own.flat[:: held + 1] += _REGULARISATION * own.trace()
            shares = np.linalg.solve(own, products[held, :held])
        before, moved = residual, np.empty_like(values)
        size = largest_step, 0.5**halvings
        _step(shares, mixing, moves[:held], residual.ravel(), values.ravel(), size, bounds, moved.ravel())
        residual, weight, change = update(moved)
        count += 1
        if not np.isfinite(change):  # what the caller keeps of the last update is to be numbers
            residual, weight, change = update(values)
            count += 1
            if halvings == restarts:
                return values, np.inf, count
            halvings += 1
            held = oldest = 0
            continue
        halvings = max(halvings - 1, 0)
        both = (moved.ravel(), values.ravel()), (residual.ravel(), before.ravel())
        _remember(*both, mixing, turns[oldest], moves[oldest])
        oldest = (oldest + 1) % memory
        held = min(held + 1, memory)
        values = moved
    return values, change, count


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz", "reassoc"})
def _weighted_products(turns, weight, residual, products):
    """Fill the products of the turns, symmetric, and in the row after them the residual's, all times the weight."""
    held, size = turns.shape
    rows = held + 1 + (held + 1) % 2  # two at a time, each of which is read once for two products
    scaled = np.zeros((rows, _BLOCK))
    products[:] = 0.0
    for first in range(0, size, _BLOCK):
        count = min(_BLOCK, size - first)
        share = weight[first : first + count]
        scaled[:, count:] = 0.0
        for i in range(held + 1):
            source = turns[i, first : first + count] if i < held else residual[first : first + count]
            part = scaled[i]
            for k in range(count):
                part[k] = share[k] * source[k]
        # Sums in loops that write nothing: otherwise their order depends on where the arrays lie in memory.
        for i in range(0, rows, 2):
            one, two = scaled[i], scaled[i + 1]
            for j in range(0, i + 1, 2):
                three, four = scaled[j], scaled[j + 1]
                a = b = c = d = 0.0
                for k in range(_BLOCK):
                    a += one[k] * three[k]
                    b += one[k] * four[k]
                    c += two[k] * three[k]
                    d += two[k] * four[k]
                products[i, j] += a
                products[i, j + 1] += b
                products[i + 1, j] += c
                products[i + 1, j + 1] += d
    for i in range(held):
        for j in range(i):
            products[j, i] = products[i, j]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _remember(values, residuals, mixing, turn, move):
    """Fill the turn of the residual, and the move of the values with the mixed share of it: what a step takes back."""
    after, before = values
    late, early = residuals
    for k in range(turn.size):
        turn[k] = late[k] - early[k]
        move[k] = after[k] - before[k] + mixing * turn[k]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _step(shares, mixing, moves, residual, values, size, bounds, moved):
    """Fill the values after a step, made of the residual and the remembered states.

    ``size`` is the largest step and the share of it that is taken. Comparisons let pass what is no number.
    """
    for k in range(moved.size):
        moved[k] = mixing * residual[k]
    for j in range(shares.size):
        share, move = shares[j], moves[j]
        for k in range(moved.size):
            moved[k] -= share * move[k]
    largest, part = size
    low, high = bounds
    for k in range(moved.size):
        step = moved[k]
        step = largest if step > largest else -largest if step < -largest else step
        value = values[k] + part * step
        moved[k] = low if value < low else high if value > high else value
