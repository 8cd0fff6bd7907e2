"""Forces of a slab of isotropic cells with explicit nodes, both faces free, periodic along x and y.

The springs and the dilatation energy of :func:`md_reference.block.isotropic_element`, gathered node by node: springs
along edges, springs along face diagonals, and the dilatation of every cell, of which two planes at a time are kept.
Arrays of nodes have shape (3, planes, ny + 2, nx + 2): a frame of ghosts holds the periodic images.
"""

import numpy as np
from numba import njit

_OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}


def slab_constants(lattice_constant: float, first_lame: float, shear_modulus: float) -> tuple[float, float, float]:
    """Stiffnesses of edge springs, of diagonal springs along an axis, and of the dilatation (N/m).

    Parameters
    ----------
    lattice_constant : float
        Edge of the cell (m).
    first_lame, shear_modulus : float
        λ and μ (Pa).
    """
    edge = shear_modulus * lattice_constant
    # A diagonal spring acts along (1, 1)/√2; a cell's dilatation is a sum of differences over 4a, in force and energy.
    return edge, edge / 2, (first_lame - shear_modulus) * lattice_constant / 16


@njit(**_OPTIONS)
def fill_ghosts(u):
    """Copy the periodic images of the nodes into the frame."""
    for c in range(u.shape[0]):
        for k in range(u.shape[1]):
            rows, columns = u.shape[2:]
            for j in range(rows):
                u[c, k, j, 0] = u[c, k, j, columns - 2]
                u[c, k, j, columns - 1] = u[c, k, j, 1]
            for i in range(columns):
                u[c, k, 0, i] = u[c, k, rows - 2, i]
                u[c, k, rows - 1, i] = u[c, k, 1, i]


@njit(**_OPTIONS)
def _dilatation(u, k, out):
    """Sum of corner differences, 4a times the dilatation, of the cells between planes k and k + 1."""
    for j in range(u.shape[2] - 1):
        x_00 = u[0, k, j]
        x_01 = u[0, k, j + 1]
        x_10 = u[0, k + 1, j]
        x_11 = u[0, k + 1, j + 1]
        y_00 = u[1, k, j]
        y_01 = u[1, k, j + 1]
        y_10 = u[1, k + 1, j]
        y_11 = u[1, k + 1, j + 1]
        z_00 = u[2, k, j]
        z_01 = u[2, k, j + 1]
        z_10 = u[2, k + 1, j]
        z_11 = u[2, k + 1, j + 1]
        row = out[j]
        for i in range(np.uint64(u.shape[3] - 1)):
            e = i + np.uint64(1)
            row[i] = (
                (x_00[e] + x_01[e] + x_10[e] + x_11[e] - x_00[i] - x_01[i] - x_10[i] - x_11[i])
                + (y_01[i] + y_11[i] + y_01[e] + y_11[e] - y_00[i] - y_10[i] - y_00[e] - y_10[e])
                + (z_10[i] + z_11[i] + z_10[e] + z_11[e] - z_00[i] - z_01[i] - z_00[e] - z_01[e])
            )


@njit(**_OPTIONS)
def slab_force(u, force, dilatation, edge, diagonal, volume):
    """Write the forces on all nodes of a slab whose ghosts are filled.

    Parameters
    ----------
    u, force : numpy.ndarray, shape (3, planes, ny + 2, nx + 2)
        Displacements (m) and forces (N); the ghosts of ``force`` are left alone.
    dilatation : numpy.ndarray, shape (2, ny + 2, nx + 2)
        Work array.
    edge, diagonal, volume : float
        As :func:`slab_constants`.
    """
    planes, rows, columns = u.shape[1:]
    one = np.uint64(1)
    for k in range(planes):
        under = dilatation[(k + 1) & 1]
        over = dilatation[k & 1]
        if k < planes - 1:
            _dilatation(u, k, over)
        else:
            over[:] = 0.0
        if k == 0:
            under[:] = 0.0
        # Springs within a face of the slab belong to one cell instead of two.
        share = 1.0 if 0 < k < planes - 1 else 0.5
        has_over = 1.0 if k < planes - 1 else 0.0
        has_under = 1.0 if k > 0 else 0.0
        k_o = k + 1 if k < planes - 1 else k
        k_u = k - 1 if k > 0 else k
        edge_in = share * edge
        diagonal_in = share * diagonal
        diagonal_o = has_over * diagonal
        diagonal_u = has_under * diagonal
        edge_o = has_over * edge
        edge_u = has_under * edge
        for j in range(1, rows - 1):
            x_c = u[0, k, j]
            x_n = u[0, k, j + 1]
            x_s = u[0, k, j - 1]
            x_o = u[0, k_o, j]
            x_u = u[0, k_u, j]
            y_c = u[1, k, j]
            y_n = u[1, k, j + 1]
            y_s = u[1, k, j - 1]
            y_on = u[1, k_o, j + 1]
            y_os = u[1, k_o, j - 1]
            y_un = u[1, k_u, j + 1]
            y_us = u[1, k_u, j - 1]
            z_c = u[2, k, j]
            z_o = u[2, k_o, j]
            z_u = u[2, k_u, j]
            z_on = u[2, k_o, j + 1]
            z_os = u[2, k_o, j - 1]
            z_un = u[2, k_u, j + 1]
            z_us = u[2, k_u, j - 1]
            a_s = under[j - 1]
            a_n = under[j]
            b_s = over[j - 1]
            b_n = over[j]
            f_x = force[0, k, j]
            f_y = force[1, k, j]
            f_z = force[2, k, j]
            for i in range(one, np.uint64(columns - 1)):
                e = i + one
                w = i - one
                x = x_c[i]
                y = y_c[i]
                z = z_c[i]
                ne = (x_n[e] - x) + (y_n[e] - y)
                sw = (x_s[w] - x) + (y_s[w] - y)
                nw = (x_n[w] - x) - (y_n[w] - y)
                se = (x_s[e] - x) - (y_s[e] - y)
                g_x = edge_in * (x_c[e] + x_c[w] - 2.0 * x) + diagonal_in * (ne + sw + nw + se)
                g_y = edge_in * (y_n[i] + y_s[i] - 2.0 * y) + diagonal_in * (ne + sw - nw - se)
                oe = diagonal_o * ((x_o[e] - x) + (z_o[e] - z))
                uw = diagonal_u * ((x_u[w] - x) + (z_u[w] - z))
                ow = diagonal_o * ((x_o[w] - x) - (z_o[w] - z))
                ue = diagonal_u * ((x_u[e] - x) - (z_u[e] - z))
                g_x += oe + uw + ow + ue
                g_z = oe + uw - ow - ue + edge_o * (z_o[i] - z) + edge_u * (z_u[i] - z)
                on = diagonal_o * ((y_on[i] - y) + (z_on[i] - z))
                us = diagonal_u * ((y_us[i] - y) + (z_us[i] - z))
                os = diagonal_o * ((y_os[i] - y) - (z_os[i] - z))
                un = diagonal_u * ((y_un[i] - y) - (z_un[i] - z))
                g_y += on + us + os + un
                g_z += on + us - os - un
                asw = a_s[w]
                ase = a_s[i]
                anw = a_n[w]
                ane = a_n[i]
                bsw = b_s[w]
                bse = b_s[i]
                bnw = b_n[w]
                bne = b_n[i]
                f_x[i] = g_x - volume * (asw - ase + anw - ane + bsw - bse + bnw - bne)
                f_y[i] = g_y - volume * (asw + ase - anw - ane + bsw + bse - bnw - bne)
                f_z[i] = g_z - volume * (asw + ase + anw + ane - bsw - bse - bnw - bne)
