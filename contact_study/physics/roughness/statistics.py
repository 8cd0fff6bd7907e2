"""Description of a surface: its moments, its power spectrum and the self-affine law that fits it best."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps import preparation

# Ratio of the jump across an edge to the difference of neighbouring lines up to which a map is periodic, by scatter.
PERIODIC = 2.0
BANDS_PER_OCTAVE = 8
# Powers of q in C from 0 to −6; a self-affine surface has H from 0 to 1, noise and filters make others.
_HURST = np.linspace(-1.0, 2.0, 301)
_TAIL_POWERS = np.linspace(0.0, 8.0, 33)
# A self-affine range is nothing below an octave.
_SHORTEST_RANGE = BANDS_PER_OCTAVE
# Relative departure of C of a real surface from any law, lest thousands of waves of the shortest bands decide alone.
_DEPARTURE = 0.1


@dataclass(frozen=True)
class PowerSpectrum:
    """Radial average of a power spectrum, in bands of an eighth of an octave; bands without a wave are left out."""

    wavevectors: np.ndarray  # rms |q| of the waves of each band, up to the Nyquist wavevector of the coarser axis (1/m)
    density: np.ndarray  # C (m⁴)
    waves: np.ndarray  # independent amplitudes in each band: two a pair of waves of both signs


@dataclass(frozen=True)
class SelfAffineFit:
    """A self-affine spectrum: flat up to the roll-off, C ∝ q^(−2−2H) from there to the cutoff."""

    hurst_exponent: float  # outside 0 to 1 the spectrum is flatter or steeper than that of any self-affine surface
    uncertainty: float  # its standard deviation
    roll_off: float  # wavevectors (1/m) between which it was fitted
    cutoff: float
    density: float  # C at and below the roll-off (m⁴)


@dataclass(frozen=True)
class Roughness:
    """A periodic surface as numbers, derivatives those of the trigonometric polynomial through its points."""

    grid: Grid
    rms_height: float  # about the mean (m)
    rms_slope: float  # √<|∇h|²>
    rms_curvature: float  # of the mean curvature, √<(∇²h)²>/2 (1/m)
    edge_jump: float  # rms difference of heights across that edge of the cell where it is larger (m)
    edge_ratio: float  # largest ratio of such a difference to that of neighbouring rows or columns inside
    spectrum: PowerSpectrum
    made_by: tuple[float, float] | None = None  # roll-off and cutoff of the self-affine law that it was made by (1/m)
    between: PowerSpectrum | None = None  # spectrum of the waves between these
    alone: "Roughness | None" = None  # of a measured map before its edges were joined or faded
    filled: float = 0.0  # fraction of the points of a measured map that were missing

    @property
    def sample(self) -> "Roughness":
        """The same without the effect of the edges of a measured map."""
        return self.alone or self

    @cached_property
    def fit(self) -> SelfAffineFit | None:
        """The self-affine law that fits best; None for a spectrum of too few octaves."""
        return self_affine_fit(self.between or self.spectrum, self.made_by)

    @property
    def noise(self) -> tuple[float, float]:
        """Power of q in C for waves shorter than four points, and their fraction of the mean square slope.

        Noise of single pixels has power 0, a self-affine surface −2 to −4. Below four octaves −∞ and 0: no statement.
        """
        q, density, waves = self.spectrum.wavevectors, self.spectrum.density, self.spectrum.waves
        slopes = q**2 * density * waves
        last = q > q[-1] / 2
        if slopes.sum() == 0 or q[-1] < 15.9 * q[0] or np.any(density[last] <= 0) or last.sum() < 2:
            return float("-inf"), 0.0
        power = np.polyfit(np.log(q[last]), np.log(density[last]), 1, w=np.sqrt(waves[last]))[0]
        return float(power), float(slopes[last].sum() / slopes.sum())


def roughness_of(heights: np.ndarray, grid: Grid, made_by: tuple[float, float] | None = None) -> Roughness:
    """Describe heights (m) on a periodic grid; ``made_by`` are roll-off and cutoff of their self-affine law (1/m)."""
    power, q = grid.variances(fourier.transform(heights)), grid.wavenumber
    waves = np.broadcast_to(grid.multiplicity, q.shape)
    negligible = 1e-9 * float(np.ptp(heights))  # rounding along an axis without height is no jump
    jumps, ratios = [], []
    for axis in range(2):
        first, last = np.take(heights, [0, -1], axis=axis).swapaxes(0, axis)
        jumps.append(float(np.sqrt(np.mean((first - last) ** 2))))
        inside = max(float(np.sqrt(np.mean(np.diff(heights, axis=axis) ** 2))), negligible)
        ratios.append(jumps[-1] / inside if jumps[-1] > negligible else 0.0)
    return Roughness(
        grid,
        float(np.sqrt(power.sum())),
        float(np.sqrt(np.sum(q**2 * power))),
        float(np.sqrt(np.sum(q**4 * power)) / 2),
        max(jumps),
        max(ratios),
        _power_spectrum(power, q, waves, grid),
        made_by,
        None if made_by is None else _power_spectrum(power, q, waves, grid, *made_by),
    )


def roughness_of_sample(heights: np.ndarray, grid: Grid, shortest: float | None = None) -> Roughness:
    """Describe heights (m) of a part of a larger surface, such as a measured map, without waves below ``shortest``.

    A jump across edges would be most of the slope and of the spectrum. Without periodic edges, slope, curvature and
    spectrum are those of the map joined to its mirror images, the latter two without its plane (discrete cosines).
    """
    whole = roughness_of(heights, grid)
    if whole.edge_ratio <= PERIODIC:
        return whole if shortest is None else roughness_of(preparation.lowpassed(heights, grid, shortest), grid)
    from scipy.fft import dctn  # slow to import

    axes = (np.pi / side * np.arange(n) for side, n in zip(grid.size, grid.shape, strict=True))
    q_y, q_x = np.meshgrid(*axes, indexing="ij", sparse=True)
    q = np.hypot(q_y, q_x)
    kept = q <= (np.inf if shortest is None else 2 * np.pi / shortest * (1 + 1e-9))
    images = (dctn(part, norm="ortho") ** 2 / part.size for part in (heights, preparation.detrended(heights, 1)))
    own, level = (variances * (kept & (q > 0)) for variances in images)
    # One amplitude is four waves of the mirrored map, along an axis two.
    waves = np.where((q_y == 0) | (q_x == 0), 0.5, 1.0)
    return replace(
        whole,
        rms_height=float(np.sqrt(own.sum())),
        rms_slope=float(np.sqrt(np.sum(q**2 * own))),
        rms_curvature=float(np.sqrt(np.sum(q**4 * level)) / 2),
        # Longer waves are those of the plane.
        spectrum=_power_spectrum(level, q, waves, grid, 2 * np.pi / min(grid.size)),
    )


def _power_spectrum(power, q, waves, grid, lowest=0.0, highest=np.inf):
    """Bands of the amplitudes of mean squares ``power`` from a lowest to a highest wavevector."""
    highest = min(highest, np.pi / max(grid.spacing))
    counted = (q > 0) & (q >= lowest * (1 - 1e-9)) & (q <= highest * (1 + 1e-9))
    q, power, waves = q[counted], power[counted], waves[counted]
    if not q.size:
        return PowerSpectrum(*np.empty((3, 0)))
    band = np.floor(BANDS_PER_OCTAVE * np.log2(q / q.min()) + 1e-6).astype(int)
    count, height, slope = (np.bincount(band, weights) for weights in (waves, power, waves * q**2))
    there = count > 0
    cell = (2 * np.pi) ** 2 / (grid.size[0] * grid.size[1])  # area of a wave in the plane of wavevectors
    return PowerSpectrum(np.sqrt(slope[there] / count[there]), height[there] / (count[there] * cell), count[there])


def law_through(
    spectrum: PowerSpectrum, hurst_exponent: float, uncertainty: float, roll_off: float, cutoff: float
) -> SelfAffineFit:
    """A law of these constants at the level of a spectrum."""
    q = spectrum.wavevectors
    weight = _weights(spectrum) * (q <= cutoff)
    shape = np.maximum(q / roll_off, 1.0) ** (-2 - 2 * hurst_exponent)
    level = float(np.sum(weight * spectrum.density / shape) / np.sum(weight))
    return SelfAffineFit(hurst_exponent, uncertainty, roll_off, cutoff, level)


def self_affine_fit(spectrum: PowerSpectrum, limits: tuple[float, float] | None = None) -> SelfAffineFit | None:
    """Fit the self-affine law of a spectrum by Whittle's likelihood; None for less than an octave (two) or no power.

    A band counts as no more waves than its C is known by (``_DEPARTURE``), beyond the cutoff C is another power law.
    Limits (1/m) that are not given are the likeliest, where Schwarz' criterion takes them for real. H and its
    uncertainty are mean and deviation over all limits, the likelihood widened by its deviance over degrees of freedom.
    """
    q, known = spectrum.wavevectors, limits is not None
    octaves = 1 if known else 2
    if q.size <= _SHORTEST_RANGE or spectrum.density.max() <= 0 or np.log2(q[-1] / q[0]) < octaves * (1 - 1e-9):
        return None
    waves = _weights(spectrum)
    # What rounding of a transform leaves of nothing.
    power = np.maximum(spectrum.density / spectrum.density.max(), 1e-30)
    own = waves * (np.log(power) + 1)  # cost of bands that no law covers
    number, tail = np.cumsum(waves), _tails(q, waves, power)
    penalty = 0.5 * np.log(number[-1])
    tried, costs = [], []
    for start in range(1 if known else q.size - _SHORTEST_RANGE):
        shape = np.maximum(q / q[start], 1.0)[None, :] ** (-2 - 2 * _HURST[:, None])
        # Sums up to each end, of every H.
        level, curve = np.cumsum(waves * power / shape, axis=1), np.cumsum(waves * np.log(shape), axis=1)
        for end in range(q.size - 1 if known else start + _SHORTEST_RANGE, q.size):
            cost = curve[:, end] + number[end] * (np.log(level[:, end] / number[end]) + 1) + penalty * (start > 0)
            if end + 1 < q.size:  # the cutoff divides a band, which no law covers
                cost = cost + own[end + 1] + 2 * penalty
            if end + 2 < q.size:
                cost = cost + tail[end + 2] + 2 * penalty
            tried.append((start, end))
            costs.append(cost)
    cost = np.stack(costs)
    misfit = max(2 * (cost.min() - own.sum()) / max(q.size - (2 if known else 4), 1), 1.0)
    likelihood = np.exp((cost.min() - cost) / misfit)
    likelihood /= likelihood.sum()
    hurst = float(np.sum(likelihood * _HURST))
    spread = float(np.sqrt(np.sum(likelihood * (_HURST - hurst) ** 2)))
    if limits is not None:
        return law_through(spectrum, hurst, spread, *limits)
    start, end = tried[int(np.argmin(cost.min(axis=1)))]
    found = law_through(spectrum, hurst, spread, float(q[start]), float(q[end]))
    # Squares of the wavevectors that part bands, of the last band by its mean square.
    outer = np.append(q[:-1] * q[1:], 2 * q[-1] ** 2 - q[-2] * q[-1])
    cutoff = outer[end]
    if end + 1 < q.size:
        # As far into the divided band, by its area, as its C is that of the law.
        share = spectrum.density[end + 1] / (found.density * (q[end + 1] / q[start]) ** (-2 - 2 * hurst))
        cutoff += min(share, 1.0) * (outer[end + 1] - outer[end])
    return replace(found, cutoff=float(np.sqrt(cutoff)))


def _weights(spectrum: PowerSpectrum) -> np.ndarray:
    """Observations that a band counts as: pairs of amplitudes, up to 1/``_DEPARTURE``²."""
    pairs = spectrum.waves / 2
    return pairs / (1 + pairs * _DEPARTURE**2)


def _tails(q: np.ndarray, waves: np.ndarray, power: np.ndarray) -> np.ndarray:
    """Least cost of a power law through all bands from each one on."""
    shape = (q / q[0])[None, :] ** -_TAIL_POWERS[:, None]
    number, level, curve = (
        np.cumsum(part[..., ::-1], axis=-1)[..., ::-1] for part in (waves, waves * power / shape, waves * np.log(shape))
    )
    return np.min(curve + number * (np.log(level / number) + 1), axis=0)
