"""The compiled sweeps of the edge flow through the scales; see :mod:`theory.edge_flow` for the equations.

Arrays over the scales are ordered from fine to coarse, in units of the law's length and the contact modulus. A scale
adds the height variance Δm in one step of Alexander's L-stable SDIRK method of order two; the first steps of the
distribution, whose data are sharp, are of the implicit Euler method.
"""

import numpy as np
from numba import njit

_GAMMA = 1 - 1 / np.sqrt(2)

# Weight per unit of the gap below which a node's response is that of its own curvature: what such a node does changes
# nothing, and its equations would be those of rounding.
_EMPTY = 1e-12

# Least curvature in units of −K that the response of such a node is taken at.
_STABLE = 0.8


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def sweep(x, stiffness, modulation, square, steps, traction, start, sharp, response, weights, gradients, answer):
    """Follow the distribution from coarse to fine and the traction back; every scale's response to what they find.

    Parameters
    ----------
    x : numpy.ndarray, shape (n,)
        Nodes of the gap.
    stiffness, modulation, square, steps : numpy.ndarray, shape (k,)
        K, the cost g of its modulation, q² and Δm of each scale.
    traction : numpy.ndarray, shape (n,)
        φ' at the nodes.
    start : numpy.ndarray, shape (n,)
        Weights at the mean gap.
    sharp : int
        Coarse scales taken by the Euler method.
    response : numpy.ndarray, shape (k, n)
        f of each scale, the share of a wave by which the gap changes.
    weights, gradients : numpy.ndarray, shape (k + 1, n)
        Filled with the weights P and the densities M = P <|∇u|²> finer than each scale; the last row is the coarsest.
    answer : numpy.ndarray, shape (k, n)
        Filled with the response of equilibrium to these weights and tractions.

    Returns
    -------
    float
        Elastic energy of all scales.
    """
    n = x.size
    lower, diagonal, upper, work = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    right, early, late, curvature = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    _distribute(x, square, steps, start, sharp, response, weights, gradients)
    mean = traction.copy()
    elastic = 0.0
    for k in range(steps.size):
        euler = steps.size - 1 - k < sharp
        weight = steps[k] if euler else _GAMMA * steps[k]
        _diffusion(x, response[k], weight, False, lower, diagonal, upper)
        _solve(lower, diagonal, upper, mean, early, work)
        if euler:
            late[:] = early
        else:
            _second_stage(mean, early, right)
            _solve(lower, diagonal, upper, right, late, work)
        _slope(x, mean, late, curvature)
        mean[:] = late
        _respond(
            x, stiffness[k], modulation[k], square[k], curvature, weights[k : k + 2], gradients[k : k + 2], answer[k]
        )
        stored = 0.0
        for i in range(n):
            here = 0.5 * (weights[k, i] + weights[k + 1, i])
            stored += here * curvature[i] * response[k, i] * (1.0 - response[k, i])
        elastic += 0.5 * steps[k] * stored
    return elastic


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def local_response(x, stiffness, steps, traction, response):
    """Fill f with that of a law which the finer scales only smooth: where the distribution is not known yet."""
    n = x.size
    lower, diagonal, upper, work = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    curvature, mean, smoothed = np.empty(n), traction.copy(), np.empty(n)
    for k in range(steps.size):
        _slope(x, mean, mean, curvature)
        for i in range(n):
            response[k, i] = stiffness[k] / (stiffness[k] + max(curvature[i], -_STABLE * stiffness[k]))
        _diffusion(x, response[k], steps[k], False, lower, diagonal, upper)
        _solve(lower, diagonal, upper, mean, smoothed, work)
        mean[:] = smoothed


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _distribute(x, square, steps, start, sharp, response, weights, gradients):
    """∂P/∂m = ½(f²P)'' and, with M = f²N, ∂N/∂m = ½ f⁻² (f⁴N')' + f'² N + q²P, from coarse to fine."""
    n = x.size
    lower, diagonal, upper, work = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    right, early, begin, middle = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    last = steps.size - 1
    weights[last + 1] = start
    gradients[last + 1] = 0.0
    for k in range(last, -1, -1):
        f = response[k]
        euler = last - k < sharp
        weight = steps[k] if euler else _GAMMA * steps[k]
        _diffusion(x, f, weight, True, lower, diagonal, upper)
        _solve(lower, diagonal, upper, weights[k + 1], early, work)
        if euler:
            weights[k] = early
        else:
            _second_stage(weights[k + 1], early, right)
            _solve(lower, diagonal, upper, right, weights[k], work)
        _gradient_flow(x, f, weight, lower, diagonal, upper)
        source = weight * square[k]
        for i in range(n):
            begin[i] = gradients[k + 1, i] / (f[i] * f[i])
            right[i] = begin[i] + source * early[i] / _cell(x, i)
        _solve(lower, diagonal, upper, right, middle, work)
        if not euler:
            for i in range(n):
                right[i] = begin[i] + (1.0 - _GAMMA) / _GAMMA * (middle[i] - begin[i])
                right[i] += source * weights[k, i] / _cell(x, i)
            _solve(lower, diagonal, upper, right, middle, work)
        for i in range(n):
            gradients[k, i] = middle[i] * f[i] * f[i]


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _respond(x, stiffness, modulation, square, curvature, weights, gradients, answer):
    """Solve K [(1 − g + g X/4) f + g z] + c f = K, (X + 4) z = 4 f by elimination of two-by-two blocks.

    X = −(P q²)⁻¹ ∂ M ∂ with the means of P and M over the scale. Rows are times P, so that a node without weight has
    no equation of its own; it is given the response of its curvature.
    """
    n = x.size
    quarter = 0.25 * modulation
    coupling = np.zeros(n)  # of node i and the next: M over q² and the distance
    a, b, c, d = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    r, s = np.empty(n), np.empty(n)
    for i in range(1, n - 2):
        mean = gradients[0, i] + gradients[0, i + 1] + gradients[1, i] + gradients[1, i + 1]
        coupling[i] = 0.25 * max(mean, 0.0) / ((x[i + 1] - x[i]) * square)
    for i in range(n):
        local = stiffness / (stiffness + max(curvature[i], -_STABLE * stiffness))
        if 0 < i < n - 1:
            joined = coupling[i] + coupling[i - 1]
            share = max(0.5 * (weights[0, i] + weights[1, i]), 0.0)
            empty = _EMPTY * _cell(x, i)
            a[i] = quarter * joined + share * (1.0 - modulation + curvature[i] / stiffness) + empty
            b[i] = modulation * share
            c[i] = -4.0 * share
            d[i] = joined + 4.0 * share + empty
            r[i] = share + empty * local
            s[i] = empty * local
        else:
            a[i] = d[i] = 1.0
            b[i] = c[i] = 0.0
            r[i] = s[i] = local
    for i in range(1, n):
        t = coupling[i - 1]
        scale = t / (a[i - 1] * d[i - 1] - b[i - 1] * c[i - 1])
        aa, bb, cc, dd = d[i - 1] * scale, -b[i - 1] * scale, -c[i - 1] * scale, a[i - 1] * scale
        a[i] -= quarter * quarter * t * aa
        b[i] -= quarter * t * bb
        c[i] -= quarter * t * cc
        d[i] -= t * dd
        r[i] += quarter * (aa * r[i - 1] + bb * s[i - 1])
        s[i] += cc * r[i - 1] + dd * s[i - 1]
    f = z = 0.0
    for i in range(n - 1, -1, -1):
        first, second = r[i] + quarter * coupling[i] * f, s[i] + coupling[i] * z
        scale = 1.0 / (a[i] * d[i] - b[i] * c[i])
        f, z = (d[i] * first - b[i] * second) * scale, (a[i] * second - c[i] * first) * scale
        answer[i] = f


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _diffusion(x, response, weight, transposed, lower, diagonal, upper):
    """1 − weight ½f²∂² or its transpose, with end rows that change nothing."""
    n = x.size
    lower[:] = 0.0
    upper[:] = 0.0
    diagonal[:] = 1.0
    for i in range(1, n - 1):
        before, behind = x[i] - x[i - 1], x[i + 1] - x[i]
        factor = weight * response[i] * response[i] / (before + behind)
        diagonal[i] += factor * (1.0 / before + 1.0 / behind)
        if transposed:
            upper[i - 1] = -factor / before
            lower[i + 1] = -factor / behind
        else:
            lower[i] = -factor / before
            upper[i] = -factor / behind


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _gradient_flow(x, response, weight, lower, diagonal, upper):
    """1 − weight (½ f⁻² ∂ f⁴ ∂ + f'²); the same operator as ½f²∂² + 2ff'∂ + f'², without a second derivative of f."""
    n = x.size
    lower[0] = upper[0] = lower[n - 1] = upper[n - 1] = 0.0
    diagonal[0] = diagonal[n - 1] = 1.0
    for i in range(1, n - 1):
        before, behind = x[i] - x[i - 1], x[i + 1] - x[i]
        factor = weight / (before + behind)
        lower[i] = -factor * response[i - 1] ** 2 / before
        upper[i] = -factor * response[i + 1] ** 2 / behind
        stretch = (response[i] - response[i - 1]) ** 2 / before + (response[i + 1] - response[i]) ** 2 / behind
        diagonal[i] = 1.0 - lower[i] - upper[i] - factor * stretch


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _second_stage(begin, early, right):
    """Right side of the second stage of a step without a source."""
    for i in range(begin.size):
        right[i] = begin[i] + (1.0 - _GAMMA) / _GAMMA * (early[i] - begin[i])


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _solve(lower, diagonal, upper, right, solution, work):
    """Tridiagonal elimination; ``work`` is lost."""
    n = right.size
    pivot = 1.0 / diagonal[0]
    work[0] = upper[0] * pivot
    solution[0] = right[0] * pivot
    for i in range(1, n):
        pivot = 1.0 / (diagonal[i] - lower[i] * work[i - 1])
        work[i] = upper[i] * pivot
        solution[i] = (right[i] - lower[i] * solution[i - 1]) * pivot
    for i in range(n - 2, -1, -1):
        solution[i] -= work[i] * solution[i + 1]


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _slope(x, one, other, slope):
    """Derivative of the mean of two functions, of second order on any nodes."""
    n = x.size
    for i in range(1, n - 1):
        before, behind = x[i] - x[i - 1], x[i + 1] - x[i]
        left = (one[i] + other[i] - one[i - 1] - other[i - 1]) / before
        right = (one[i + 1] + other[i + 1] - one[i] - other[i]) / behind
        slope[i] = 0.5 * (left * behind + right * before) / (before + behind)
    slope[0], slope[n - 1] = slope[1], slope[n - 2]


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"}, inline="always")
def _cell(x, i):
    """Length of the gap that belongs to node i."""
    if i == 0:
        return x[1] - x[0]
    if i == x.size - 1:
        return x[i] - x[i - 1]
    return 0.5 * (x[i + 1] - x[i - 1])
