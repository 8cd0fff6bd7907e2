"""Forces and energy of a slab of cells whose springs turn with their atoms, both faces free, periodic along x and y.

Springs along edges and face diagonals of a cell pull along the line between their atoms, ½k(|r| − r₀)², and its volume
costs ½(λ − μ)a³(det F − 1)², F the mean of the deformation gradient over its corners; to first order both are
:func:`md_reference.block.condensed.isotropic_element`. Arrays are those of :mod:`md_reference.block.slab`; rows of a
plane, with the one before and the one after, form a line, and a neighbour is a shift along it.
"""

import numpy as np

from md_reference.block.verlet import move_plane
from md_reference.parallel_rows import row_kernel

# Steps along y and x to the neighbours in the plane, and in the plane above, that a node has springs to.
_WITHIN = ((0, 1), (1, 0), (1, 1), (1, -1))
_UPWARD = ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0))


@row_kernel
def rotating_slab_force(nodes, force, edge, shear_modulus, bulk, first, end):
    """Write the forces (N) on rows of a slab whose ghosts are filled; return the energy of what begins there (J).

    ``edge`` is that of a cell (m), ``shear_modulus`` μ and ``bulk`` λ − μ (Pa).
    """
    forces, pull, stress = _start(nodes, bulk, first, end)
    energy = 0.0
    for k in range(nodes.shape[1]):
        energy += _add_layer(nodes, k, forces, pull, stress, edge, shear_modulus, bulk, first, True)
        force[:, k, first + 1 : end + 1] = forces[:, k & 1, 1:-1]
    return energy


@row_kernel
def move_rotating_slab(
    nodes, moved, velocity, faces, inverse_mass, action, edge, shear_modulus, bulk, number, first, end
):
    """Move the inner planes as :func:`md_reference.block.slab.move_slab`, by the forces of rotating springs."""
    forces, pull, stress = _start(nodes, bulk, first, end)
    last = nodes.shape[1] - 1
    for k in range(last + 1):
        _add_layer(nodes, k, forces, pull, stress, edge, shear_modulus, bulk, first, False)
        if 0 < k < last:
            move_plane(nodes, moved, velocity, forces, k & 1, 1, inverse_mass[k], action, number, k, first, end)
        else:
            faces[:, 0 if k == 0 else 1, first + 1 : end + 1] = forces[:, k & 1, 1:-1]


@row_kernel
def _start(nodes, bulk, first, end):
    """Return arrays for the forces on two planes, the pulls of a node's springs, and the stress of a layer's cells."""
    rows, columns = end - first + 2, nodes.shape[3]
    line = rows * columns
    return np.zeros((3, 2, rows, columns)), np.empty((9, 3, line)), np.empty((10, line if bulk != 0.0 else 0))


@row_kernel
def _add_layer(nodes, k, forces, pull, stress, edge, shear_modulus, bulk, first, with_energy):
    """Complete the forces on plane k, in plane k & 1 of ``forces``; begin those above; return the layer's energy."""
    planes, _, columns = nodes.shape[1:]
    lines, start = nodes.reshape((3, planes, -1)), first * columns
    force = forces.reshape((3, 2, -1))
    here, above = k & 1, (k + 1) & 1
    energy = 0.0
    # Springs within a face of the slab belong to one cell instead of two.
    stiffness = shear_modulus * edge * (1.0 if 0 < k < planes - 1 else 0.5)
    for n in range(4):
        y, x = _WITHIN[n]
        _spring(lines, start, k, k, y * columns + x, columns, edge * x, edge * y, 0.0, stiffness, pull[n])
        if with_energy:
            energy += _stored(pull[n], columns) / (2.0 * stiffness)
    _share_within(pull, columns, force, here)
    if k == planes - 1:
        return energy
    stiffness = shear_modulus * edge
    for n in range(5):
        y, x = _UPWARD[n]
        _spring(lines, start, k, k + 1, y * columns + x, columns, edge * x, edge * y, edge, stiffness, pull[4 + n])
        if with_energy:
            energy += _stored(pull[4 + n], columns) / (2.0 * stiffness)
    _share_upward(pull[4:], columns, force, here, above)
    if bulk != 0.0:
        # The volume is a product of differences over 4a.
        _gradients(lines, start, k, columns, 1.0 / (4.0 * edge), stress)
        _stresses(stress, bulk * edge**2 / 4.0)
        _share_stresses(stress, columns, force, here, above)
        if with_energy:
            energy += 0.5 * bulk * edge**3 * _stored(stress[9:], columns)
    return energy


