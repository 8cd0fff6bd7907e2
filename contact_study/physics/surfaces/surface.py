"""The rigid surface of a case: one height function, which each model samples on its own points, and its scales."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps import preparation
from contact_study.physics.height_maps.height_map import HeightMap
from contact_study.physics.roughness.spectrum import (
    RadialSpectrum,
    RoughnessSpectrum,
    SelfAffineSpectrum,
    radial_spectrum,
)
from contact_study.physics.roughness.statistics import Roughness, roughness_of, roughness_of_sample
from contact_study.physics.solids import Elasticity

# Mean number of places per surface that stand higher, or lie lower, than the peak-to-valley height allows for.
_RARE = 0.01
_DEGREES = {"mean": 0, "tilt": 1, "curvature": 2}


@dataclass(frozen=True)
class Surface(ABC):
    """A periodic height function of zero mean, toward the block."""

    size: tuple[float, float]  # periods along y and x (m)
    shape: tuple[int, int]  # points of the continuum grid
    spectrum: RoughnessSpectrum | None  # target of a random one

    @abstractmethod
    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        """Heights of this surface on a grid of the given shape (m)."""

    @property
    def grid(self) -> Grid:
        return Grid(self.shape, self.size)

    @cached_property
    def sampled(self) -> np.ndarray:
        """Heights on the continuum grid, made once (m)."""
        return self.heights(self.shape)

    @property
    def rms_height(self) -> float:
        """Root-mean-square height of this surface on the continuum grid (m)."""
        return float(np.sqrt(np.mean(self.sampled**2)))

    @property
    def rms_slope(self) -> float:
        """√<|∇h|²> of the trigonometric interpolant on the continuum grid."""
        power = self.grid.variances(fourier.transform(self.sampled))
        return float(np.sqrt(np.sum(self.grid.wavenumber**2 * power)))

    @cached_property
    def roughness(self) -> Roughness:
        """Description of this surface on the continuum grid, of a measured one on the grid of its map."""
        target = self.spectrum
        made_by = (target.roll_off, target.cutoff) if isinstance(target, SelfAffineSpectrum) else None
        return roughness_of(self.sampled, self.grid, made_by)

    def measured_spectrum(self) -> RadialSpectrum:
        """Radial spectrum of this very surface."""
        return radial_spectrum(self.sampled, self.grid)


@dataclass(frozen=True)
class BandLimitedSurface(Surface):
    """A trigonometric polynomial: refined, never changed, by more points."""

    coefficients: np.ndarray  # h_q (m) in the layout of ``rfft2`` on the native shape
    native_shape: tuple[int, int]  # the smallest grid for every mode
    of_map: Roughness | None = None  # of the map that it goes through

    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        coefficients = fourier.resize_spectrum(self.coefficients, self.native_shape, shape)
        return fourier.synthesise(coefficients, shape)

    @property
    def roughness(self) -> Roughness:
        return self.of_map or super().roughness


@dataclass(frozen=True)
class Paraboloid(Surface):
    """h = −r²/2R around the centre of the cell, R (m): the sphere of Hertz and JKR, exact at any number of points."""

    radius: float

    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        y, x = Grid(shape, self.size).coordinates
        r2 = (y[:, None] - self.size[0] / 2) ** 2 + (x[None, :] - self.size[1] / 2) ** 2
        # The mean over the cell of r² is (Ly² + Lx²)/12: subtracted exactly, so that refining shifts nothing.
        return ((self.size[0] ** 2 + self.size[1] ** 2) / 12 - r2) / (2 * self.radius)


def paraboloid_waves(length: float, radius: float) -> np.ndarray:
    """Wavenumbers and height variances of −x²/2R over a period L, shape (2, n).

    The n-th harmonic has (L²/2π²n²R)²/2; one last wave has the height and slope of all that are left out.
    """
    n = np.arange(1.0, 101.0)
    wavenumber = 2 * np.pi * n / length
    variance = (length / (np.pi * n)) ** 4 / (8 * radius**2)
    height = (length**4 / 720) / radius**2 - variance.sum()
    slope = (length**2 / 12) / radius**2 - np.sum(wavenumber**2 * variance)
    return np.array([np.append(wavenumber, np.sqrt(slope / height)), np.append(variance, height)])


def gaussian_surface(
    spectrum: SelfAffineSpectrum, size: tuple[float, float], shape: tuple[int, int], seed: int, exact_height: bool
) -> BandLimitedSurface:
    """Draw a Gaussian surface: independent complex amplitudes of variance ∝ C(q), in order of |q|.

    The order makes the surface of a seed independent of ``shape`` and keeps its long waves when only the cutoff grows.
    The *expected* mean square on these modes is rms_height², with ``exact_height`` that of the sample.
    """
    waves = waves_between(size, spectrum.low, spectrum.cutoff)
    if waves.q.size == 0:
        raise InputError("surface: no mode between low_mode and cutoff_mode fits the cell")
    draws = np.random.default_rng(seed).standard_normal((waves.q.size, 2))
    variance = spectrum.density(np.clip(waves.q, spectrum.low, spectrum.cutoff))
    variance = variance * spectrum.rms_height**2 / (2 * variance.sum())  # each mode and its conjugate
    amplitude = np.sqrt(variance / 2) * (draws[:, 0] + 1j * draws[:, 1])
    if exact_height:
        amplitude *= spectrum.rms_height / np.sqrt(2 * np.sum(np.abs(amplitude) ** 2))
    return BandLimitedSurface(size, shape, spectrum, waves.coefficients(amplitude), waves.native)


@dataclass(frozen=True)
class Waves:
    """Modes of a cell, one of each conjugate pair, in order of |q|."""

    m_y: np.ndarray  # waves along each side
    m_x: np.ndarray
    q: np.ndarray  # |q| (1/m)
    native: tuple[int, int]  # the smallest grid for all of them

    def coefficients(self, amplitude: np.ndarray) -> np.ndarray:
        """Arrange complex amplitudes in the layout of ``rfft2`` on the native grid."""
        rows, columns = self.native
        coefficients = np.zeros((rows, columns // 2 + 1), complex)
        coefficients[self.m_y % rows, self.m_x] = amplitude
        on_axis = self.m_x == 0
        coefficients[-self.m_y[on_axis] % rows, 0] = np.conj(amplitude[on_axis])
        return coefficients


def waves_between(size: tuple[float, float], low: float, high: float) -> Waves:
    """Modes of a cell (y, x; m) between two wavevectors (1/m)."""
    unit_y, unit_x = 2 * np.pi / size[0], 2 * np.pi / size[1]
    # A mode on the limit belongs to the set whatever the rounding of 2π.
    highest, lowest = high * (1 + 1e-9), low * (1 - 1e-9)
    rows, columns = int(highest / unit_y), int(highest / unit_x)
    m_y, m_x = np.meshgrid(np.arange(-rows, rows + 1), np.arange(columns + 1), indexing="ij")
    q = np.hypot(m_y * unit_y, m_x * unit_x)
    independent = (q >= lowest) & (q <= highest) & ((m_x > 0) | (m_y > 0))
    m_y, m_x, q = m_y[independent], m_x[independent], q[independent]
    order = np.lexsort((m_x, m_y, np.round(q / min(unit_y, unit_x), 9)))
    return Waves(m_y[order], m_x[order], q[order], (2 * rows + 1, 2 * columns + 1))


def gaussian_peak_to_valley(rms_height: float, rms_slope: float, area: float) -> float:
    """Highest minus lowest point (m) that few Gaussian surfaces of an area (m²) exceed."""
    # A Gaussian surface stands above u rms heights at (2π)^(−3/2) A (ξ²/2 h_rms²) u exp(−u²/2) places in the mean,
    # for large u (the Euler characteristic of the region above); ξ²/2 is the variance of the slope along one axis.
    places = area * rms_slope**2 / (2 * rms_height**2) / (2 * np.pi) ** 1.5
    u = 3.0
    for _ in range(20):  # a contraction of factor 1/u² where places are many
        u = float(np.sqrt(2 * np.log(max(places * u / _RARE, np.exp(2.0)))))
    return 2 * u * rms_height


@dataclass(frozen=True)
class SurfaceScales:
    """Scales of a surface in a cell of a size (y, x; m) on the shape of the continuum grid."""

    size: tuple[float, float]
    shape: tuple[int, int]
    rms_height: float  # (m)
    rms_slope: float  # √<|∇h|²>
    peak_to_valley: float  # highest minus lowest point (m); of a random surface one that few realisations exceed
    shortest_wave: float  # wavelength of the finest roughness (m), infinite if there is none
    spectrum: RoughnessSpectrum | None = field(default=None, compare=False)  # waves of these heights and slopes
    lost: tuple[float, float] | None = None  # height and slope of a map on a shape that cannot carry all of its waves
    measured: Roughness | None = field(default=None, compare=False)  # a map from a file, repeated
    unit: str = ""  # of the heights of a map, and its source
    apex_curvature: float | None = None  # of a surface that is one asperity, whose waves are those of its edges (1/m)
    maps: tuple[tuple[str, "SurfaceScales"], ...] = field(default=(), compare=False)  # files of a composite surface

    @property
    def pixel(self) -> float:
        """Largest grid spacing (m)."""
        return max(Grid(self.shape, self.size).spacing)

    @property
    def grid_waves(self) -> tuple[float, float]:
        """Wavelengths of the longest and of the shortest wave along an axis of the grid (m)."""
        return max(self.size), 2 * min(Grid(self.shape, self.size).spacing)

    @property
    def rms_curvature(self) -> float:
        """Root mean square of the mean curvature, half of the rms Laplacian (1/m)."""
        if self.apex_curvature is not None or self.spectrum is None:
            return self.apex_curvature or 0.0
        return self.measured.sample.rms_curvature if self.measured else self.spectrum.rms_laplacian / 2

    def full_contact_stress(self, solid: Elasticity) -> float:
        """Deviation of the stress that a solid feels in full contact, of a half-space E* ξ / 2 (Pa)."""
        waves = self.spectrum
        return float(np.sqrt(waves.full_contact_stress_variance(solid.stiffness))) if waves else 0.0


def spectrum_of_waves(wavenumber: np.ndarray, variance: np.ndarray) -> RadialSpectrum | None:
    """Collect waves of |q| (1/m) and variance (m²) in eighths of an octave of their height and slope."""
    band = np.floor(8 * np.log2(wavenumber / wavenumber.min()) + 1e-6).astype(int)
    heights, slopes = np.bincount(band, variance), np.bincount(band, wavenumber**2 * variance)
    present = heights > 0
    return RadialSpectrum(np.sqrt(slopes[present] / heights[present]), heights[present]) if present.any() else None


@dataclass(frozen=True)
class MeasuredMap:
    """A prepared map."""

    heights: np.ndarray  # about their mean (m)
    grid: Grid
    unit: str  # of the heights, and its source
    roughness: Roughness  # of the map repeated periodically

    def surface(self, shape: tuple[int, int] | None) -> BandLimitedSurface:
        """Make the trigonometric polynomial through the map, on the map's grid or a continuum grid of a shape."""
        grid, coefficients = self.grid, fourier.transform(self.heights)
        return BandLimitedSurface(grid.size, shape or grid.shape, None, coefficients, grid.shape, self.roughness)

    def scales(self, shape: tuple[int, int] | None, lowpass: float | None) -> SurfaceScales:
        """Calculate the scales on a continuum grid of a shape; ``lowpass`` is the shortest wave kept (m)."""
        grid, own = self.grid, self.roughness
        coefficients = fourier.transform(self.heights)
        lost = None
        if shape is not None and (shape[0] < grid.shape[0] or shape[1] < grid.shape[1]):
            coarser = Grid(shape, grid.size)
            power = coarser.variances(fourier.resize_spectrum(coefficients, grid.shape, shape))
            lost = float(np.sqrt(power.sum())), float(np.sqrt(np.sum(coarser.wavenumber**2 * power)))
        spectrum = spectrum_of_waves(grid.wavenumber.reshape(-1)[1:], grid.variances(coefficients).reshape(-1)[1:])
        height, shortest = float(np.ptp(self.heights)), max(2 * max(grid.spacing), lowpass or 0.0)
        scales = grid.size, shape or grid.shape, own.rms_height, own.rms_slope, height, shortest, spectrum, lost
        return SurfaceScales(*scales, measured=own, unit=self.unit)


