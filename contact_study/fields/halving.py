"""Between a periodic grid and one of half its resolution: bilinear interpolation P and the mean Pᵀ/4."""

import numpy as np
from numba import njit


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def restrict(fine, coarse):
    """Write Pᵀ fine / 4: at every second point the mean of its neighbourhood with weights 1, ½ and ¼.

    Parameters
    ----------
    fine : numpy.ndarray, shape (2·rows, 2·columns)
    coarse : numpy.ndarray, shape (rows, columns)
    """
    rows, columns = coarse.shape
    quarter, half = fine.dtype.type(0.25), fine.dtype.type(0.5)
    line = np.empty(2 * columns, fine.dtype)
    for i in range(rows):
        above, here, below = fine[2 * i - 1], fine[2 * i], fine[2 * i + 1]
        for j in range(2 * columns):
            line[j] = half * here[j] + quarter * (above[j] + below[j])
        coarse[i, 0] = half * line[0] + quarter * (line[2 * columns - 1] + line[1])
        for j in range(1, columns):
            coarse[i, j] = half * line[2 * j] + quarter * (line[2 * j - 1] + line[2 * j + 1])


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def prolong(coarse, weight, fine):
    """Write weight·fine + P coarse; returns weight·Σ fine² of what was there.

    Parameters
    ----------
    coarse : numpy.ndarray, shape (rows, columns)
    weight : float
        Of the precision of the fields.
    fine : numpy.ndarray, shape (2·rows, 2·columns)
    """
    rows, columns = coarse.shape
    half = fine.dtype.type(0.5)
    line = np.empty(columns + 1, fine.dtype)
    total = 0.0
    for i in range(2 * rows):
        here, below = coarse[i // 2], coarse[(i // 2 + i % 2) % rows]
        for j in range(columns):
            line[j] = half * (here[j] + below[j])
        line[columns] = line[0]
        row = fine.dtype.type(0)
        for j in range(columns):
            left, right = fine[i, 2 * j], fine[i, 2 * j + 1]
            row += left * left + right * right
            fine[i, 2 * j] = weight * left + line[j]
            fine[i, 2 * j + 1] = weight * right + half * (line[j] + line[j + 1])
        total += row
    return weight * total
