"""The pressure on a hard wall at which its surfaces are where they are wanted."""

from collections.abc import Callable
from functools import cache

import numpy as np
from scipy.optimize import brentq

from bem_adhesion.solution import Solution

# In the logarithm of the pressure, until the root is between two.
_STRIDE = 2.0


def find_pressure(
    press: Callable[[np.ndarray, float], Solution],
    state: np.ndarray,
    excess: Callable[[Solution], float],
    tolerance: float,
    first: float,
    most: float,
) -> Solution:
    """The state at the pressure at which an excess distance, which falls with it, is none.

    Parameters
    ----------
    press : callable
        A state to start from and a mean pressure (Pa) -> the contact.
    state : numpy.ndarray
        To start from.
    excess : callable
        By how much a contact's surfaces are too far from one another (m).
    tolerance : float
        Excess that is none (m).
    first : float
        Pressure to begin with (Pa).
    most : float
        The largest that may be asked for (Pa); infinite without one.

    Returns
    -------
    Solution
        Where surfaces are too far even at the largest pressure, that state.
    """
    start = state
    latest: tuple[float, Solution] | None = None

    def at(log_pressure: float) -> Solution:
        nonlocal start, latest
        found = press(start, float(np.exp(log_pressure)))
        start, latest = found.state, (log_pressure, found)
        return found

    @cache
    def left(log_pressure: float) -> float:
        away = excess(at(log_pressure))
        return away if abs(away) > tolerance else 0.0

    top = float(np.log(most))
    low = high = min(float(np.log(first)), top)
    while left(low) < 0:
        low, high = low - _STRIDE, low
    while left(high) > 0 and high < top:
        low, high = high, min(high + _STRIDE, top)
    root = high if left(high) >= 0 else brentq(left, low, high, xtol=1e-15, rtol=1e-14)
    return latest[1] if latest and latest[0] == root else at(root)
