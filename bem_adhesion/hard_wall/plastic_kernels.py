"""Passes over the points of a surface whose pressure lies between zero and a bound; flat arrays of one size.

A point at zero may have a gap, a point at the bound may be indented, and between the bounds surfaces touch.
"""

import numpy as np
from numba import njit

_FAST = {"contract", "reassoc", "arcp", "nsz"}
_MOST_SHIFTS = 100


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def descended(displacement, heights, pressure, stiffness, result):
    """Pressure less a stiffness times displacement − heights, zero without a surface; returns where there is one."""
    present = np.empty(pressure.size, np.bool_)
    for i in range(pressure.size):
        present[i] = heights[i] > -np.inf
        result[i] = pressure[i] - stiffness * (displacement[i] - heights[i]) if present[i] else 0.0
    return present


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def judge(displacement, heights, offset, pressure, bound, free):
    """Note which points are to move; returns the largest violation.

    They are those between the bounds, those at zero that penetrate, and those at the bound with a gap.
    """
    worst = 0.0
    for i in range(pressure.size):
        clearance = displacement[i] - heights[i] - offset
        if pressure[i] <= 0:
            violation = -clearance
            free[i] = violation > 0
        elif pressure[i] >= bound:
            violation = clearance
            free[i] = violation > 0
        else:
            violation = abs(clearance)
            free[i] = True
        worst = max(worst, violation)
    # max() passes over what is not a number; the offset, a sum, does not.
    return worst + 0.0 * offset


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def balancing_shift(pressure, free, bound, total):
    """By how much to shift the free points so that, cut off at the bounds, all points carry ``total``.

    Also returned is what is missing then by rounding, and how many points are between the bounds. Points that are not
    free are at a bound. The shift is a zero of a piecewise linear, increasing function: Newton's method, or half of a
    bracket where that gains less.
    """
    smallest, largest = np.inf, -np.inf
    saturated = 0
    for i in range(pressure.size):
        if free[i]:
            smallest = min(smallest, pressure[i])
            largest = max(largest, pressure[i])
        elif pressure[i] >= bound:
            saturated += 1
    low, high = -largest, bound - smallest
    shift, previous = 0.0, np.inf
    for _ in range(_MOST_SHIFTS):
        carried, inside, full = _carried(pressure, free, bound, shift)
        # Counted, not summed: near saturation little is left, and a sum would have lost it.
        missing = total - (saturated + full) * bound - carried
        if abs(missing) <= 1e-15 * total:
            break
        if missing > 0:
            low = shift
        else:
            high = shift
        newton = shift + missing / max(inside, 1)
        if inside == 0 or abs(missing) > 0.5 * previous or not low < newton < high:
            newton = 0.5 * (low + high)
        if newton == shift:
            break
        shift, previous = newton, abs(missing)
    return shift, missing, inside


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def carry(pressure, free, bound, total):
    """Bring the free points within the bounds, shifted alike before that so that all points carry ``total``."""
    shift, missing, inside = balancing_shift(pressure, free, bound, total)
    # The shift is as exact as the largest number that it is added to; the rest is for the points between the bounds.
    rest = missing / max(inside, 1)
    for i in range(pressure.size):
        if free[i]:
            p = pressure[i] + shift
            if 0 < p < bound:
                p += rest
            pressure[i] = min(max(p, 0.0), bound)


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _carried(pressure, free, bound, shift):
    """What the free points between the bounds carry once they are shifted, their number, and that of those above."""
    total, inside, full = 0.0, 0, 0
    for i in range(pressure.size):
        if free[i]:
            p = pressure[i] + shift
            if p >= bound:
                full += 1
            elif p > 0:
                total += p
                inside += 1
    return total, inside, full


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def energy(displacement, heights, pressure):
    """Sum of p (½ displacement − height), what the pressure minimises."""
    total = 0.0
    for i in range(pressure.size):
        if pressure[i] > 0:
            total += pressure[i] * (0.5 * displacement[i] - heights[i])
    return total
