"""Slabs of isotropic cells with explicit nodes, both faces free, periodic along x and y, and their coupling.

The springs and the dilatation energy of :func:`md_reference.block.condensed.isotropic_element`, gathered node by node.
Arrays of nodes have shape (3, planes, ny + 2, nx + 2): a frame of ghosts contains the periodic images. The kernels
treat the rows ``first`` to before ``end`` of ny; values that they write at ghosts are meaningless.
"""

import numpy as np

from md_reference.block.verlet import move_plane
from md_reference.parallel_rows import row_kernel


def fill_ghosts(u: np.ndarray) -> None:
    """Copy the periodic images of the nodes into the frame."""
    u[..., 0], u[..., -1] = u[..., -2], u[..., 1]
    u[..., 0, :], u[..., -1, :] = u[..., -2, :], u[..., 1, :]


@row_kernel
def _add_plane(u, k, width, start, below, dilatation):
    """Sum the corner differences, 4a times the dilatation, of the cells under plane k, from node ``start`` on.

    ``below`` holds what the plane under it adds, and is overwritten with what plane k adds to the cells over it.
    """
    x, y, z = u[0, k], u[1, k], u[2, k]
    for q in range(np.uint64(dilatation.size)):
        i = start + q
        e, n = i + np.uint64(1), i + width
        ne = n + np.uint64(1)
        within = ((x[e] - x[i]) + (x[ne] - x[n])) + ((y[n] - y[i]) + (y[ne] - y[e]))
        height = (z[i] + z[e]) + (z[n] + z[ne])
        dilatation[q] = below[q] + (within + height)
        below[q] = within - height


@row_kernel
def _start(nodes, first, end):
    """Return the dilatation of the cells about the lowest plane, and what that plane adds to the cells above it."""
    dilatation = np.zeros((2, (end - first + 1) * nodes.shape[3] - 1))
    below = np.zeros(dilatation.shape[1])
    width = np.uint64(nodes.shape[3])
    _add_plane(nodes.reshape(3, nodes.shape[1], -1), 0, width, np.uint64(first) * width, below, dilatation[1])
    return dilatation, below


@row_kernel
def _plane_force(nodes, k, dilatation, below, edge, diagonal, volume, first, force, plane, low, high):
    """Write the forces on rows of plane k, from row ``first`` on, after those of the plane below, in rows of a plane.

    The rows form one line: the ghosts between them cost less than to begin a loop again.
    """
    f_x, f_y = force[0, plane, low:high].reshape(-1), force[1, plane, low:high].reshape(-1)
    f_z = force[2, plane, low:high].reshape(-1)
    planes, width, one = nodes.shape[1], np.uint64(nodes.shape[3]), np.uint64(1)
    begin = np.uint64(first) * width
    u = nodes.reshape(3, planes, -1)
    under, over = dilatation[(k + 1) & 1], dilatation[k & 1]
    if k < planes - 1:
        _add_plane(u, k + 1, width, begin, below, over)
    else:
        over[:] = 0.0
    if k == 0:
        under[:] = 0.0
    # Springs within a face of the slab belong to one cell instead of two.
    share = 1.0 if 0 < k < planes - 1 else 0.5
    has_over, has_under = np.float64(k < planes - 1), np.float64(k > 0)
    edge_in, edge_o, edge_u = share * edge, has_over * edge, has_under * edge
    diagonal_in, diagonal_o, diagonal_u = share * diagonal, has_over * diagonal, has_under * diagonal
    own_x = 2.0 * edge_in + 4.0 * diagonal_in + 2.0 * (diagonal_o + diagonal_u)
    own_z = edge_o + edge_u + 4.0 * (diagonal_o + diagonal_u)
    k_o, k_u = min(k + 1, planes - 1), max(k - 1, 0)
    x_c, x_o, x_u = u[0, k], u[0, k_o], u[0, k_u]
    y_c, y_o, y_u = u[1, k], u[1, k_o], u[1, k_u]
    z_c, z_o, z_u = u[2, k], u[2, k_o], u[2, k_u]
    for q in range(np.uint64(f_x.size - 2)):
        sw, se, nw = q, q + one, q + width
        ne = nw + one
        i = begin + ne
        e, w, n, s = i + one, i - one, i + width, i - width
        # Diagonals within the plane; those of x with y change sides for the other.
        rising = (x_c[n + one] + x_c[s - one]) + (y_c[n + one] + y_c[s - one])
        falling = (x_c[n - one] + x_c[s + one]) - (y_c[n - one] + y_c[s + one])
        g_x = edge_in * (x_c[e] + x_c[w]) + diagonal_in * (rising + falling)
        g_y = edge_in * (y_c[n] + y_c[s]) + diagonal_in * (rising - falling)
        g_x += diagonal_o * ((x_o[e] + x_o[w]) + (z_o[e] - z_o[w]))
        g_x += diagonal_u * ((x_u[e] + x_u[w]) - (z_u[e] - z_u[w]))
        g_y += diagonal_o * ((y_o[n] + y_o[s]) + (z_o[n] - z_o[s]))
        g_y += diagonal_u * ((y_u[n] + y_u[s]) - (z_u[n] - z_u[s]))
        g_z = diagonal_o * (((x_o[e] - x_o[w]) + (y_o[n] - y_o[s])) + ((z_o[e] + z_o[w]) + (z_o[n] + z_o[s])))
        g_z += diagonal_u * (((z_u[e] + z_u[w]) + (z_u[n] + z_u[s])) - ((x_u[e] - x_u[w]) + (y_u[n] - y_u[s])))
        g_z += edge_o * z_o[i] + edge_u * z_u[i]
        t_sw, t_se = under[sw] + over[sw], under[se] + over[se]
        t_nw, t_ne = under[nw] + over[nw], under[ne] + over[ne]
        f_x[q + one] = (g_x - own_x * x_c[i]) - volume * ((t_sw - t_se) + (t_nw - t_ne))
        f_y[q + one] = (g_y - own_x * y_c[i]) - volume * ((t_sw + t_se) - (t_nw + t_ne))
        f_z[q + one] = (g_z - own_z * z_c[i]) - volume * (
            ((under[sw] - over[sw]) + (under[se] - over[se])) + ((under[nw] - over[nw]) + (under[ne] - over[ne]))
        )


