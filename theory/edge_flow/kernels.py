"""The compiled sweeps of the edge flow through the scales; see :mod:`theory.edge_flow.flow` for the equations.

Scales are ordered from fine to coarse. Each adds its height variance Δm in one step of Alexander's L-stable SDIRK
method of order two; the first steps of the distribution, whose data are sharp, are of the implicit Euler method.
"""

import numpy as np
from numba import njit

from theory.numerics.tridiagonal import factorise, solve

_GAMMA = 1 - 1 / np.sqrt(2)

# Weight per unit of the gap below which a node's equations would be rounding errors: its response is that of the local
# curvature, of which the other number is the least in units of −K.
_EMPTY, _STABLE = 1e-12, 0.8
_FASTEST = 0.5  # growth of the gradients in a stage of a step, whose implicit equations have no sense from 1 on


def differences(x: np.ndarray) -> np.ndarray:
    """Coefficients of the differences on nodes, shape (5, n); the first four are zero at the ends.

    ½u'' = c₀ (u₋ − u) + c₁ (u₊ − u) and u' = c₂ (u − u₋) + c₃ (u₊ − u); c₄ is the gap that belongs to a node.
    """
    found = np.zeros((5, x.size))
    before, behind = np.diff(x)[:-1], np.diff(x)[1:]
    found[0, 1:-1] = 1 / (before * (before + behind))
    found[1, 1:-1] = 1 / (behind * (before + behind))
    found[2, 1:-1] = behind / (before * (before + behind))
    found[3, 1:-1] = before / (behind * (before + behind))
    found[4] = np.concatenate([[x[1] - x[0]], 0.5 * (before + behind), [x[-1] - x[-2]]])
    return found


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def sweep(x, geometry, scales, kernel, traction, start, sharp, response, weights, gradients, answer, factors):
    """Follow the distribution from coarse to fine and the traction back; every scale's response to what they find.

    Filled are ``weights`` P and ``gradients`` M finer than each scale, shape (k + 1, n); ``answer``, the response f of
    equilibrium, (k, n); and ``factors`` of each scale's diffusion, (k, 3, n). Given are φ' at the nodes, the weights to
    start from, and how many coarse scales are taken by the Euler method. Returns the elastic energy of all scales.
    """
    n = x.size
    stiffness, modulation, square, steps = scales
    early, late, curvature, rows = np.empty(n), np.empty(n), np.empty(n), np.empty((7, n))
    _distribute(geometry, square, steps, start, sharp, response, weights, gradients, factors)
    mean = traction.copy()
    elastic = 0.0
    for k in range(steps.size):
        inverse, inward, outward = factors[k, 0], factors[k, 1], factors[k, 2]
        early[:] = mean
        solve(inverse, inward, outward, early)
        if steps.size - 1 - k < sharp:
            late[:] = early
        else:
            _second_stage(mean, early, late)
            solve(inverse, inward, outward, late)
        _slope(geometry, mean, late, curvature)
        mean[:] = late
        scale = stiffness[k], modulation[k], square[k]
        _respond(x, geometry[4], scale, kernel, curvature, weights[k : k + 2], gradients[k : k + 2], answer[k], rows)
        stored = 0.0
        for i in range(n):
            here = 0.5 * (weights[k, i] + weights[k + 1, i])
            stored += here * curvature[i] * response[k, i] * (1.0 - response[k, i])
        elastic += 0.5 * steps[k] * stored
    return elastic


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def compare(weights, response, answer, least, largest, unseen, importance):
    """Largest change of a scale's mean response; bounds the answer, and fills the importance of each of its values."""
    worst = 0.0
    for k in range(response.shape[0]):
        change = 0.0
        for i in range(response.shape[1]):
            area = max(0.5 * (weights[k, i] + weights[k + 1, i]), 0.0)
            found = answer[k, i]
            bounded = min(max(found, least), largest)
            change += area * abs((bounded if 0.0 < found < least else found) - response[k, i])
            importance[k, i] = np.sqrt(area + unseen) * response[k, i]
            answer[k, i] = bounded
        if change > worst or change != change:  # no number is no convergence, and stays
            worst = change
    return worst


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def bounded_area(geometry, steps, sharp, response, weights):
    """Largest area of a scale where the growth of the gradients is bounded: its step is too long for the response."""
    worst = 0.0
    for k in range(steps.size):
        weight = steps[k] if steps.size - 1 - k < sharp else _GAMMA * steps[k]
        area = 0.0
        for i in range(1, response.shape[1] - 1):
            before, here, behind = response[k, i - 1], response[k, i], response[k, i + 1]
            if weight * (geometry[0, i] * (here - before) ** 2 + geometry[1, i] * (behind - here) ** 2) > _FASTEST:
                area += 0.5 * (weights[k, i] + weights[k + 1, i])
        worst = max(worst, area)
    return worst


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def local_response(geometry, stiffness, steps, traction, response):
    """Fill f with that of a law which the finer scales only smooth: where the distribution is not known yet."""
    n = traction.size
    factors = np.empty((3, n))
    curvature, mean = np.empty(n), traction.copy()
    for k in range(steps.size):
        _slope(geometry, mean, mean, curvature)
        for i in range(n):
            response[k, i] = stiffness[k] / (stiffness[k] + max(curvature[i], -_STABLE * stiffness[k]))
        _diffusion(geometry, response[k], steps[k], factors)
        solve(factors[0], factors[1], factors[2], mean)


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _distribute(geometry, square, steps, start, sharp, response, weights, gradients, factors):
    """∂P/∂m = ½(f²P)'' and, with M = f²N, ∂N/∂m = ½ f⁻² (f⁴N')' + f'² N + q²P, from coarse to fine."""
    n = start.size
    stretching = np.empty((3, n))
    early, begin, middle = np.empty(n), np.empty(n), np.empty(n)
    cell = geometry[4]
    last = steps.size - 1
    weights[last + 1] = start
    gradients[last + 1] = 0.0
    for k in range(last, -1, -1):
        f = response[k]
        euler = last - k < sharp
        weight = steps[k] if euler else _GAMMA * steps[k]
        _diffusion(geometry, f, weight, factors[k])
        inverse, inward, outward = factors[k, 0], factors[k, 1], factors[k, 2]
        early[:] = weights[k + 1]
        solve(inverse, outward, inward, early)
        if euler:
            weights[k] = early
        else:
            _second_stage(weights[k + 1], early, weights[k])
            solve(inverse, outward, inward, weights[k])
        _gradient_flow(geometry, f, weight, stretching)
        source = weight * square[k]
        for i in range(n):
            begin[i] = gradients[k + 1, i] / (f[i] * f[i])
            middle[i] = begin[i] + source * early[i] / cell[i]
        solve(stretching[0], stretching[1], stretching[2], middle)
        if not euler:
            for i in range(n):
                middle[i] = begin[i] + (1.0 - _GAMMA) / _GAMMA * (middle[i] - begin[i])
                middle[i] += source * weights[k, i] / cell[i]
            solve(stretching[0], stretching[1], stretching[2], middle)
        for i in range(n):
            gradients[k, i] = middle[i] * f[i] * f[i]


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _respond(x, cell, scale, kernel, curvature, weights, gradients, answer, rows):
    """Solve for the response f by elimination of two-by-two blocks.

    K [(1 − g + g t + g s X) f + g (1 − t) z] + c f = K and (X + b) z = b f; s, t, b: slope, level, pole.
    X = −(P q²)⁻¹ ∂ M ∂ with the means of P and M over the scale. Rows are times P: a node without weight is given the
    response of its curvature. Blocks are eliminated from both ends inward.
    """
    n = x.size
    stiffness, modulation, square = scale
    slope, level, pole = kernel
    slope *= modulation
    # Block of each node, its right side, and the coupling to the next node: M over q² and the distance.
    a, b, c, d, r, s, coupling = rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6]
    coupling[:] = 0.0
    for i in range(1, n - 2):
        mean = gradients[0, i] + gradients[0, i + 1] + gradients[1, i] + gradients[1, i + 1]
        coupling[i] = 0.25 * max(mean, 0.0) / ((x[i + 1] - x[i]) * square)
    for i in range(n):
        answer[i] = stiffness / (stiffness + max(curvature[i], -_STABLE * stiffness))
    for i in range(1, n - 1):
        joined = coupling[i] + coupling[i - 1]
        share = max(0.5 * (weights[0, i] + weights[1, i]), 0.0)
        empty = _EMPTY * cell[i]
        a[i] = slope * joined + share * (1.0 - modulation * (1.0 - level) + curvature[i] / stiffness) + empty
        b[i] = modulation * (1.0 - level) * share
        c[i] = -pole * share
        d[i] = joined + pole * share + empty
        r[i] = share + empty * answer[i]
        s[i] = empty * answer[i]
    # The end nodes, coupled to nothing, keep the response of their curvature.
    middle = n // 2
    left, right = _block(rows, 1), _block(rows, n - 2)
    for i in range(2, middle):
        left = _eliminate(rows, left, i, coupling[i - 1], slope)
        right = _eliminate(rows, right, n - 1 - i, coupling[n - 1 - i], slope)
    if n - middle > middle:
        right = _eliminate(rows, right, middle, coupling[middle], slope)
    _eliminate(rows, left, middle, coupling[middle - 1], slope)
    scale = 1.0 / (a[middle] * d[middle] - b[middle] * c[middle])
    low = high = (d[middle] * r[middle] - b[middle] * s[middle]) * scale
    below = above = (a[middle] * s[middle] - c[middle] * r[middle]) * scale
    answer[middle] = low
    for i in range(middle - 1, 0, -1):
        low, below = _substitute(rows, i, coupling[i], slope, low, below)
        answer[i] = low
    for i in range(middle + 1, n - 1):
        high, above = _substitute(rows, i, coupling[i - 1], slope, high, above)
        answer[i] = high


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"}, inline="always")
def _block(rows, i):
    """Block and right side of a node."""
    return rows[0, i], rows[1, i], rows[2, i], rows[3, i], rows[4, i], rows[5, i]


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"}, inline="always")
def _eliminate(rows, neighbour, i, t, slope):
    """Take the block of a neighbour, to which a node is coupled by t, out of the node's; returns what is left."""
    a, b, c, d, r, s = neighbour
    scale = t / (a * d - b * c)
    left = (
        rows[0, i] - slope * slope * t * (d * scale),
        rows[1, i] + slope * t * (b * scale),
        rows[2, i] + slope * t * (c * scale),
        rows[3, i] - t * (a * scale),
        rows[4, i] + slope * ((d * r - b * s) * scale),
        rows[5, i] + (a * s - c * r) * scale,
    )
    rows[0, i], rows[1, i], rows[2, i], rows[3, i], rows[4, i], rows[5, i] = left
    return left


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"}, inline="always")
def _substitute(rows, i, t, slope, f, z):
    """f and z of a node from those of the neighbour that was taken out after it."""
    first, second = rows[4, i] + slope * t * f, rows[5, i] + t * z
    scale = 1.0 / (rows[0, i] * rows[3, i] - rows[1, i] * rows[2, i])
    return (rows[3, i] * first - rows[1, i] * second) * scale, (rows[0, i] * second - rows[2, i] * first) * scale


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _diffusion(geometry, response, weight, factors):
    """Factors of 1 − weight ½f²∂², with end rows that change nothing."""
    n = response.size
    lower, diagonal, upper = np.empty(n), np.empty(n), np.empty(n)
    for i in range(n):
        factor = weight * response[i] * response[i]
        lower[i] = -factor * geometry[0, i]
        upper[i] = -factor * geometry[1, i]
        diagonal[i] = 1.0 - lower[i] - upper[i]
    factorise(lower, diagonal, upper, factors[0], factors[1], factors[2])


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _gradient_flow(geometry, response, weight, factors):
    """Factors of 1 − weight (½ f⁻² ∂ f⁴ ∂ + f'²); the operator is ½f²∂² + 2ff'∂ + f'² without a second derivative."""
    n = response.size
    lower, diagonal, upper = np.zeros(n), np.ones(n), np.zeros(n)
    for i in range(1, n - 1):
        left, right = weight * geometry[0, i], weight * geometry[1, i]
        before, here, behind = response[i - 1], response[i], response[i + 1]
        lower[i] = -left * before**2
        upper[i] = -right * behind**2
        growth = left * (here - before) ** 2 + right * (behind - here) ** 2
        diagonal[i] = 1.0 - lower[i] - upper[i] - min(growth, _FASTEST)
    factorise(lower, diagonal, upper, factors[0], factors[1], factors[2])


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _second_stage(begin, early, right):
    """Right side of the second stage of a step without a source."""
    for i in range(begin.size):
        right[i] = begin[i] + (1.0 - _GAMMA) / _GAMMA * (early[i] - begin[i])


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _slope(geometry, one, other, slope):
    """Derivative of the mean of two functions; at the ends that of their neighbours."""
    n = slope.size
    for i in range(1, n - 1):
        before, here, behind = one[i - 1] + other[i - 1], one[i] + other[i], one[i + 1] + other[i + 1]
        slope[i] = 0.5 * (geometry[2, i] * (here - before) + geometry[3, i] * (behind - here))
    slope[0], slope[n - 1] = slope[1], slope[n - 2]
