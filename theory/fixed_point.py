"""Anderson's acceleration of a fixed point. D. G. Anderson, J. ACM 12, 547 (1965), doi:10.1145/321296.321305."""

from collections.abc import Callable

import numpy as np

# States that are remembered, and the share of the residual that is taken.
_MEMORY, _MIXING = 10, 0.5

# Added to the normal equations of the least squares, relative to their trace: differences may be parallel.
_REGULARISATION = 1e-12


def accelerated(
    update: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, float]],
    values: np.ndarray,
    bounds: tuple[float, float],
    tolerance: float,
    iterations: int,
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
    moves, turns = np.empty((2, _MEMORY, values.size))
    while tolerance < change < np.inf and count < iterations:
        step = _MIXING * residual
        held = min(count - 1, _MEMORY)
        if held:
            weighted = turns[:held] * weight.ravel()
            normal = weighted @ weighted.T
            normal[np.diag_indices(held)] += _REGULARISATION * np.trace(normal)
            shares = np.linalg.solve(normal, weighted @ (weight * residual).ravel())
            step = step - (shares @ moves[:held] + _MIXING * (shares @ turns[:held])).reshape(values.shape)
        before, moved = residual, np.clip(values + step, *bounds)
        residual, weight, change = update(moved)
        if not np.isfinite(change):  # what the caller keeps of the last update is to be numbers
            update(values)
            return values, np.inf, count + 2
        oldest = (count - 1) % _MEMORY
        moves[oldest], turns[oldest] = (moved - values).ravel(), (residual - before).ravel()
        values = moved
        count += 1
    return values, change, count
