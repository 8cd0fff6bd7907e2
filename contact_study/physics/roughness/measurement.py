"""Power spectrum of one measurement, a map or a line scan, and the waves of it that can be relied on.

Measured heights do not meet at their edges. A Hann window on the differences of neighbouring heights, whose spectrum is
nearly flat, leaks less of the long waves than one on the heights; the division by |2 sin(qΔ/2)|² that follows is exact.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contact_study.physics.roughness.line_spectrum import isotropic_density

# Bands of every spectrum, at powers of 10^(1/10) (1/m), so that bands of different measurements meet.
BANDS_PER_DECADE = 10
# Waves on a scan below which levelling and window change a spectrum; points a wave below which others are aliased.
LONGEST, SAMPLED = 3, 4
# Share of a tip's curvature up to which peaks are the surface's: Sanner et al. (2022), from synthetic scans.
_BLUNT = 0.5
# Correlation of the powers of waves one and two apart under a Hann window.
_HANN = 4 / 9, 1 / 36
# In the order of the flags of a dataset.
REASONS = (
    "reliable",
    f"fewer than {LONGEST} waves on the scan",
    f"fewer than {SAMPLED} points a wave",
    "instrument resolution",
    "tip radius",
)


@dataclass(frozen=True)
class Measurement:
    """Heights of a part of a surface and the instrument that measured them.

    Parameters
    ----------
    name : str
        Name in messages and figures.
    heights : numpy.ndarray, shape (y, x) or (x,)
        Map or line scan without missing heights (m).
    spacing : tuple of float
        Grid spacing along each axis (m).
    tip_radius, resolution : float, optional
        Radius of a probe's tip; shortest wavelength that the instrument resolves (m).
    periodic : bool, optional
        Whether the heights continue over their edges, as made ones do: no window, no wave left out as too long.
    instrument, source, doi : str, optional
        Instrument, SHA-256 of the file, digital object identifier.

    Examples
    --------
    >>> import numpy as np
    >>> from contact_study.physics.roughness.measurement import Measurement, spectrum_of_measurement
    >>> heights = 1e-9 * np.random.default_rng(1).standard_normal(1000).cumsum()
    >>> found = spectrum_of_measurement(Measurement("stylus", heights, (1e-7,), resolution=2e-6))
    >>> found.limit, float(found.shortest)
    ('instrument resolution', 2e-06)
    """

    name: str
    heights: np.ndarray
    spacing: tuple[float, ...]
    tip_radius: float | None = None
    resolution: float | None = None
    periodic: bool = False
    instrument: str = ""
    source: str = ""
    doi: str = ""

    @property
    def window(self) -> str:
        return "none" if self.periodic else "Hann, on differences"

    @property
    def kind(self) -> str:
        return "map" if self.heights.ndim == 2 else "line scan"


class Bands(NamedTuple):
    """A spectrum in bands."""

    wavevector: np.ndarray  # geometric mean of the waves of each band (1/m)
    density: np.ndarray  # 2-D C (m⁴), of a line scan 1-D C (m³) before its conversion
    variance: np.ndarray  # statistical, of ln C
    reason: np.ndarray  # index into REASONS


@dataclass(frozen=True)
class MeasuredSpectrum:
    """Isotropic 2-D spectrum of a measurement, with the shortest reliable wavelength (m) and what limits it."""

    measurement: Measurement
    bands: Bands
    shortest: float
    limit: str

    @property
    def reliable(self) -> Bands:
        return Bands(*(values[self.bands.reason == 0] for values in self.bands))


def spectrum_of_measurement(measurement: Measurement, rule: str = "abel") -> MeasuredSpectrum:
    """Calculate the isotropic 2-D power spectrum of a map or a line scan and what of it is reliable.

    Parameters
    ----------
    measurement : Measurement
        Heights and instrument.
    rule : {"abel", "approximate"}, optional
        Conversion of a line scan: inverse Abel transform, or C = C_1D / 2q, which for H = 0.8 is 15 % too low.

    Returns
    -------
    MeasuredSpectrum

    Examples
    --------
    See :class:`Measurement`.
    """
    q, density, waves = _waves(measurement)
    shortest, limit = _shortest(measurement)
    reason = np.where(q > 2 * np.pi / shortest * (1 + 1e-9), limit, 0)
    side = min(n * step for n, step in zip(measurement.heights.shape, measurement.spacing, strict=True))
    if not measurement.periodic:
        reason[q < LONGEST * 2 * np.pi / side * (1 - 1e-9)] = 1
    bands = _banded(q, density, waves, reason, None if measurement.periodic else side, measurement.heights.ndim)
    if measurement.heights.ndim == 1:
        bands = _isotropic(bands, rule)
    return MeasuredSpectrum(measurement, bands, shortest, REASONS[limit])


def tip_cutoff(heights: np.ndarray, spacing: float, radius: float) -> float:
    """Find the length below which a spherical tip's shape, not the surface's, may be in a scan along the last axis.

    The sharpest peak h''(ℓ) < 0 of the second difference on a stencil of length ℓ cannot be sharper than the tip; the
    scan is reliable from the ℓ on where it has half of the tip's curvature 1/R. Source: A. Sanner, W. G. Nöhring,
    L. A. Thimons, T. D. B. Jacobs, L. Pastewka, Appl. Surf. Sci. Adv. 7, 100190 (2022).

    Parameters
    ----------
    heights : numpy.ndarray, shape (..., x)
        Line scan, or map whose last axis is the fast one (m).
    spacing, radius : float
        Grid spacing along the last axis and radius of the tip (m).

    Returns
    -------
    float
        Stencil length (m): zero without a trace of the tip, the scan's length if no length is free of it.

    Examples
    --------
    >>> import numpy as np
    >>> from contact_study.physics.roughness.measurement import tip_cutoff
    >>> tip_cutoff(np.abs(np.arange(-50, 51.0)) * -1e-9, 1e-9, 10e-9)
    4e-08
    """

    def blunt(step: int) -> bool:
        second = heights[..., 2 * step :] - 2 * heights[..., step:-step] + heights[..., : -2 * step]
        return -second.min() <= _BLUNT / radius * (step * spacing) ** 2 * (1 + 1e-9)

    points = heights.shape[-1]
    if blunt(1):
        return 0.0
    sharp, reliable = 1, max(points // 4, 2)
    if points < 2 * reliable + 1 or not blunt(reliable):
        return points * spacing
    while reliable - sharp > 1:
        middle = (sharp + reliable) // 2
        sharp, reliable = (sharp, middle) if blunt(middle) else (middle, reliable)
    return 2 * reliable * spacing


def _shortest(measurement: Measurement) -> tuple[float, int]:
    """Shortest reliable wavelength (m) and what limits it, an index into REASONS."""
    limits = {2: SAMPLED * max(measurement.spacing), 3: measurement.resolution or 0.0}
    if measurement.tip_radius is not None:
        limits[4] = tip_cutoff(measurement.heights, measurement.spacing[-1], measurement.tip_radius)
    limit = max(limits, key=lambda reason: limits[reason])
    return limits[limit], limit


def _waves(measurement: Measurement) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Wavevector (1/m), C (m³ of a line, m⁴ of a map) and independent amplitudes of every wave but the mean."""
    heights, steps = measurement.heights - measurement.heights.mean(), measurement.spacing
    axes = range(heights.ndim)
    fields = [heights]
    if not measurement.periodic:
        inner = (slice(None, -1),) * heights.ndim
        fields = [np.diff(heights, axis=axis)[(*inner[:axis], slice(None), *inner[axis + 1 :])] for axis in axes]
        window = np.ones(())
        for points in fields[0].shape:
            hann = np.sin(np.pi * (np.arange(points) + 0.5) / points) ** 2
            window = window[..., None] * (hann / np.sqrt(np.mean(hann**2)))
        fields = [field * window for field in fields]
    shape = fields[0].shape
    frequencies = [*map(np.fft.fftfreq, shape[:-1]), np.fft.rfftfreq(shape[-1])]
    places = np.meshgrid(*frequencies, indexing="ij", sparse=True)
    q = np.sqrt(sum((2 * np.pi * place / step) ** 2 for place, step in zip(places, steps, strict=True)))
    power = sum(np.abs(np.fft.rfftn(field)) ** 2 for field in fields)
    if not measurement.periodic:
        with np.errstate(divide="ignore", invalid="ignore"):  # the mean is 0/0
            power = power / sum(4 * np.sin(np.pi * place) ** 2 for place in places)
    density = power * np.prod(np.array(steps) / (2 * np.pi)) / np.prod(shape)
    waves = np.ones(q.shape)  # each stands for its conjugate, too
    waves[..., 0] = 0.5
    if shape[-1] % 2 == 0:
        waves[..., -1] = 0.5
    there = q > 0
    return q[there], density[there], waves[there]


