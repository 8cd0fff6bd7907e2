"""The plane where a fine level of the explicit block hangs on the lowest plane of the next, twice as coarse one.

Arrays of nodes have shape (3, planes, ny + 2, nx + 2): a frame of ghosts holds the periodic images.
"""

import numpy as np
from numba import njit

_OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": {"contract", "nsz"}}


@njit(**_OPTIONS)
def prolong(coarse, fine, first, end):
    """Bilinear values of a slab's lowest plane, ghosts filled, on some rows of the highest plane of a finer one.

    Arrays of nodes have shape (3, planes, ny + 2, nx + 2); the rows, of the coarse plane without ghosts, are ``first``
    to before ``end``.
    """
    top = fine.shape[1] - 1
    one = np.uint64(1)
    for c in range(3):
        for j in range(first + 1, end + 1):
            here, next_one = coarse[c, 0, j], coarse[c, 0, j + 1]
            even, odd = fine[c, top, 2 * j - 1], fine[c, top, 2 * j]
            for i in range(one, np.uint64(here.size - 1)):
                e = i + one
                west, east = 2 * i - one, 2 * i
                even[west] = here[i]
                even[east] = 0.5 * (here[i] + here[e])
                odd[west] = 0.5 * (here[i] + next_one[i])
                odd[east] = 0.25 * ((here[i] + here[e]) + (next_one[i] + next_one[e]))


@njit(**_OPTIONS)
def restrict(fine, coarse, first, end):
    """Add the transpose of :func:`prolong` to some rows of the coarse plane."""
    top = fine.shape[1] - 1
    rows = fine.shape[2] - 2
    one = np.uint64(1)
    for c in range(3):
        for j in range(first + 1, end + 1):
            here = fine[c, top, 2 * j - 1]
            north = fine[c, top, 2 * j]
            south = fine[c, top, 2 * j - 2 if j > 1 else rows]
            to = coarse[c, 0, j]
            last = np.uint64(here.size - 2)
            to[1] += here[1] + 0.5 * ((here[last] + here[2]) + (north[1] + south[1]))
            to[1] += 0.25 * ((north[last] + north[2]) + (south[last] + south[2]))
            for i in range(np.uint64(2), np.uint64(to.size - 1)):
                m = 2 * i - one
                w = m - one
                e = m + one
                sides = (here[w] + here[e]) + (north[m] + south[m])
                corners = (north[w] + north[e]) + (south[w] + south[e])
                to[i] += here[m] + (0.5 * sides + 0.25 * corners)
