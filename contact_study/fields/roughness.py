"""What a surface is like: its moments, its power spectrum and the self-affine law that fits it best.

The spectrum has the convention of :mod:`contact_study.fields.spectrum`, h_rms² = 2π ∫ q C dq.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.fields import fourier
from contact_study.fields.grid import Grid

BANDS_PER_OCTAVE = 8
_HURST = np.linspace(0.0, 1.0, 101)
_TAIL_POWERS = np.linspace(0.0, 8.0, 33)
# A self-affine range is nothing below an octave.
_SHORTEST_RANGE = BANDS_PER_OCTAVE


@dataclass(frozen=True)
class PowerSpectrum:
    """Radial average of a power spectrum, in bands of an eighth of an octave; bands without a wave are left out.

    Attributes
    ----------
    wavevectors : numpy.ndarray, shape (n,)
        Root-mean-square |q| of the waves of each band, up to the Nyquist wavevector of the coarser axis (1/m).
    density : numpy.ndarray, shape (n,)
        C (m⁴).
    waves : numpy.ndarray, shape (n,)
        Waves in each band, of both signs.
    """

    wavevectors: np.ndarray
    density: np.ndarray
    waves: np.ndarray


@dataclass(frozen=True)
class SelfAffineFit:
    """A self-affine spectrum: flat up to the roll-off, C ∝ q^(−2−2H) from there to the cutoff.

    Attributes
    ----------
    hurst_exponent : float
        H.
    roll_off, cutoff : float
        Wavevectors (1/m); the ends of the spectrum where it shows none.
    density : float
        C at and below the roll-off (m⁴).
    """

    hurst_exponent: float
    roll_off: float
    cutoff: float
    density: float


@dataclass(frozen=True)
class Roughness:
    """A periodic surface as numbers.

    Attributes
    ----------
    grid : Grid
        Its points.
    rms_height : float
        About the mean (m).
    rms_slope : float
        √<|∇h|²> of the trigonometric polynomial through the points.
    rms_curvature : float
        Root mean square of its mean curvature, √<(∇²h)²>/2 (1/m).
    edge_jump : float
        Root-mean-square difference of heights across that edge of the cell where it is larger (m).
    edge_ratio : float
        The largest ratio of such a difference to that of neighbouring rows or columns inside.
    spectrum : PowerSpectrum
        Its spectrum.
    """

    grid: Grid
    rms_height: float
    rms_slope: float
    rms_curvature: float
    edge_jump: float
    edge_ratio: float
    spectrum: PowerSpectrum

    @cached_property
    def fit(self) -> SelfAffineFit | None:
        """The self-affine law that fits best; None for a spectrum of less than two octaves."""
        return self_affine_fit(self.spectrum)

    @property
    def noise(self) -> tuple[float, float]:
        """Of the waves shorter than four points: the power of q in C, and their share in the mean square slope.

        Noise of single pixels is white, power 0; a self-affine surface has −2 to −4. Of less than four octaves, in
        which short waves may be all that there is, nothing is said: −∞ and 0.
        """
        q, density, waves = self.spectrum.wavevectors, self.spectrum.density, self.spectrum.waves
        slopes = q**2 * density * waves
        last = q > q[-1] / 2
        if slopes.sum() == 0 or q[-1] < 15.9 * q[0] or np.any(density[last] <= 0) or last.sum() < 2:
            return float("-inf"), 0.0
        power = np.polyfit(np.log(q[last]), np.log(density[last]), 1, w=np.sqrt(waves[last]))[0]
        return float(power), float(slopes[last].sum() / slopes.sum())


def roughness_of(heights: np.ndarray, grid: Grid) -> Roughness:
    """Describe heights (m) on a periodic grid."""
    power = grid.variances(fourier.transform(heights))
    q = grid.wavenumber
    jumps, inside = [], []
    for axis in range(2):
        first, last = np.take(heights, [0, -1], axis=axis).swapaxes(0, axis)
        jumps.append(float(np.sqrt(np.mean((first - last) ** 2))))
        inside.append(float(np.sqrt(np.mean(np.diff(heights, axis=axis) ** 2))))
    # Along an axis without any height of its own rounding is no jump.
    negligible = 1e-9 * float(np.ptp(heights))
    pairs = zip(jumps, inside, strict=True)
    ratios = [jump / max(step, negligible) if jump > negligible else 0.0 for jump, step in pairs]
    return Roughness(
        grid,
        float(np.sqrt(power.sum())),
        float(np.sqrt(np.sum(q**2 * power))),
        float(np.sqrt(np.sum(q**4 * power)) / 2),
        max(jumps),
        max(ratios),
        _power_spectrum(power, grid),
    )


def _power_spectrum(power: np.ndarray, grid: Grid) -> PowerSpectrum:
    q = grid.wavenumber
    counted = (q > 0) & (q <= np.pi / max(grid.spacing) * (1 + 1e-9))
    q, power = q[counted], power[counted]
    waves = np.broadcast_to(grid.multiplicity, counted.shape)[counted]
    band = np.floor(BANDS_PER_OCTAVE * np.log2(q / q.min()) + 1e-6).astype(int)
    count, height, slope = (np.bincount(band, weights) for weights in (waves, power, waves * q**2))
    there = count > 0
    cell = (2 * np.pi) ** 2 / (grid.size[0] * grid.size[1])  # area of a wave in the plane of wavevectors
    return PowerSpectrum(
        np.sqrt(slope[there] / count[there]), height[there] / (count[there] * cell), count[there].astype(int)
    )


def self_affine_fit(spectrum: PowerSpectrum) -> SelfAffineFit | None:
    """The self-affine law of largest likelihood, each wave's power being exponentially distributed about C.

    That is the distribution of |h_q|² on a Gaussian surface (Whittle's likelihood of a spectrum). Beyond the cutoff
    C is a power law of its own: next to nothing, the flat floor of a measurement, or what edges leave. Roll-off and
    cutoff are taken for real only where they raise the likelihood by more than their number asks for (Schwarz'
    criterion).

    Parameters
    ----------
    spectrum : PowerSpectrum
        The spectrum.

    Returns
    -------
    SelfAffineFit or None
        None if no two octaves of it have any power.
    """
    # Both signs of a wave are one observation.
    q, waves = spectrum.wavevectors, spectrum.waves / 2
    if q.size == 0 or spectrum.density.max() <= 0 or np.log2(q[-1] / q[0]) < 2:
        return None
    scale = spectrum.density.max()
    # What rounding of a transform leaves of nothing.
    power = np.maximum(spectrum.density / scale, 1e-30)
    penalty = 0.5 * np.log(waves.sum())
    tail = _tails(q, waves, power)
    best: tuple[float, tuple[float, int, int, float]] | None = None
    for start in range(q.size):
        shape = np.maximum(q / q[start], 1.0)[None, :] ** (-2 - 2 * _HURST[:, None])
        # Sums up to each end, of every H.
        number, level = np.cumsum(waves), np.cumsum(waves * power / shape, axis=1)
        curve = np.cumsum(waves * np.log(shape), axis=1)
        for end in range(start + _SHORTEST_RANGE, q.size):
            density = level[:, end] / number[end]
            cost = curve[:, end] + number[end] * (np.log(density) + 1) + penalty * (start > 0)
            partly = end + 1
            if partly < q.size:  # the band that the cutoff divides has a C of its own
                beyond = number[-1] - number[partly]
                cost = cost + waves[partly] * (np.log(power[partly]) + 1) + penalty
                cost = cost + (tail[partly + 1] + 2 * penalty if beyond else 0) + penalty
            least = int(np.argmin(cost))
            if best is None or cost[least] < best[0]:
                found = (float(_HURST[least]), start, end, float(density[least]))
                best = float(cost[least]), found
    if best is None:
        return None
    hurst, start, end, density = best[1]
    cutoff = q[end]
    if end + 1 < q.size:
        # As far into the divided band, by its area, as its C is that of the law.
        expected = density * max(q[end + 1] / q[start], 1.0) ** (-2 - 2 * hurst)
        inner = q[end] * q[end + 1]
        outer = q[end + 1] * q[end + 2] if end + 2 < q.size else q[end + 1] ** 2
        cutoff = np.sqrt(inner + min(power[end + 1] / expected, 1.0) * (outer - inner))
    return SelfAffineFit(hurst, float(q[start]), float(cutoff), float(density * scale))


def _tails(q: np.ndarray, waves: np.ndarray, power: np.ndarray) -> np.ndarray:
    """Least cost of a power law through all bands from each one on."""
    shape = (q / q[0])[None, :] ** -_TAIL_POWERS[:, None]
    number, level, curve = (
        np.cumsum(part[..., ::-1], axis=-1)[..., ::-1] for part in (waves, waves * power / shape, waves * np.log(shape))
    )
    return np.min(curve + number * (np.log(level / number) + 1), axis=0)