@row_kernel
def _spring(lines, start, k, to_k, shift, columns, r_x, r_y, r_z, stiffness, pull):
    """Write the pull on every node of plane k by its spring to the node ``shift`` further on in plane ``to_k``.

    The spring at rest is r; nodes are the rows' own and those whose springs end at them.
    """
    low = columns + 1 - max(shift, 0)
    high = pull.shape[1] - columns - 1 - min(shift, 0)
    f_x, f_y, f_z = pull[0, low:high], pull[1, low:high], pull[2, low:high]
    low, high = start + low, start + high
    x, y, z = lines[0, k, low:high], lines[1, k, low:high], lines[2, k, low:high]
    low, high = low + shift, high + shift
    to_x, to_y, to_z = lines[0, to_k, low:high], lines[1, to_k, low:high], lines[2, to_k, low:high]
    per_square = 1.0 / (r_x * r_x + r_y * r_y + r_z * r_z)
    for i in range(np.uint64(x.size)):
        d_x, d_y, d_z = to_x[i] - x[i], to_y[i] - y[i], to_z[i] - z[i]
        # Of the length s in units of that at rest: s² − 1 without the cancellation of the two, and (s − 1)/s.
        grown = per_square * (2.0 * (r_x * d_x + r_y * d_y + r_z * d_z) + (d_x * d_x + d_y * d_y + d_z * d_z))
        square = 1.0 + grown
        tension = stiffness * grown / (square + np.sqrt(square))
        f_x[i], f_y[i], f_z[i] = tension * (r_x + d_x), tension * (r_y + d_y), tension * (r_z + d_z)


@row_kernel
def _share_within(pull, columns, force, here):
    """Add the pulls of the springs of :data:`_WITHIN` to the forces on both of their nodes."""
    low, high = np.uint64(columns + 1), np.uint64(pull.shape[2] - columns - 1)
    one, width = np.uint64(1), np.uint64(columns)
    for c in range(3):
        along_x, along_y, rising, falling = pull[0, c], pull[1, c], pull[2, c], pull[3, c]
        to = force[c, here]
        for i in range(low, high):
            s = i - width
            straight = (along_x[i] - along_x[i - one]) + (along_y[i] - along_y[s])
            to[i] += straight + ((rising[i] - rising[s - one]) + (falling[i] - falling[s + one]))


@row_kernel
def _share_upward(pull, columns, force, here, above):
    """Add the pulls of the springs of :data:`_UPWARD` to the forces on plane ``here``, begin those on ``above``."""
    low, high = np.uint64(columns + 1), np.uint64(pull.shape[2] - columns - 1)
    one, width = np.uint64(1), np.uint64(columns)
    for c in range(3):
        up, east, west, north, south = pull[0, c], pull[1, c], pull[2, c], pull[3, c], pull[4, c]
        to, to_above = force[c, here], force[c, above]
        for i in range(low, high):
            to[i] += up[i] + ((east[i] + west[i]) + (north[i] + south[i]))
            to_above[i] = -(up[i] + ((east[i - one] + west[i + one]) + (north[i - width] + south[i + width])))


@row_kernel
def _stored(values, columns):
    """Return the sum of squares over the rows' nodes without ghosts."""
    total = 0.0
    for begin in range(columns, values.shape[1] - columns, columns):
        for of in values:
            for i in range(begin + 1, begin + columns - 1):
                total += of[i] * of[i]
    return total


@row_kernel
def _gradients(lines, start, k, columns, scale, gradient):
    """Write displacement gradients of the cells over plane k, each at the index of its first corner."""
    one, width, line = np.uint64(1), np.uint64(columns), gradient.shape[1]
    for c in range(3):
        near, up = lines[c, k, start : start + line], lines[c, k + 1, start : start + line]
        along_x, along_y, along_z = gradient[3 * c], gradient[3 * c + 1], gradient[3 * c + 2]
        for i in range(np.uint64(near.size - columns - 1)):
            e, n = i + one, i + width
            ne = n + one
            sw, se, nw = near[i] + up[i], near[e] + up[e], near[n] + up[n]
            far = near[ne] + up[ne]
            along_x[i] = scale * ((se + far) - (sw + nw))
            along_y[i] = scale * ((nw + far) - (sw + se))
            along_z[i] = scale * (((up[i] - near[i]) + (up[e] - near[e])) + ((up[n] - near[n]) + (up[ne] - near[ne])))


@row_kernel
def _stresses(gradient, strength):
    """Turn gradients G into strength (det F − 1) ∂det F/∂F, F = 1 + G, in place, beside det F − 1."""
    xx, xy, xz, yx, yy, yz, zx, zy, zz, growth = gradient
    for i in range(np.uint64(xx.size)):
        f_xx, f_yy, f_zz = 1.0 + xx[i], 1.0 + yy[i], 1.0 + zz[i]
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
        growth[i] = grown
        g = strength * grown
        xx[i], xy[i], xz[i] = g * c_xx, g * c_xy, g * c_xz
        yx[i], yy[i], yz[i] = g * c_yx, g * c_yy, g * c_yz
        zx[i], zy[i], zz[i] = g * c_zx, g * c_zy, g * c_zz


@row_kernel
def _share_stresses(stress, columns, force, here, above):
    """Add the forces of the cells' stresses on the corners below and above."""
    low, high = np.uint64(columns + 1), np.uint64(stress.shape[1] - columns - 1)
    one, width = np.uint64(1), np.uint64(columns)
    for c in range(3):
        of_x, of_y, of_z = stress[3 * c], stress[3 * c + 1], stress[3 * c + 2]
        to, to_above = force[c, here], force[c, above]
        for i in range(low, high):
            w, s = i - one, i - width
            sw = s - one
            within = ((of_x[w] - of_x[i]) + (of_x[sw] - of_x[s])) + ((of_y[sw] + of_y[s]) - (of_y[w] + of_y[i]))
            height = (of_z[w] + of_z[i]) + (of_z[sw] + of_z[s])
            to[i] -= within - height
            to_above[i] -= within + height
