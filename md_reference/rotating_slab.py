"""Forces and energy of a slab of cells whose springs turn with their atoms, both faces free, periodic along x and y.

The cell of :func:`md_reference.block.isotropic_element` at any displacement: springs along edges and face diagonals
pull along the line between their atoms, ½k(|r| − r₀)², and the volume costs ½(λ − μ)a³(det F − 1)², F the mean of the
deformation gradient over the cell's corners. A turn of the whole costs nothing; to first order both are the linear
cell. Arrays of nodes have shape (3, planes, ny + 2, nx + 2): a frame of ghosts holds the periodic images.
"""

import numpy as np
from numba import njit

_OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}

# Steps along z, y, x to the neighbours that an atom has springs to.
_NEIGHBOURS = np.array(
    [(z, y, x) for z in (-1, 0, 1) for y in (-1, 0, 1) for x in (-1, 0, 1) if 1 <= abs(z) + abs(y) + abs(x) <= 2]
)


def rotating_slab_force(u: np.ndarray, force: np.ndarray, edge: float, shear_modulus: float, bulk: float) -> float:
    """Write the forces on all nodes of a slab whose ghosts are filled; returns the elastic energy (J).

    Parameters
    ----------
    u, force : numpy.ndarray, shape (3, planes, ny + 2, nx + 2)
        Displacements (m) and forces (N); the ghosts of ``force`` are left alone.
    edge : float
        Of a cell (m).
    shear_modulus, bulk : float
        μ and λ − μ (Pa).
    """
    force[:, :, 1:-1, 1:-1] = 0.0
    energy = _springs(u, force, _NEIGHBOURS, edge, shear_modulus * edge)
    # The volume is a product of differences over 4a.
    return energy + _volumes(u, force, 1 / (4 * edge), bulk * edge**3) if bulk else energy


@njit(**_OPTIONS)
def _springs(u, force, neighbours, edge, stiffness):
    """Add the forces of all springs, each met from both of its ends."""
    planes, rows, columns = u.shape[1:]
    inside = np.uint64(columns - 2)
    energy = 0.0
    for k in range(planes):
        in_face = 0.5 if k == 0 or k == planes - 1 else 1.0
        for n in range(neighbours.shape[0]):
            dk, dj, di = neighbours[n]
            if not 0 <= k + dk < planes:
                continue
            # Springs within a face of the slab belong to one cell instead of two.
            strength = stiffness * (in_face if dk == 0 else 1.0)
            r_x, r_y, r_z = edge * di, edge * dj, edge * dk
            length2 = r_x * r_x + r_y * r_y + r_z * r_z
            length = np.sqrt(length2)
            for j in range(1, rows - 1):
                # Each a slice of its own along the last axis: of several at once the compiler knows no stride.
                x = u[0, k, j, 1 : columns - 1]
                y = u[1, k, j, 1 : columns - 1]
                z = u[2, k, j, 1 : columns - 1]
                to_x = u[0, k + dk, j + dj, 1 + di : columns - 1 + di]
                to_y = u[1, k + dk, j + dj, 1 + di : columns - 1 + di]
                to_z = u[2, k + dk, j + dj, 1 + di : columns - 1 + di]
                f_x = force[0, k, j, 1 : columns - 1]
                f_y = force[1, k, j, 1 : columns - 1]
                f_z = force[2, k, j, 1 : columns - 1]
                row = 0.0
                for i in range(inside):
                    d_x = to_x[i] - x[i]
                    d_y = to_y[i] - y[i]
                    d_z = to_z[i] - z[i]
                    # |r + d|² − |r|², without the cancellation of the two
                    grown = 2.0 * (r_x * d_x + r_y * d_y + r_z * d_z) + (d_x * d_x + d_y * d_y + d_z * d_z)
                    now = np.sqrt(length2 + grown)
                    longer = grown / (now + length)
                    pull = strength * longer / now
                    f_x[i] += pull * (r_x + d_x)
                    f_y[i] += pull * (r_y + d_y)
                    f_z[i] += pull * (r_z + d_z)
                    row += longer * longer
                energy += 0.25 * strength * row
    return energy


