"""The compiled steps of the gap flow, fine to coarse and back; see :mod:`theory.gap_flow.flow` for the equations."""

import numpy as np
from numba import njit

BRANCHES = ("equilibrium", "loading", "unloading")

_EQUILIBRIUM, _LOADING = 0, 1
_STEP_TOLERANCE = 1e-9  # largest relative change of v in the last iteration of Newton's method in a step


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _convex_hull(x, energy, stiffness, left):
    """Replace U by the hull of U + ½Kx², less ½Kx²; ``left[i]`` becomes the vertex at or left of node i."""
    n = x.size
    tilted = energy + 0.5 * stiffness * x * x
    vertices = np.empty(n, dtype=np.int32)
    count = 1
    vertices[0] = 0
    for i in range(1, n):
        while count > 1:
            a, b = vertices[count - 2], vertices[count - 1]
            if (tilted[b] - tilted[a]) * (x[i] - x[a]) >= (tilted[i] - tilted[a]) * (x[b] - x[a]):
                count -= 1
            else:
                break
        vertices[count] = i
        count += 1
    for k in range(count - 1):
        a, b = vertices[k], vertices[k + 1]
        slope = (tilted[b] - tilted[a]) / (x[b] - x[a])
        left[a] = a
        for i in range(a + 1, b):
            left[i] = a
            energy[i] = tilted[a] + slope * (x[i] - x[a]) - 0.5 * stiffness * x[i] * x[i]
    left[n - 1] = n - 1


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _jump_at_instability(x, energy, stiffness, loading, left):
    """Make U' + Kx rise monotonically by jumps of the approaching (or retracting) patch; ``left`` as for the hull."""
    n = x.size
    force = np.empty(n - 1)
    for i in range(n - 1):
        force[i] = (energy[i + 1] - energy[i]) / (x[i + 1] - x[i]) + 0.5 * stiffness * (x[i + 1] + x[i])
    if loading:
        for i in range(n - 3, -1, -1):
            force[i] = min(force[i], force[i + 1])
    else:
        for i in range(1, n - 1):
            force[i] = max(force[i], force[i - 1])
    left[0], left[n - 1] = 0, n - 1
    for i in range(1, n - 1):
        left[i] = left[i - 1] if force[i] == force[i - 1] else i
    for i in range(n - 2, -1, -1):
        slope = force[i] - 0.5 * stiffness * (x[i + 1] + x[i])
        energy[i] = energy[i + 1] - slope * (x[i + 1] - x[i])


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def flow_through_scales(x, stiffness, steps, branch, iterations, energy, compliances, hull):
    """Add all scales to ``energy`` in place; keeps v and coexisting states of each step, returns unconverged ones."""
    n = x.size
    below, above = _second_derivative(x)
    modulus, v, pivot, change = np.empty(n), np.empty(n), np.empty(n), np.empty(n)  # K + c before the step, v
    unconverged = 0
    for k in range(steps.size):
        stiff, step = stiffness[k], steps[k]
        if branch == _EQUILIBRIUM:
            _convex_hull(x, energy, stiff, hull[k])
        else:
            _jump_at_instability(x, energy, stiff, branch == _LOADING, hull[k])
        for i in range(1, n - 1):
            curvature = above[i] * (energy[i + 1] - energy[i]) - below[i] * (energy[i] - energy[i - 1])
            modulus[i] = max(stiff + curvature, 0.0)  # zero inside the hull, up to rounding
        square = 0.5 * stiff * stiff
        if k == 0:
            for i in range(1, n - 1):
                v[i] = square / max(modulus[i], stiff)
        else:
            v *= stiff / stiffness[k - 1]
        # At the ends the curvature hardly changes: deep repulsion and no interaction at all.
        v[0] = square / modulus[1]
        v[n - 1] = 0.5 * stiff
        solved = False
        for _ in range(iterations):
            pivot[0] = 1.0
            change[0] = 0.0
            for i in range(1, n - 1):
                excess = square / v[i] - modulus[i]
                excess += step * (above[i] * (v[i + 1] - v[i]) - below[i] * (v[i] - v[i - 1]))
                factor = step * below[i] * pivot[i - 1]
                upper = -step * above[i - 1]
                diagonal = square / (v[i] * v[i]) + step * (above[i] + below[i])
                pivot[i] = 1.0 / (diagonal + factor * upper)
                change[i] = excess + factor * change[i - 1]
            solved = True
            later = 0.0
            for i in range(n - 2, 0, -1):
                later = (change[i] + step * above[i] * later) * pivot[i]
                relative = later / v[i]
                solved &= abs(relative) < _STEP_TOLERANCE  # not so where it is no number
                # From above the root the tangent may point beyond zero.
                v[i] *= max(1.0 + relative, 0.1)
            if solved:
                break
        if not solved:
            unconverged += 1
        for i in range(n):
            energy[i] += step * (0.5 * stiff - v[i])
            compliances[k, i] = v[i]
    return unconverged


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def backward_sweep(x, stiffness, steps, compliances, hull, weights, elastic):
    """Carry distributions, columns of ``weights``, from coarse to fine in place, adding up their elastic energies."""
    n, states = weights.shape
    below, above = _second_derivative(x)
    own, pivot, ratio = np.empty(n), np.empty(n), np.empty(n)
    right = np.empty(n, dtype=np.int32)
    later = np.empty(states)
    for k in range(steps.size - 1, -1, -1):
        stiff, step = stiffness[k], steps[k]
        v, left = compliances[k], hull[k]
        # The transpose of the step's matrix ½K²/v² − Δm ∂², whose end rows are diagonal.
        for i in range(n):
            own[i] = 0.5 * stiff * stiff / (v[i] * v[i])
        pivot[0] = 1.0 / own[0]
        for i in range(1, n):
            ratio[i] = -step * above[i - 1] * pivot[i - 1]
            pivot[i] = 1.0 / (own[i] + step * (above[i] + below[i]) + ratio[i] * step * below[i])
        for i in range(n - 2, -1, -1):
            right[i] = i + 1 if left[i + 1] == i + 1 else right[i + 1]
        for i in range(1, n):
            for state in range(states):
                weights[i, state] -= ratio[i] * weights[i - 1, state]
        later[:] = 0.0
        for i in range(n - 1, -1, -1):
            from_above = step * below[i + 1] if i < n - 1 else 0.0
            followed = 1.0 - 2.0 * v[i] / stiff  # c/(K + c): the wave's share that the block takes up
            energy = 0.5 * stiff * followed * followed * step
            for state in range(states):
                later[state] = (weights[i, state] + from_above * later[state]) * pivot[i]
                weights[i, state] = later[state] * own[i]
                elastic[state] += weights[i, state] * energy
        for i in range(n):
            a = left[i]
            if a != i:
                b = right[i]
                share = (x[i] - x[a]) / (x[b] - x[a])
                energy = 0.5 * stiff * (x[i] - x[a]) * (x[b] - x[i])
                for state in range(states):
                    weight = weights[i, state]
                    elastic[state] += weight * energy
                    weights[a, state] += (1.0 - share) * weight
                    weights[b, state] += share * weight
                    weights[i, state] = 0.0


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _second_derivative(x):
    """Weights of the nodes below and above in the second derivative at a node; zero at the ends."""
    below, above = np.zeros(x.size), np.zeros(x.size)
    for i in range(1, x.size - 1):
        cell = 0.5 * (x[i + 1] - x[i - 1])
        below[i] = 1.0 / ((x[i] - x[i - 1]) * cell)
        above[i] = 1.0 / ((x[i + 1] - x[i]) * cell)
    return below, above
