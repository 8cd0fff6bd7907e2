"""One power spectrum of a surface from several measurements of it, with bounds."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.physics.roughness.measurement import BANDS_PER_DECADE, MeasuredSpectrum, band_of

# Bounds are so many standard errors away: 95 % of a normal distribution of ln C.
BOUNDS = 2.0


@dataclass(frozen=True)
class CombinedSpectrum:
    """C(q) of a surface in bands that some measurement covers, with what it was made from."""

    wavevectors: np.ndarray  # (1/m)
    density: np.ndarray  # C (m⁴)
    statistical_error: np.ndarray  # standard error of ln C by the number of independent waves
    error: np.ndarray  # that with the spread between measurements
    measurements: np.ndarray  # number of them in each band
    spread: float  # standard deviation of ln C between measurements beyond statistics, over all bands
    gaps: tuple[tuple[float, float], ...]  # wavevectors between which no measurement is reliable (1/m)
    parts: tuple[MeasuredSpectrum, ...]

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bound of C, two standard errors of ln C away (m⁴)."""
        factor = np.exp(BOUNDS * self.error)
        return self.density / factor, self.density * factor


def combine_spectra(parts: Sequence[MeasuredSpectrum]) -> CombinedSpectrum:
    """Average ln C over measurements, each by its independent waves as far as measurements agree.

    The weights are 1/(σ² + τ²) with the statistical variance σ² of each and one variance τ² between measurements for
    all bands, by the method of moments (R. DerSimonian, N. Laird, Meta-analysis in clinical trials, 1986). It keeps a
    map of a million points from outvoting all others, and widens bands of a single measurement by what measurements
    differ elsewhere. Where measurements differ by more than that, the error of the band is their scatter.

    Parameters
    ----------
    parts : sequence of MeasuredSpectrum
        Spectra of measurements of one surface.

    Returns
    -------
    CombinedSpectrum

    Raises
    ------
    InputError
        If less than two bands are reliable.

    Examples
    --------
    >>> from contact_study.physics.roughness.combination import combine_spectra
    >>> combine_spectra([spectrum_of_measurement(one) for one in measurements]).bounds  # doctest: +SKIP
    """
    tables = [part.reliable for part in parts]
    q, density, variance = (np.concatenate([table[column] for table in tables]) for column in range(3))
    there = density > 0
    x, y, variance = np.log(q[there]), np.log(density[there]), variance[there]
    numbers, band, count = np.unique(band_of(q[there]), return_inverse=True, return_counts=True)
    if numbers.size < 2:
        raise InputError("no two bands of wavevectors are reliable in any measurement; see their resolution and tip")

    def mean(values: np.ndarray, weight: np.ndarray) -> np.ndarray:
        return np.bincount(band, weight * values) / np.bincount(band, weight)

    weight = 1 / variance
    centre, level = mean(x, weight), mean(y, weight)
    # Measurements have other waves in a band: they are compared at one wavevector, along the common slope, H = −1 to 1.
    at_centre = y - np.clip(np.gradient(level, centre), -4.0, 0.0)[band] * (x - centre[band])

    def misfit(weight: np.ndarray) -> np.ndarray:
        return np.bincount(band, weight * (at_centre - mean(at_centre, weight)[band]) ** 2)

    total, squares = np.bincount(band, weight), np.bincount(band, weight**2)
    freedom = float(np.sum(count - 1))
    between = 0.0
    if freedom:
        between = max(0.0, float((misfit(weight).sum() - freedom) / np.sum(total - squares / total)))
    weight = 1 / (variance + between)
    scatter = np.maximum(misfit(weight) / np.maximum(count - 1, 1), 1.0)
    error = np.sqrt(scatter / np.bincount(band, weight))
    return CombinedSpectrum(
        np.exp(mean(x, weight)),
        np.exp(mean(y, weight)),
        1 / np.sqrt(total),
        error,
        count,
        float(np.sqrt(between)),
        uncovered([(table.wavevector[0], table.wavevector[-1]) for table in tables if table.wavevector.size]),
        tuple(parts),
    )


def uncovered(ranges: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Find the gaps, wider than a band, that ranges of wavevectors leave between them (1/m)."""
    gaps, reached = [], min(low for low, _ in ranges)
    for low, high in sorted(ranges):
        if low > reached * 10 ** (1 / BANDS_PER_DECADE):
            gaps.append((float(reached), float(low)))
        reached = max(reached, high)
    return tuple(gaps)
