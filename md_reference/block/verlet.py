"""Velocity Verlet's update of nodes in one pass over memory: kick by the forces, friction and noise, drift.

Arrays of nodes have shape (3, planes, ny + 2, nx + 2); ghosts are left alone.
"""

from typing import NamedTuple

import numpy as np

from md_reference.parallel_rows import row_kernel

_WIDTH = float(np.sqrt(3.0))
_SHARE = 2**21 // 6  # of 21 random bits: a sixth to either side
_BITS = 2**21 - 1
_STRIDE = 0x9E3779B97F4A7C15  # an odd number near 2⁶⁴ over the golden mean


class Action(NamedTuple):
    """Effect of a force f on a node of mass m and velocity v: v + kick·f/m, then friction and noise, and the drift."""

    kick: float  # duration of the force (s)
    kept: float = 1.0  # share of the velocity that friction leaves
    wind: float = 0.0  # velocity along z that a moving bath adds (m/s)
    half: float = 0.0  # duration of the drift before friction and noise, and of that after them (s)
    noise: float = 0.0  # variance of the momentum over a mass (J)
    key: int = 0  # of the noise's random numbers


@row_kernel
def _mixed(state):
    """Return 64 random bits of a state (mix64 of G. L. Steele, D. Lea and C. H. Flood, OOPSLA 2014, 453)."""
    state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return state ^ (state >> np.uint64(31))


@row_kernel
def _three_point(bits):
    """Return ±√3, each for a sixth of all values of 21 bits, or 0: the moments of a normal number up to the fifth."""
    value = np.int64(bits & np.uint64(_BITS))
    return _WIDTH * (np.float64(value < _SHARE) - np.float64(value > _BITS - _SHARE))


@row_kernel
def move_plane(
    displacement, moved, velocity, force, force_plane, force_row, inverse_mass, action, number, k, first, end
):
    """Apply forces to the rows ``first`` to before ``end`` of plane ``k``.

    Noise is a function of the node's number and the step's key alone; three points suffice for weak schemes of second
    order (P. E. Kloeden, E. Platen, Numerical Solution of Stochastic Differential Equations, Springer 1992). Positions
    before and after may be the same array. Row ``first`` has its forces (N) in row ``force_row`` of the plane
    ``force_plane``; ``number`` is that of the slab's first node in the block.
    """
    gain = action.kick * inverse_mass
    spread = np.sqrt(action.noise * inverse_mass)
    kept, half = action.kept, action.half
    rows, columns = velocity.shape[2:]
    one = np.uint64(1)
    inside = np.uint64(columns - 1)
    for j in range(first + 1, end + 1):
        row = force_row + j - first - 1
        if spread > 0.0:
            state = np.uint64(action.key) + np.uint64(number + (k * rows + j) * columns) * np.uint64(_STRIDE)
            u_x, u_y, u_z = displacement[0, k, j], displacement[1, k, j], displacement[2, k, j]
            m_x, m_y, m_z = moved[0, k, j], moved[1, k, j], moved[2, k, j]
            v_x, v_y, v_z = velocity[0, k, j], velocity[1, k, j], velocity[2, k, j]
            f_x, f_y, f_z = force[0, force_plane, row], force[1, force_plane, row], force[2, force_plane, row]
            for i in range(one, inside):
                bits = _mixed(state + i * np.uint64(_STRIDE))
                before_x = v_x[i] + gain * f_x[i]
                before_y = v_y[i] + gain * f_y[i]
                before_z = v_z[i] + gain * f_z[i]
                after_x = kept * before_x + spread * _three_point(bits)
                after_y = kept * before_y + spread * _three_point(bits >> np.uint64(21))
                after_z = kept * before_z + action.wind + spread * _three_point(bits >> np.uint64(42))
                v_x[i], v_y[i], v_z[i] = after_x, after_y, after_z
                m_x[i] = u_x[i] + half * (before_x + after_x)
                m_y[i] = u_y[i] + half * (before_y + after_y)
                m_z[i] = u_z[i] + half * (before_z + after_z)
        else:
            for c in range(3):
                wind = action.wind if c == 2 else 0.0
                u, m, v = displacement[c, k, j], moved[c, k, j], velocity[c, k, j]
                f = force[c, force_plane, row]
                for i in range(one, inside):
                    before = v[i] + gain * f[i]
                    after = kept * before + wind
                    v[i] = after
                    m[i] = u[i] + half * (before + after)