@row_kernel
def slab_force(nodes, force, edge, diagonal, volume, first, end):
    """Write the forces (N) on nodes whose ghosts are filled.

    ``edge``, ``diagonal`` and ``volume`` are the stiffnesses of edge springs, of diagonal springs along an axis, and of
    the dilatation (N/m).
    """
    dilatation, below = _start(nodes, first, end)
    for k in range(nodes.shape[1]):
        _plane_force(nodes, k, dilatation, below, edge, diagonal, volume, first, force, k, first + 1, end + 1)


@row_kernel
def move_slab(nodes, moved, velocity, faces, inverse_mass, action, edge, diagonal, volume, number, first, end):
    """Apply the forces of :func:`slab_force` to the inner planes, one plane at a time, storing none.

    Arguments as of :func:`md_reference.block.verlet.move_plane`, with an ``inverse_mass`` for each plane. ``faces``,
    shape (3, 2, ny + 2, nx + 2), receives the forces (N) on the lowest and highest plane, which are not moved.
    """
    dilatation, below = _start(nodes, first, end)
    inside = np.empty((3, 1, end - first, nodes.shape[3]))
    last = nodes.shape[1] - 1
    for k in range(last + 1):
        if k in (0, last):
            to = faces, min(k, 1), first + 1, end + 1
            _plane_force(nodes, k, dilatation, below, edge, diagonal, volume, first, *to)
        else:
            _plane_force(nodes, k, dilatation, below, edge, diagonal, volume, first, inside, 0, 0, end - first)
            move_plane(nodes, moved, velocity, inside, 0, 0, inverse_mass[k], action, number, k, first, end)


@row_kernel
def prolong(coarse, fine, first, end):
    """Write a level's lowest plane, bilinearly interpolated, on the highest one of the level twice as fine."""
    top = fine.shape[1] - 1
    one = np.uint64(1)
    for c in range(3):
        for j in range(first + 1, end + 1):
            here, next_one = coarse[c, 0, j], coarse[c, 0, j + 1]
            even, odd = fine[c, top, 2 * j - 1], fine[c, top, 2 * j]
            for i in range(one, np.uint64(here.size - 1)):
                e = i + one
                west, east = 2 * i - one, 2 * i
                even[west], even[east] = here[i], 0.5 * (here[i] + here[e])
                odd[west] = 0.5 * (here[i] + next_one[i])
                odd[east] = 0.25 * ((here[i] + here[e]) + (next_one[i] + next_one[e]))


@row_kernel
def restrict(fine, coarse, first, end):
    """Add the transpose of :func:`prolong` to the coarse plane."""
    top, rows, one = fine.shape[1] - 1, fine.shape[2] - 2, np.uint64(1)
    for c in range(3):
        for j in range(first + 1, end + 1):
            here, north = fine[c, top, 2 * j - 1], fine[c, top, 2 * j]
            south = fine[c, top, 2 * j - 2 if j > 1 else rows]
            to = coarse[c, 0, j]
            last = np.uint64(here.size - 2)
            to[1] += here[1] + 0.5 * ((here[last] + here[2]) + (north[1] + south[1]))
            to[1] += 0.25 * ((north[last] + north[2]) + (south[last] + south[2]))
            for i in range(np.uint64(2), np.uint64(to.size - 1)):
                m = 2 * i - one
                w, e = m - one, m + one
                sides = (here[w] + here[e]) + (north[m] + south[m])
                corners = (north[w] + north[e]) + (south[w] + south[e])
                to[i] += here[m] + (0.5 * sides + 0.25 * corners)
