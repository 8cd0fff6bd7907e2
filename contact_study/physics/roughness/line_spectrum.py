"""Isotropic two-dimensional spectrum of the one-dimensional one of line scans, an inverse Abel transform.

C_1D(q) = ∫ C(√(q² + k²)) dk = 2 ∫_q^∞ C(s) s ds / √(s² − q²), with h_rms² = ∫ C_1D dq over both signs of q.
Source: T. D. B. Jacobs, T. Junge, L. Pastewka, Surf. Topogr.: Metrol. Prop. 5, 013001 (2017), whose spectra are 2π and
4π² times these.
"""

import numpy as np

_MOST, _PRECISE = 100, 1e-6  # steps of the inversion, and the largest difference of ln C_1D that ends them
_TAIL = 5  # bands at the end of a scan whose power law continues
_SHALLOWEST, _STEEPEST = -2.0, -8.0  # powers of it, of C: H = 0 to 3
_REACH, _PANELS = 14.0, 140  # of the integral over t, s = q cosh t, and panels of it


def isotropic_density(wavevectors: np.ndarray, profile: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Calculate the isotropic C(q) of a one-dimensional spectrum by an inverse Abel transform, stable against noise.

    The ratio C/C_1D is exact for the smoothest curve that statistical errors allow, a power law between wavevectors. It
    multiplies the spectrum itself: its noise is not amplified, errors of bands stay independent. Beyond the last
    wavevector the power law of the last bands continues, which matters in the last octave.

    Parameters
    ----------
    wavevectors, profile : numpy.ndarray, shape (n,)
        Rising q (1/m) and C_1D(q) > 0 (m³), n > 2.
    variance : numpy.ndarray, shape (n,)
        Statistical variance of ln C_1D; zeros ask for the transform of the very curve.

    Returns
    -------
    numpy.ndarray, shape (n,)
        C(q) (m⁴).

    Examples
    --------
    >>> import numpy as np
    >>> from contact_study.physics.roughness.line_spectrum import isotropic_density
    >>> q = np.geomspace(1e6, 1e8, 21)
    >>> density = isotropic_density(q, 2e-26 * (q / 1e6) ** -2, 0 * q)  # H = 1/2, for which C = C_1D / 2q
    >>> bool(np.allclose(density, 1e-32 * (q / 1e6) ** -3, rtol=1e-3))
    True
    """
    log_q, measured = np.log(wavevectors), np.log(profile)
    target = _smooth(log_q, measured, variance)
    last = slice(-min(_TAIL, log_q.size), None)
    power = np.clip(np.polyfit(log_q[last], target[last], 1)[0] - 1, _STEEPEST, _SHALLOWEST)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    half = 0.5 * _REACH / _PANELS
    t = (half * (2 * np.arange(_PANELS)[:, None] + 1 + nodes)).ravel()
    log_s = log_q[:, None] + np.log(np.cosh(t))
    measure = 2 * half * np.tile(weights, _PANELS) * np.exp(log_s)
    tail = power * np.maximum(log_s - log_q[-1], 0.0)
    found = target - np.log(2 * wavevectors)
    # C_1D at a q depends on C at larger ones alone: each step is right for one more from the end.
    for _ in range(_MOST):
        residual = target - np.log(np.sum(measure * np.exp(np.interp(log_s, log_q, found) + tail), axis=1))
        found = found + residual
        if np.abs(residual).max() < _PRECISE:
            break
    return np.exp(found + measured - target)


def _smooth(x: np.ndarray, y: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """The falling curve of least second derivative that is as far from points as their variance is, in the mean."""
    from scipy.optimize import isotonic_regression  # slow to import

    if not np.all(variance > 0):
        return y
    step = np.diff(x)
    bend = np.zeros((x.size - 2, x.size))
    for row in range(x.size - 2):
        bend[row, row : row + 3] = 1 / step[row], -1 / step[row] - 1 / step[row + 1], 1 / step[row + 1]
    roughness, weight = bend.T @ bend, np.diag(1 / variance)
    low, high = -12.0, 12.0  # decades of the weight of the bend
    for _ in range(40):
        middle = 0.5 * (low + high)
        curve = np.linalg.solve(weight + 10**middle * roughness, weight @ y)
        low, high = (middle, high) if np.mean((curve - y) ** 2 / variance) < 1 else (low, middle)
    # A C(q) that is nowhere negative has a C_1D that falls.
    return isotonic_regression(curve, weights=1 / variance, increasing=False).x