@njit(**_OPTIONS)
def _volumes(u, force, scale, stiffness):
    """Add the forces of the cells' volumes, a row of cells at a time."""
    planes, rows, columns = u.shape[1:]
    cells, one = np.uint64(columns - 1), np.uint64(1)
    stress = np.empty((9, columns - 1))
    energy = 0.0
    for k in range(planes - 1):
        for j in range(rows - 1):
            for c in range(3):
                near, far = u[c, k, j], u[c, k, j + 1]
                near_up, far_up = u[c, k + 1, j], u[c, k + 1, j + 1]
                along_x, along_y, along_z = stress[3 * c], stress[3 * c + 1], stress[3 * c + 2]
                for i in range(cells):
                    e = i + one
                    west, east = near[i] + near_up[i], near[e] + near_up[e]
                    west_far, east_far = far[i] + far_up[i], far[e] + far_up[e]
                    along_x[i] = scale * (east + east_far - west - west_far)
                    along_y[i] = scale * (west_far + east_far - west - east)
                    along_z[i] = scale * (
                        (near_up[i] - near[i]) + (near_up[e] - near[e]) + (far_up[i] - far[i]) + (far_up[e] - far[e])
                    )
            row = _stresses(stress, stiffness * scale)
            if j > 0:  # the first row is the image of the last
                energy += 0.5 * stiffness * row
            for up in range(2):
                for over in range(2):
                    if not 0 < j + over < rows - 1:
                        continue
                    sign_y, sign_z = 2.0 * over - 1.0, 2.0 * up - 1.0
                    for c in range(3):
                        to = force[c, k + up, j + over]
                        of_x, of_y, of_z = stress[3 * c], stress[3 * c + 1], stress[3 * c + 2]
                        for i in range(one, cells):
                            w = i - one
                            to[i] -= (of_x[w] - of_x[i]) + sign_y * (of_y[w] + of_y[i]) + sign_z * (of_z[w] + of_z[i])
    return energy


@njit(**_OPTIONS)
def _stresses(gradient, strength):
    """Turn displacement gradients G into strength (det F − 1) ∂det F/∂F, F = 1 + G, in place.

    Returns the sum of (det F − 1)² over all cells but the first, which is the image of the last.
    """
    xx, xy, xz, yx, yy, yz, zx, zy, zz = gradient
    total = 0.0
    for i in range(np.uint64(xx.size)):
        f_xx = 1.0 + xx[i]
        f_yy = 1.0 + yy[i]
        f_zz = 1.0 + zz[i]
        c_xx = f_yy * f_zz - yz[i] * zy[i]
        c_xy = yz[i] * zx[i] - yx[i] * f_zz
        c_xz = yx[i] * zy[i] - f_yy * zx[i]
        c_yx = xz[i] * zy[i] - xy[i] * f_zz
        c_yy = f_xx * f_zz - xz[i] * zx[i]
        c_yz = xy[i] * zx[i] - f_xx * zy[i]
        c_zx = xy[i] * yz[i] - xz[i] * f_yy
        c_zy = xz[i] * yx[i] - f_xx * yz[i]
        c_zz = f_xx * f_yy - xy[i] * yx[i]
        # det F − 1 from the gradient itself: a small one is not lost beside the one.
        grown = xx[i] * c_xx + (yy[i] * f_zz + zz[i] - yz[i] * zy[i]) + xy[i] * c_xy + xz[i] * c_xz
        if i > 0:
            total += grown * grown
        g = strength * grown
        xx[i] = g * c_xx
        xy[i] = g * c_xy
        xz[i] = g * c_xz
        yx[i] = g * c_yx
        yy[i] = g * c_yy
        yz[i] = g * c_yz
        zx[i] = g * c_zx
        zy[i] = g * c_zy
        zz[i] = g * c_zz
    return total
