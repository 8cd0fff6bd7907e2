"""Description of a surface: its moments, its power spectrum and the self-affine law that fits it best."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps import preparation
from contact_study.physics.roughness.power_law import BANDS_PER_OCTAVE, PowerSpectrum, SelfAffineFit, self_affine_fit

# Ratio of the jump across an edge to the difference of neighbouring lines up to which a map is periodic: scatter leaves
# rarely more, and a jump of so much is a hundredth of the mean square slope of 400 lines.
PERIODIC = 2.0


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
    made_by : tuple of float or None
        Roll-off and cutoff of the self-affine law that it was made by (1/m).
    between : PowerSpectrum or None
        Spectrum of the waves between these.
    """

    grid: Grid
    rms_height: float
    rms_slope: float
    rms_curvature: float
    edge_jump: float
    edge_ratio: float
    spectrum: PowerSpectrum
    made_by: tuple[float, float] | None = None
    between: PowerSpectrum | None = None

    @cached_property
    def fit(self) -> SelfAffineFit | None:
        """The self-affine law that fits best; None for a spectrum of too few octaves."""
        if self.between is not None:
            return self_affine_fit(self.between, self.made_by)
        return self_affine_fit(self.spectrum)

    @property
    def noise(self) -> tuple[float, float]:
        """Power of q in C for waves shorter than four points, and their fraction of the mean square slope.

        Noise of single pixels is white, power 0; a self-affine surface has −2 to −4. The result is −∞ and 0 below four
        octaves, where short waves may be all of the surface.
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
    power = grid.variances(fourier.transform(heights))
    q = grid.wavenumber
    waves = np.broadcast_to(grid.multiplicity, q.shape)
    jumps, inside = [], []
    for axis in range(2):
        first, last = np.take(heights, [0, -1], axis=axis).swapaxes(0, axis)
        jumps.append(float(np.sqrt(np.mean((first - last) ** 2))))
        inside.append(float(np.sqrt(np.mean(np.diff(heights, axis=axis) ** 2))))
    # Rounding along an axis without height is no jump.
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
        _power_spectrum(power, q, waves, grid),
        made_by,
        None if made_by is None else _power_spectrum(power, q, waves, grid, *made_by),
    )


def roughness_of_sample(heights: np.ndarray, grid: Grid, shortest: float | None = None) -> Roughness:
    """Describe heights (m) of a part of a larger surface, such as a measured map, without waves below ``shortest``.

    A jump across edges that do not meet would be most of the slope, and C ∝ q⁻³ of it most of the spectrum. Slope,
    curvature and spectrum are then those of the map joined to its mirror images, the latter two without its mean plane,
    by the discrete cosine transform. A map whose edges meet is described as it is.
    """
    whole = roughness_of(heights, grid)
    if whole.edge_ratio <= PERIODIC:
        return whole if shortest is None else roughness_of(preparation.lowpassed(heights, grid, shortest), grid)
    axes = (np.pi / side * np.arange(n) for side, n in zip(grid.size, grid.shape, strict=True))
    q_y, q_x = np.meshgrid(*axes, indexing="ij", sparse=True)
    q = np.hypot(q_y, q_x)
    kept = q <= (np.inf if shortest is None else 2 * np.pi / shortest * (1 + 1e-9))
    own, level = (_cosines(part) * kept for part in (heights, preparation.detrended(heights, 1)))
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


def _cosines(heights: np.ndarray) -> np.ndarray:
    """Mean square of each cosine of a map joined to its mirror images; its mean has none."""
    from scipy.fft import dctn

    variances = dctn(heights, norm="ortho") ** 2 / heights.size
    variances[0, 0] = 0.0
    return variances


def _power_spectrum(
    power: np.ndarray, q: np.ndarray, waves: np.ndarray, grid: Grid, lowest: float = 0.0, highest: float = np.inf
) -> PowerSpectrum:
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
