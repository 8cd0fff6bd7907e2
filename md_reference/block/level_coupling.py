"""Coupling of a fine level of the explicit block to the lowest plane of the next, twice as coarse one.

Arrays of nodes have shape (3, planes, ny + 2, nx + 2): a frame of ghosts contains the periodic images. The kernels
treat the rows ``first`` to before ``end`` of the coarse plane, ghosts not counted.
"""

import numpy as np

from md_reference.parallel_rows import row_kernel


@row_kernel
def prolong(coarse, fine, first, end):
    """Write the coarse level's lowest plane, bilinearly interpolated, on the fine level's highest plane."""
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


@row_kernel
def restrict(fine, coarse, first, end):
    """Add the transpose of :func:`prolong` to the coarse plane."""
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