def _banded(
    q: np.ndarray, density: np.ndarray, waves: np.ndarray, reason: np.ndarray, side: float | None, dimensions: int
) -> Bands:
    """Average waves over bands, those that are reliable by themselves; ``side`` (m) is that of the window, if any."""
    from scipy.special import digamma, polygamma  # slow to import

    _, index = np.unique(np.stack([band_of(q), reason]), axis=1, return_inverse=True)
    index = index.ravel()
    count, sums, logarithms = (np.bincount(index, weights) for weights in (waves, waves * density, waves * np.log(q)))
    correlated = np.ones(count.size)
    if side is not None:
        first, last = np.full(count.size, np.inf), np.zeros(count.size)
        np.minimum.at(first, index, q)
        np.maximum.at(last, index, q)
        width = 1 + (last - first) * side / (2 * np.pi)
        beside = sum(2 * share * np.maximum(1 - apart / width, 0) for apart, share in enumerate(_HANN, 1))
        correlated = (1 + beside) * (1 + 2 * sum(_HANN)) ** (dimensions - 1)
    kept = np.zeros(count.size, dtype=int)
    kept[index] = reason
    independent = np.maximum(count / correlated, 1.0)
    with np.errstate(divide="ignore"):  # of a flat scan
        # ln of a mean of exponentially distributed powers is lower than ln C by ln n − ψ(n), of variance ψ'(n).
        log = np.log(sums / count) + np.log(independent) - digamma(independent)
    bands = Bands(np.exp(logarithms / count), np.exp(log), polygamma(1, independent), kept)
    order = np.argsort(bands.wavevector)
    return Bands(*(values[order] for values in bands))


def band_of(wavevector: np.ndarray) -> np.ndarray:
    """Number of the band of a wavevector (1/m)."""
    return np.floor(BANDS_PER_DECADE * np.log10(wavevector) + 1e-9).astype(int)


def _isotropic(bands: Bands, rule: str) -> Bands:
    """Convert bands of a line scan; those that are not reliable by the factor of the nearest one that is."""
    known = bands.reason == 0
    q, density, variance = (values[known] for values in bands[:3])
    if not q.size:
        return bands
    ratio = np.full(q.size, 0.5)
    if rule == "abel" and q.size > 2 and np.all(density > 0):
        ratio = isotropic_density(q, density, variance) * q / density
    factor = np.interp(np.log(bands.wavevector), np.log(q), ratio) / bands.wavevector
    # The less of C_1D at a q comes from C near q, as in front of a roll-off, the more its error becomes.
    variance = bands.variance * np.maximum(0.5 / (factor * bands.wavevector), 1.0) ** 2
    return bands._replace(density=bands.density * factor, variance=variance)
