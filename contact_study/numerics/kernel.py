"""Compiled loops over arrays: their decorator, and the sum of products of two fields."""

import numpy as np
from numba import njit

kernel = njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
"""Compile a function: IEEE division by zero, sums in any order, infinities and NaN kept."""


def inner_product(one: np.ndarray, other: np.ndarray) -> float:
    """Σ a b over all points of two real fields of one shape, to the same bits wherever they lie in memory.

    ``np.vdot`` waits for threads of the BLAS library, long where another case works on their core.
    """
    return float(_sum_of_products(one.ravel(), other.ravel()))


@kernel
def _sum_of_products(one, other):
    total = 0.0
    for i in range(one.size):
        total += np.float64(one[i]) * np.float64(other[i])
    return total
