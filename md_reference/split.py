"""Core and tail of the interface's curvature: what the preconditioner of the linear solver inverts atom by atom."""

import numpy as np
from numba import njit

from md_reference.symmetric import stiffest


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def split(diagonal, shift, half_grid, normal, removed, core):
    """Stiffest direction of each atom and how much of it is core, see :mod:`md_reference.newton_step`.

    Parameters
    ----------
    diagonal : numpy.ndarray, shape (6, ny, nx)
        D: xx, yy, zz, xy, xz, yz (N/m).
    shift, half_grid : float
        c and ½ S_max (N/m).
    normal : numpy.ndarray, shape (3, ny, nx)
        Written: unit eigenvector n of the largest eigenvalue k.
    removed, core : numpy.ndarray, shape (ny, nx)
        Written: 1 − β, and (1 − β²)/(k + ½ S_max) (m/N), with β² = c/(k + c); zero where k is not positive.
    """
    for j in range(removed.shape[0]):
        for i in range(removed.shape[1]):
            xx = float(diagonal[0, j, i])
            yy = float(diagonal[1, j, i])
            zz = float(diagonal[2, j, i])
            xy = float(diagonal[3, j, i])
            xz = float(diagonal[4, j, i])
            yz = float(diagonal[5, j, i])
            stiffness, x, y, z = stiffest(xx, yy, zz, xy, xz, yz)
            normal[0, j, i] = x
            normal[1, j, i] = y
            normal[2, j, i] = z
            stiffness = max(stiffness, 0.0)
            squared = shift / (stiffness + shift)
            removed[j, i] = 1.0 - np.sqrt(squared)
            core[j, i] = (1.0 - squared) / (stiffness + half_grid)
