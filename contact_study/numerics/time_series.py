"""Means of correlated series and their errors.

The error of a mean over n values of autocorrelation time τ is that of n/(2τ) independent ones. τ = ½ + Σ ρ(t) is
summed up to a window W of five times itself; its standard error is √(2(2W + 1)/n) τ (A. D. Sokal, in "Functional
Integration: Basics and Applications", 1997).
"""

from dataclasses import dataclass

import numpy as np

_WINDOW = 5.0

# With fewer values the standard error of τ exceeds half of τ even for the shortest window.
LEAST_STATES = 50


@dataclass(frozen=True)
class SeriesStatistics:
    """Mean of every column of a series, its error, and τ in steps, ½ where the values are independent or all equal.

    Resolved: ``LEAST_STATES`` values whose τ exceeds its standard error, as of twenty τ; two values that are all equal.
    """

    mean: np.ndarray
    standard_error: np.ndarray
    autocorrelation_time: np.ndarray
    resolved: np.ndarray


def autocovariance(series: np.ndarray) -> np.ndarray:
    """Calculate Γ(t) = 1/(n − t) Σ δ_i δ_{i+t}, t = 0 … n − 1, δ the deviation from a column's mean."""
    count = series.shape[0]
    deviation = series - np.mean(series, axis=0)
    spectrum = np.fft.rfft(deviation, 2 * count, axis=0)  # twice the length: the ends do not meet
    sums = np.fft.irfft(np.abs(spectrum) ** 2, 2 * count, axis=0)[:count]
    return sums / (count - np.arange(count)).reshape(-1, *[1] * (series.ndim - 1))


def statistics_of(series: np.ndarray) -> SeriesStatistics:
    """Calculate the statistics of every column of a series, shape (n, ...); errors of one value are NaN."""
    series = np.asarray(series, dtype=float)
    count = series.shape[0]
    columns = series.reshape(count, -1)
    finite = np.isfinite(columns).all(axis=0)
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
    time = np.maximum(np.take_along_axis(summed, last[None], axis=0)[0], 0.5)
    error = np.where(varies, np.sqrt(covariance[0] * 2 * time / count), 0.0)
    told = (count >= LEAST_STATES) & (2 * (2 * last + 1) < count)  # 2(2W + 1)/n < 1
    known = finite & (count > 1)
    time = np.where(finite, np.where(varies, time, 0.5), np.nan)
    found = mean, np.where(known, error, np.nan), time, known & (~varies | told)
    return SeriesStatistics(*(each.reshape(series.shape[1:]) for each in found))
