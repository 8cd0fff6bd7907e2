"""Core and tail of the interface's curvature: what the preconditioner of the linear solver inverts atom by atom."""

import numpy as np
from numba import njit


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
            stiffness, x, y, z = _stiffest(xx, yy, zz, xy, xz, yz)
            normal[0, j, i] = x
            normal[1, j, i] = y
            normal[2, j, i] = z
            stiffness = max(stiffness, 0.0)
            squared = shift / (stiffness + shift)
            removed[j, i] = 1.0 - np.sqrt(squared)
            core[j, i] = (1.0 - squared) / (stiffness + half_grid)


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _stiffest(xx, yy, zz, xy, xz, yz):
    """Largest eigenvalue of a symmetric 3×3 matrix and its unit eigenvector; z where there is no one direction."""
    mean = (xx + yy + zz) / 3.0
    spread = (xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2.0 * (xy * xy + xz * xz + yz * yz)
    if not spread > 1e-20 * mean * mean:
        return mean, 0.0, 0.0, 1.0
    p = np.sqrt(spread / 6.0)
    a = (xx - mean) / p
    b = (yy - mean) / p
    c = (zz - mean) / p
    d = xy / p
    e = xz / p
    f = yz / p
    r = 0.5 * (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e))
    top = 2.0 * np.cos(np.arccos(min(1.0, max(-1.0, r))) / 3.0)
    # Rows of the shifted matrix are normal to the eigenvector: the largest of their products points along it.
    a -= top
    b -= top
    c -= top
    x1, y1, z1 = d * f - e * b, e * d - a * f, a * b - d * d
    x2, y2, z2 = d * c - e * f, e * e - a * c, a * f - d * e
    x3, y3, z3 = b * c - f * f, f * e - d * c, d * f - b * e
    n1 = x1 * x1 + y1 * y1 + z1 * z1
    n2 = x2 * x2 + y2 * y2 + z2 * z2
    n3 = x3 * x3 + y3 * y3 + z3 * z3
    if n2 > n1 and n2 >= n3:
        x1, y1, z1, n1 = x2, y2, z2, n2
    elif n3 > n1:
        x1, y1, z1, n1 = x3, y3, z3, n3
    if not n1 > 1e-24:
        return mean + p * top, 0.0, 0.0, 1.0
    size = np.sqrt(n1)
    return mean + p * top, x1 / size, y1 / size, z1 / size