def prepared_map(path: Path, whole: HeightMap, keys: Any) -> MeasuredMap:
    """Crop, detrend, fill and join the edges of a map of a file by a study's keys; InputError if it does not fit."""
    found = whole if keys.crop is None else _cropped(path, whole, keys.crop)
    heights, own, size = found.heights, found.grid, found.size
    missing = float(np.mean(np.isnan(heights)))
    if missing and keys.fill == "none":
        row, column = np.argwhere(np.isnan(heights))[0]
        raise InputError(
            f"surface.path: {100 * missing:.2g} % of the heights in {path} are missing, the first at row {row}, "
            f'column {column}; surface.fill = "harmonic" fills them, surface.crop leaves them out'
        )
    if missing == 1:
        raise InputError(f"surface.crop: all heights of {path} in it are missing")
    if keys.detrend != "mean":  # the mean is taken at the end, and what fills holes follows any constant
        heights = preparation.detrended(heights, _DEGREES[keys.detrend])
    alone = heights = preparation.filled(heights, own.spacing)
    if keys.edges == "mirror":
        heights, size = preparation.mirrored(heights), (2 * size[0], 2 * size[1])
    elif keys.edges == "window":
        heights = preparation.windowed(heights, keys.window_share)
    if keys.resample is not None:
        heights = fourier.interpolate(heights, keys.resample)
    grid = Grid((heights.shape[0], heights.shape[1]), size)
    if keys.lowpass is not None:
        if keys.lowpass > min(size) / 2:
            raise InputError(
                f"surface.lowpass = {keys.lowpass:g} m: leaves less than two waves on a side of {min(size):g} m"
            )
        heights = preparation.lowpassed(heights, grid, keys.lowpass)
    heights = heights - heights.mean()
    heights.setflags(write=False)  # for all cases and models
    coarser = 2 * max(grid.spacing) if max(grid.spacing) > max(own.spacing) * (1 + 1e-9) else None
    sample = roughness_of_sample(alone, own, keys.lowpass or coarser)
    roughness = replace(roughness_of(heights, grid), alone=sample, filled=missing)
    return MeasuredMap(heights, grid, found.unit, roughness)


def _cropped(path: Path, found: HeightMap, crop: Sequence[tuple[float, float]]) -> HeightMap:
    grid, parts, size = found.grid, [], []
    for axis, (low, high), count, step in zip("yx", crop, grid.shape, grid.spacing, strict=True):
        # A point on a limit is meant, whatever the rounding of its unit.
        first, last = (int(np.ceil(limit / step - 1e-6)) for limit in (low, high))
        if last > count:
            raise InputError(f"surface.crop: {axis} = {high:g} m lies beyond {path}, which ends at {count * step:g} m")
        if last - first < 4:
            raise InputError(f"surface.crop: holds {last - first} points of {path} along {axis}; at least 4 are needed")
        parts.append(slice(first, last))
        size.append((last - first) * step)
    return HeightMap(found.heights[parts[0], parts[1]], (size[0], size[1]), found.unit)
