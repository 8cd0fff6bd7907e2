"""Means of correlated series: how long a series remembers, and the error that its mean has for that.

The error of a mean over n values that remember for τ is that of n/(2τ) independent ones. τ is the integrated
autocorrelation time, ½ + Σ ρ(t), summed up to a window of five times itself, where what is left is below e⁻⁵ of the sum
for an exponential memory and noise would only add (A. D. Sokal, in "Functional Integration: Basics and Applications",
1997). The standard error of τ is √(2(2W + 1)/n) τ, W the window (ibid.): without memory, W = 3, half of τ at n = 56. No
series tells a memory much longer than itself.
"""

from dataclasses import dataclass

import numpy as np

_WINDOW = 5.0

# Values below which no τ is believed: even of the shortest window, three, its standard error is more than half of it.
LEAST_STATES = 50


@dataclass(frozen=True)
class SeriesStatistics:
    """What a series of values says of their mean.

    Attributes
    ----------
    mean, standard_error : numpy.ndarray, shape (...)
        The mean of every column, and its error.
    autocorrelation_time : numpy.ndarray, shape (...)
        τ in steps of the series; ½ where the values are independent, or all equal.
    resolved : numpy.ndarray of bool, shape (...)
        Whether there are ``LEAST_STATES`` values, and τ is larger than its own standard error, which takes a series of
        twenty τ; a shorter one shows no τ, and its error is a guess. Values that are all equal have no error, and need
        be two.
    """

    mean: np.ndarray
    standard_error: np.ndarray
    autocorrelation_time: np.ndarray
    resolved: np.ndarray


def autocovariance(series: np.ndarray) -> np.ndarray:
    """Γ(t) = 1/(n − t) Σ δ_i δ_{i+t} of every column, δ the deviation from the column's mean, for t = 0 … n − 1.

    Parameters
    ----------
    series : numpy.ndarray, shape (n, ...)
        Values one after the other.
    """
    count = series.shape[0]
    deviation = series - np.mean(series, axis=0)
    spectrum = np.fft.rfft(deviation, 2 * count, axis=0)  # twice the length: the ends do not meet
    sums = np.fft.irfft(np.abs(spectrum) ** 2, 2 * count, axis=0)[:count]
    return sums / (count - np.arange(count)).reshape(-1, *[1] * (series.ndim - 1))


def statistics_of(series: np.ndarray) -> SeriesStatistics:
    """Mean, its standard error and the memory of every column of a series.

    A column with a value that is not finite has the mean that NumPy says, and nothing is known of its error: NaN. So it
    is of one value.

    Parameters
    ----------
    series : numpy.ndarray, shape (n, ...)
        Values one after the other, at least one.
    """
    series = np.asarray(series, dtype=float)
    count = series.shape[0]
    columns = series.reshape(count, -1)
    finite = np.isfinite(columns).all(axis=0)
    several = count > 1
    with np.errstate(invalid="ignore"):  # ∞ − ∞
        mean = np.mean(columns, axis=0)
    columns = np.where(finite, columns, 0.0)
    covariance = autocovariance(columns)
    # A constant column has a variance of its mean's rounding.
    varies = covariance[0] > (1e-14 * np.max(np.abs(columns), axis=0, initial=0.0)) ** 2
    variance = np.where(varies, covariance[0], 1.0)
    summed = np.cumsum(covariance / variance, axis=0) - 0.5
    window = np.arange(count)[:, None]
    enough = window >= _WINDOW * summed
    last = np.where(enough.any(axis=0), np.argmax(enough, axis=0), count - 1)
    time = np.take_along_axis(summed, last[None], axis=0)[0]
    time = np.maximum(time, 0.5)
    error = np.sqrt(covariance[0] * 2 * time / count)
    # 2(2W + 1)/n < 1
    told = (count >= LEAST_STATES) & (2 * (2 * last + 1) < count)
    resolved = finite & several & (~varies | told)
    time = np.where(varies, time, 0.5)
    shape = series.shape[1:]
    return SeriesStatistics(
        mean.reshape(shape),
        np.where(finite & several, np.where(varies, error, 0.0), np.nan).reshape(shape),
        np.where(finite, time, np.nan).reshape(shape),
        resolved.reshape(shape),
    )
