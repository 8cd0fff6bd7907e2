"""Curvature of the interface, one symmetric 3×3 matrix per atom: xx, yy, zz, xy, xz, yz.

Eigenvalues follow from the trigonometric solution of the characteristic equation.
"""

import numpy as np

from contact_study.numerics.kernel import kernel


@kernel
def deviator(xx, yy, zz, xy, xz, yz):
    """Return mean m of the diagonal, size p and entries of (A − m)/p, and its angle; p is zero for A = m.

    The eigenvalues are m + 2p cos(angle + 2πk/3), the largest for k = 0, the lowest for k = 1.
    """
    mean = (xx + yy + zz) / 3.0
    spread = (xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2.0 * (xy * xy + xz * xz + yz * yz)
    if spread == 0.0:
        return mean, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    p = np.sqrt(spread / 6.0)
    a, b, c = (xx - mean) / p, (yy - mean) / p, (zz - mean) / p
    d, e, f = xy / p, xz / p, yz / p
    r = 0.5 * (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e))
    return mean, p, a, b, c, d, e, f, np.arccos(min(1.0, max(-1.0, r))) / 3.0


@kernel
def lowest_eigenvalue(xx, yy, zz, xy, xz, yz):
    """Return the lowest eigenvalue."""
    mean, p, _, _, _, _, _, _, angle = deviator(xx, yy, zz, xy, xz, yz)
    return mean + 2.0 * p * np.cos(angle + 2.0 * np.pi / 3.0)


@kernel
def stiffest(xx, yy, zz, xy, xz, yz):
    """Return the largest eigenvalue and its unit eigenvector; z where no direction is unique."""
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


@kernel
def raise_curvature(hessian, gradient, gap, cosine, damping, length, smallest_distance, diagonal):
    """Write each atom's Hessian, raised by a multiple of 1 where the normal force softens.

    A raised atom has at least the curvature|g|/distance of a spring that ends at contact where the unbalanced force g
    pulls it toward contact, and at twice its gap where g pulls it away. The increase vanishes with g, which preserves
    Newton's convergence.

    ``gradient`` is the unbalanced force, negated (N), ``gap`` the height over the surface (m) and ``cosine`` that of
    the surface's tilt. ``damping`` is the share of the remaining negative curvature to remove. ``length`` is r0 (m),
    ``smallest_distance`` the least distance to contact (r0). ``diagonal`` is written (N/m).
    """
    for j in range(gap.shape[0]):
        for i in range(gap.shape[1]):
            xx, yy, zz = hessian[0, j, i], hessian[1, j, i], hessian[2, j, i]
            xy, xz, yz = hessian[3, j, i], hessian[4, j, i], hessian[5, j, i]
            lift = 0.0
            if zz < 0.0 or damping > 0.0:
                if zz < 0.0:
                    g = gradient[2, j, i]
                    height = gap[j, i]
                    above = max(height - length / cosine[j, i], smallest_distance * length)
                    lift = abs(g) / (above if g > 0.0 else height)
                if damping > 0.0:
                    lowest = lowest_eigenvalue(float(xx), float(yy), float(zz), float(xy), float(xz), float(yz))
                    lift -= damping * min(lowest + lift, 0.0)
            diagonal[0, j, i] = xx + lift
            diagonal[1, j, i] = yy + lift
            diagonal[2, j, i] = zz + lift
            diagonal[3, j, i] = xy
            diagonal[4, j, i] = xz
            diagonal[5, j, i] = yz


@kernel
def split(diagonal, shift, half_grid, negligible, known, normal, removed, core):
    """Write the stiffest direction of each atom and its core, see :mod:`md_reference.statics.linear`.

    D is ``diagonal``, c ``shift``, ½ S_max ``half_grid`` (N/m); below ``negligible`` an atom is all tail. Where D is
    the ``known`` one of the last call (NaN at first), results remain valid. Written are the unit eigenvector n of the
    largest eigenvalue k in ``normal``, 1 − β in ``removed`` and (1 − β²)/(k + ½ S_max) in ``core`` (m/N), with β² =
    c/(k + c); zero where k is negligible.
    """
    for j in range(removed.shape[0]):
        for i in range(removed.shape[1]):
            same = True
            for n in range(6):
                same &= diagonal[n, j, i] == known[n, j, i]
            if same:
                continue
            for n in range(6):
                known[n, j, i] = diagonal[n, j, i]
            xx, yy, zz = float(diagonal[0, j, i]), float(diagonal[1, j, i]), float(diagonal[2, j, i])
            xy, xz, yz = float(diagonal[3, j, i]), float(diagonal[4, j, i]), float(diagonal[5, j, i])
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
