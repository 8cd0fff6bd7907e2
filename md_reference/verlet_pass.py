"""Velocity Verlet's updates of the nodes, each in one pass over memory.

Arrays of nodes have shape (3, planes, ny + 2, nx + 2). The highest plane of a slab does not move on its own, and ghosts
are left alone.
"""

import numpy as np
from numba import njit

_OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": {"contract", "nsz"}}


@njit(**_OPTIONS)
def kick(velocity, force, inverse_mass, duration, first, end):
    """Let the forces act for a duration (s) on the nodes of some rows.

    Parameters
    ----------
    velocity, force : numpy.ndarray, shape (3, planes, ny + 2, nx + 2)
        In m/s and N.
    inverse_mass : numpy.ndarray, shape (planes,)
        Of a node of each plane (1/kg).
    duration : float
        In s.
    first, end : int
        The rows, of ny without ghosts: from ``first`` to before ``end``.
    """
    for c in range(3):
        for k in range(velocity.shape[1] - 1):
            gain = duration * inverse_mass[k]
            for j in range(first + 1, end + 1):
                v = velocity[c, k, j]
                f = force[c, k, j]
                for i in range(np.uint64(1), np.uint64(v.size - 1)):
                    v[i] += gain * f[i]


@njit(**_OPTIONS)
def kick_and_drift(velocity, displacement, force, inverse_mass, duration, first, end):
    """As :func:`kick` for half the duration, then move the nodes for all of it."""
    for c in range(3):
        for k in range(velocity.shape[1] - 1):
            gain = 0.5 * duration * inverse_mass[k]
            for j in range(first + 1, end + 1):
                v = velocity[c, k, j]
                u = displacement[c, k, j]
                f = force[c, k, j]
                for i in range(np.uint64(1), np.uint64(v.size - 1)):
                    faster = v[i] + gain * f[i]
                    v[i] = faster
                    u[i] += duration * faster


@njit(**_OPTIONS)
def kick_and_drift_with_friction(
    velocity, displacement, force, inverse_mass, duration, kept, added, noise, random, first, end
):
    """As :func:`kick_and_drift`, with friction and noise in the middle of the way.

    Parameters
    ----------
    kept : float
        Share of the velocity that friction leaves.
    added : float
        To the velocity along z, of a bath that moves (m/s).
    noise : float
        Variance of the momentum over a mass (J), zero for none.
    random : numpy.ndarray, shape (3, planes, ny + 2, nx + 2)
        Normal numbers, not read without noise.
    """
    half = 0.5 * duration
    for c in range(3):
        wind = added if c == 2 else 0.0
        for k in range(velocity.shape[1] - 1):
            gain = half * inverse_mass[k]
            spread = np.sqrt(noise * inverse_mass[k])
            for j in range(first + 1, end + 1):
                v = velocity[c, k, j]
                u = displacement[c, k, j]
                f = force[c, k, j]
                if noise > 0.0:
                    r = random[c, k, j]
                    for i in range(np.uint64(1), np.uint64(v.size - 1)):
                        before = v[i] + gain * f[i]
                        after = kept * before + wind + spread * r[i]
                        v[i] = after
                        u[i] += half * (before + after)
                else:
                    for i in range(np.uint64(1), np.uint64(v.size - 1)):
                        before = v[i] + gain * f[i]
                        after = kept * before + wind
                        v[i] = after
                        u[i] += half * (before + after)
