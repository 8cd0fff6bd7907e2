"""Curvature of the interface for a Newton step while atoms snap in: one 3×3 matrix an atom, raised where attracted."""

import numpy as np
from numba import njit


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def raised_curvature(hessian, force, gap, factor, length, smallest_gap, diagonal):
    """Hessian of each atom, raised by a multiple of 1 so that its lowest eigenvalue reaches the snap-in spring.

    With ``factor`` zero the Hessian is copied. Returns the sum over atoms of the positive part of the zz component.
    """
    stiff = 0.0
    for j in range(gap.shape[0]):
        for i in range(gap.shape[1]):
            xx = hessian[0, j, i]
            yy = hessian[1, j, i]
            zz = hessian[2, j, i]
            xy = hessian[3, j, i]
            xz = hessian[4, j, i]
            yz = hessian[5, j, i]
            lift = 0.0
            if factor > 0.0:
                wanted = 0.0
                if force[2, j, i] < 0.0:
                    wanted = factor * -force[2, j, i] / max(gap[j, i] - length, smallest_gap)
                lift = max(0.0, wanted - _lowest_eigenvalue(xx, yy, zz, xy, xz, yz))
            diagonal[0, j, i] = xx + lift
            diagonal[1, j, i] = yy + lift
            diagonal[2, j, i] = zz + lift
            diagonal[3, j, i] = xy
            diagonal[4, j, i] = xz
            diagonal[5, j, i] = yz
            stiff += max(zz + lift, 0.0)
    return stiff


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _lowest_eigenvalue(xx, yy, zz, xy, xz, yz):
    """Of a symmetric 3×3 matrix, by the trigonometric solution of its characteristic equation."""
    mean = (xx + yy + zz) / 3.0
    off = xy * xy + xz * xz + yz * yz
    spread = (xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2.0 * off
    if spread == 0.0:
        return mean
    p = np.sqrt(spread / 6.0)
    a = (xx - mean) / p
    b = (yy - mean) / p
    c = (zz - mean) / p
    d = xy / p
    e = xz / p
    f = yz / p
    r = 0.5 * (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e))
    return mean + 2.0 * p * np.cos(np.arccos(min(1.0, max(-1.0, r))) / 3.0 + 2.0 * np.pi / 3.0)
