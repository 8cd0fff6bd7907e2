"""Compiled tridiagonal elimination from both ends, which do not wait for each other, inward to the rows around n/2."""

from numba import njit


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def factorise(lower, diagonal, upper, inverse, inward, outward):
    """Eliminate a matrix of n >= 2 rows; the first lower and the last upper element are not read.

    Filled are the inverse of the pivots, and the factors of elimination inward and of its way back.
    """
    n = inverse.size
    middle = n // 2
    low, high = 1.0 / diagonal[0], 1.0 / diagonal[n - 1]
    inverse[0], inverse[n - 1] = low, high
    for i in range(1, middle):
        above = n - 1 - i
        low = 1.0 / (diagonal[i] - lower[i] * upper[i - 1] * low)
        high = 1.0 / (diagonal[above] - upper[above] * lower[above + 1] * high)
        inverse[i], inverse[above] = low, high
    if n - middle > middle:
        inverse[middle] = 1.0 / (diagonal[middle] - upper[middle] * lower[middle + 1] * high)
    for i in range(middle):
        outward[i] = -upper[i] * inverse[i]
        inward[i] = -lower[i + 1] * inverse[i]
    for i in range(middle, n):
        outward[i] = -lower[i] * inverse[i]
        inward[i] = -upper[i - 1] * inverse[i]


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def solve(inverse, inward, outward, values):
    """Solve in place with the matrix of :func:`factorise`; with its transpose if inward and outward are exchanged."""
    n = inverse.size
    middle = n // 2
    low, high = values[0], values[n - 1]  # kept in registers, not reloaded
    for i in range(1, middle):
        above = n - 1 - i
        low = values[i] + inward[i - 1] * low
        high = values[above] + inward[above + 1] * high
        values[i], values[above] = low, high
    if n - middle > middle:
        high = values[middle] + inward[middle + 1] * high
    low, high = low * inverse[middle - 1], high * inverse[middle]
    share = 1.0 / (1.0 - outward[middle - 1] * outward[middle])
    low, high = (low + outward[middle - 1] * high) * share, (high + outward[middle] * low) * share
    values[middle - 1], values[middle] = low, high
    for i in range(1, middle):
        below, above = middle - 1 - i, middle + i
        low = values[below] * inverse[below] + outward[below] * low
        high = values[above] * inverse[above] + outward[above] * high
        values[below], values[above] = low, high
    if n - middle > middle:
        values[n - 1] = values[n - 1] * inverse[n - 1] + outward[n - 1] * high
