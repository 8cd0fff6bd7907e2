"""Symmetric 3×3 matrices, one an atom: eigenvalues by the trigonometric solution of the characteristic equation."""

import numpy as np
from numba import njit

_OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}


@njit(**_OPTIONS)
def deviator(xx, yy, zz, xy, xz, yz):
    """Mean m of the diagonal, size p and entries of the matrix (A − m)/p, and its angle; p is zero for A = m.

    The eigenvalues are m + 2p cos(angle + 2πk/3), the largest for k = 0, the lowest for k = 1.
    """
    mean = (xx + yy + zz) / 3.0
    spread = (xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2.0 * (xy * xy + xz * xz + yz * yz)
    if spread == 0.0:
        return mean, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    p = np.sqrt(spread / 6.0)
    a = (xx - mean) / p
    b = (yy - mean) / p
    c = (zz - mean) / p
    d = xy / p
    e = xz / p
    f = yz / p
    r = 0.5 * (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e))
    return mean, p, a, b, c, d, e, f, np.arccos(min(1.0, max(-1.0, r))) / 3.0


@njit(**_OPTIONS)
def lowest_eigenvalue(xx, yy, zz, xy, xz, yz):
    """The lowest eigenvalue."""
    mean, p, _, _, _, _, _, _, angle = deviator(xx, yy, zz, xy, xz, yz)
    return mean + 2.0 * p * np.cos(angle + 2.0 * np.pi / 3.0)


@njit(**_OPTIONS)
def stiffest(xx, yy, zz, xy, xz, yz):
    """The largest eigenvalue and its unit eigenvector; z where there is no one direction."""
    mean, p, a, b, c, d, e, f, angle = deviator(xx, yy, zz, xy, xz, yz)
    if not 6.0 * p * p > 1e-20 * mean * mean:
        return mean, 0.0, 0.0, 1.0
    top = 2.0 * np.cos(angle)
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
