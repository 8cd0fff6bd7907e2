"""Core and tail of the interface's curvature: what the preconditioner of the linear solver inverts atom by atom."""

import numpy as np
from numba import njit

from md_reference.statics.symmetric import stiffest

# Curvature below this share of c leaves the preconditioner as good as it is.
_NEGLIGIBLE = 0.1


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def split(diagonal, shift, half_grid, known, normal, removed, core):
    """Stiffest direction of each atom and how much of it is core, see :mod:`md_reference.statics.linear`.

    Parameters
    ----------
    diagonal : numpy.ndarray, shape (6, ny, nx)
        D: xx, yy, zz, xy, xz, yz (N/m).
    shift, half_grid : float
        c and ½ S_max (N/m).
    known : numpy.ndarray, shape (6, ny, nx)
        D of the last call, whose results stand where it is the same; NaN at first.
    normal : numpy.ndarray, shape (3, ny, nx)
        Written: unit eigenvector n of the largest eigenvalue k.
    removed, core : numpy.ndarray, shape (ny, nx)
        Written: 1 − β, and (1 − β²)/(k + ½ S_max) (m/N), with β² = c/(k + c); zero where k is next to nothing.
    """
    negligible = _NEGLIGIBLE * shift
    for j in range(removed.shape[0]):
        for i in range(removed.shape[1]):
            same = True
            for n in range(6):
                same &= diagonal[n, j, i] == known[n, j, i]
            if same:
                continue
            for n in range(6):
                known[n, j, i] = diagonal[n, j, i]
            xx = float(diagonal[0, j, i])
            yy = float(diagonal[1, j, i])
            zz = float(diagonal[2, j, i])
            xy = float(diagonal[3, j, i])
            xz = float(diagonal[4, j, i])
            yz = float(diagonal[5, j, i])
            # Largest sums of rows, the eigenvalues' bound.
            bound = max(xx + abs(xy) + abs(xz), yy + abs(xy) + abs(yz), zz + abs(xz) + abs(yz))
            if bound <= negligible:
                removed[j, i] = 0.0
                core[j, i] = 0.0
                continue
            stiffness, x, y, z = stiffest(xx, yy, zz, xy, xz, yz)
            normal[0, j, i] = x
            normal[1, j, i] = y
            normal[2, j, i] = z
            stiffness = max(stiffness, 0.0)
            squared = shift / (stiffness + shift)
            removed[j, i] = 1.0 - np.sqrt(squared)
            core[j, i] = (1.0 - squared) / (stiffness + half_grid)
