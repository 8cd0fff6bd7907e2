"""Anderson's acceleration of a fixed point. D. G. Anderson, J. ACM 12, 547 (1965), doi:10.1145/321296.321305."""

from collections.abc import Callable

import numpy as np
from numba import njit

# Added to the normal equations of the least squares, relative to their trace: differences may be parallel.
_REGULARISATION = 1e-12

# Change above which the weights of the least squares are taken anew after an update; below they hardly change. With
# 1e-2 the hardest state of the paper's study, the third of the curve at 8 ε0, is not found in one step any more.
_SETTLED = 1e-3


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
        stopped at. Weights stay as they are where the change is small.
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
    remembered = _Memory(values.size, memory, mixing, weight)
    while tolerance < change < np.inf and count < iterations:
        before, moved = residual, remembered.step(residual)
        moved += values
        np.clip(moved, *bounds, out=moved)
        residual, weight, change = update(moved)
        if not np.isfinite(change):  # what the caller keeps of the last update is to be numbers
            update(values)
            return values, np.inf, count + 2
        remembered.add(values, moved, before, residual)
        if change > _SETTLED:
            remembered.weigh(weight)
        values = moved
        count += 1
    return values, change, count


class _Memory:
    """Steps that the iteration has taken, each with how the residual turned by it."""

    def __init__(self, size: int, states: int, mixing: float, weight: np.ndarray) -> None:
        self._mixing, self._weight = mixing, weight.ravel() ** 2
        self._turns = np.empty((states, size))
        self._steps = np.empty((states, size))  # the moves of the values, and plain mixing of the turns
        self._normal, self._right, self._weighted = np.empty((states, states)), np.empty(states), np.empty(size)
        self._count = 0

    def add(self, values: np.ndarray, moved: np.ndarray, before: np.ndarray, residual: np.ndarray) -> None:
        """Remember a step instead of the oldest one: the values and the residual before and after it."""
        newest = self._count % len(self._turns)
        self._count += 1
        turn, step = self._turns[newest], self._steps[newest]
        np.subtract(residual.ravel(), before.ravel(), out=turn)
        np.subtract(moved.ravel(), values.ravel(), out=step)
        _take_one(-self._mixing, turn, step)
        self._fill(newest)  # as weights stay, one row and column of the normal equations is all that changes

    def weigh(self, weight: np.ndarray) -> None:
        """Set the weight of each value in the least squares."""
        np.square(weight.ravel(), out=self._weight)
        for number in range(self._held):
            self._fill(number)

    def step(self, residual: np.ndarray) -> np.ndarray:
        """The step of the values that a residual asks for: the remembered turns take off it what they can."""
        step = self._mixing * residual
        if held := self._held:
            normal = self._normal[:held, :held]
            np.multiply(self._weight, residual.ravel(), out=self._weighted)
            _products(self._turns[:held], self._weighted, self._right)
            own = normal + _REGULARISATION * np.trace(normal) * np.eye(held)
            _take(np.linalg.solve(own, self._right[:held]), self._steps[:held], step.ravel())
        return step

    def _fill(self, number: int) -> None:
        """The row and column of a remembered step in the normal equations."""
        held = self._held
        np.multiply(self._weight, self._turns[number], out=self._weighted)
        _products(self._turns[:held], self._weighted, self._normal[number])
        self._normal[:held, number] = self._normal[number, :held]

    @property
    def _held(self) -> int:
        return min(self._count, len(self._turns))


# Sums over a few long vectors, without the threads that a library of linear algebra would start for them.


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _products(turns, values, products):
    """Fill the products of the turns with values."""
    for i in range(turns.shape[0]):
        products[i] = _product(turns[i], values)


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz", "reassoc"})
def _product(one, other):
    """A sum of its own function: the compiler makes vectors of it, and its order depends on its length alone."""
    total = 0.0
    for k in range(one.size):
        total += one[k] * other[k]
    return total


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _take(shares, steps, step):
    """Take the shares of the remembered steps off a step."""
    for j in range(shares.size):
        _take_one(shares[j], steps[j], step)


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _take_one(share, taken, step):
    """Of its own for the reason of the product."""
    for k in range(step.size):
        step[k] -= share * taken[k]
