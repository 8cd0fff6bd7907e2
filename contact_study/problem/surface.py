"""The rigid surface of a case: one height function, sampled by each model on the points it needs."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.fields import fourier
from contact_study.fields.grid import Grid
from contact_study.fields.spectrum import RadialSpectrum, SelfAffineSpectrum, radial_spectrum
from contact_study.problem.case import Case
from contact_study.problem.errors import InputError
from contact_study.problem.height_map import read_height_map
from contact_study.problem.sections import SurfaceSection


@dataclass(frozen=True)
class Surface(ABC):
    """A periodic height function of zero mean; heights point toward the block.

    Parameters
    ----------
    size : tuple of float
        Periods along y and x (m).
    shape : tuple of int
        Points of the continuum grid.
    spectrum : SelfAffineSpectrum or None
        The target spectrum of a random surface.
    """

    size: tuple[float, float]
    shape: tuple[int, int]
    spectrum: SelfAffineSpectrum | None

    @abstractmethod
    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        """Heights of this surface on a grid of the given shape (m)."""

    @property
    def grid(self) -> Grid:
        """The continuum grid."""
        return Grid(self.shape, self.size)

    @cached_property
    def _sampled(self) -> np.ndarray:
        return self.heights(self.shape)

    @property
    def rms_height(self) -> float:
        """Root-mean-square height of this surface on the continuum grid (m)."""
        return float(np.sqrt(np.mean(self._sampled**2)))

    @property
    def peak_to_valley(self) -> float:
        """Highest minus lowest point of the continuum grid (m)."""
        return float(np.ptp(self._sampled))

    @property
    def rms_slope(self) -> float:
        """√<|∇h|²> of the trigonometric interpolant on the continuum grid."""
        power = self.grid.multiplicity * np.abs(fourier.transform(self._sampled)) ** 2
        return float(np.sqrt(np.sum(self.grid.wavenumber**2 * power)))

    def measured_spectrum(self) -> RadialSpectrum:
        """Radial spectrum of this very surface."""
        return radial_spectrum(self._sampled, self.grid)


@dataclass(frozen=True)
class BandLimitedSurface(Surface):
    """A trigonometric polynomial: refined, never changed, by more points.

    Parameters
    ----------
    coefficients : numpy.ndarray
        h_q in the layout of ``rfft2`` on ``native_shape`` points (m).
    native_shape : tuple of int
        The smallest grid that carries every mode.
    """

    coefficients: np.ndarray
    native_shape: tuple[int, int]

    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        coefficients = fourier.resize_spectrum(self.coefficients, self.native_shape, shape)
        return fourier.synthesise(coefficients, shape)


@dataclass(frozen=True)
class Paraboloid(Surface):
    """h = −r²/2R around the centre of the cell: the sphere of Hertz and JKR, exact at any number of points.

    Parameters
    ----------
    radius : float
        Radius of curvature R (m).
    """

    radius: float

    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        y, x = Grid(shape, self.size).coordinates
        r2 = (y[:, None] - self.size[0] / 2) ** 2 + (x[None, :] - self.size[1] / 2) ** 2
        # The mean over the cell of r² is (Ly² + Lx²)/12: subtracted exactly, so that refining shifts nothing.
        return ((self.size[0] ** 2 + self.size[1] ** 2) / 12 - r2) / (2 * self.radius)


def realise(case: Case) -> Surface:
    """The surface of a case; equal cases give equal surfaces, for every model.

    Raises
    ------
    InputError
        If a height map cannot be read or used.
    """
    section = case.surface
    if section.kind == "file":
        return _from_file(case)
    size, shape = section.size, section.shape
    assert size is not None  # checked by SurfaceSection
    assert shape is not None
    if section.kind == "self_affine":
        return _self_affine(section, size, shape)
    if section.kind == "sphere":
        assert section.radius is not None
        return Paraboloid(size, shape, None, section.radius)
    if section.kind == "wavy":
        return _wavy(section, size, shape)
    return BandLimitedSurface(size, shape, None, np.zeros((1, 1), complex), (1, 1))


def target_spectrum(section: SurfaceSection) -> SelfAffineSpectrum:
    """The spectrum that a ``self_affine`` section asks for; its modes count waves on the longest side."""
    assert section.size is not None
    assert section.rms_height is not None
    assert section.cutoff_mode is not None
    unit = 2 * np.pi / max(section.size)
    return SelfAffineSpectrum(
        section.hurst_exponent,
        section.rms_height,
        section.low_mode * unit,
        section.roll_off_mode * unit,
        section.cutoff_mode * unit,
    )


def _self_affine(section: SurfaceSection, size: tuple[float, float], shape: tuple[int, int]) -> Surface:
    """Gaussian surface: independent complex amplitudes of variance ∝ C(q), drawn in order of |q|.

    The order makes the surface of a seed independent of ``shape`` and keeps its long waves when only ``cutoff_mode``
    grows. The variances are scaled so that the *expected* mean square is rms_height² on this discrete set of modes;
    normalisation "realised" then scales the sample to rms_height exactly.
    """
    spectrum = target_spectrum(section)
    unit_y, unit_x = 2 * np.pi / size[0], 2 * np.pi / size[1]
    # A mode on the limit belongs to the set whatever the rounding of 2π.
    highest, lowest = spectrum.cutoff * (1 + 1e-9), spectrum.low * (1 - 1e-9)
    rows, columns = int(highest / unit_y), int(highest / unit_x)
    m_y, m_x = np.meshgrid(np.arange(-rows, rows + 1), np.arange(columns + 1), indexing="ij")
    q = np.hypot(m_y * unit_y, m_x * unit_x)
    independent = (q >= lowest) & (q <= highest) & ((m_x > 0) | (m_y > 0))
    m_y, m_x, q = m_y[independent], m_x[independent], q[independent]
    if q.size == 0:
        raise InputError("surface: no mode between low_mode and cutoff_mode fits the cell")
    order = np.lexsort((m_x, m_y, np.round(q / min(unit_y, unit_x), 9)))
    m_y, m_x, q = m_y[order], m_x[order], q[order]
    draws = np.random.default_rng(section.seed).standard_normal((q.size, 2))
    variance = spectrum.density(np.clip(q, spectrum.low, spectrum.cutoff))
    variance = variance * spectrum.rms_height**2 / (2 * variance.sum())  # each mode and its conjugate
    amplitude = np.sqrt(variance / 2) * (draws[:, 0] + 1j * draws[:, 1])
    if section.normalisation == "realised":
        amplitude *= spectrum.rms_height / np.sqrt(2 * np.sum(np.abs(amplitude) ** 2))
    native = (2 * rows + 1, 2 * columns + 1)
    coefficients = np.zeros((native[0], columns + 1), complex)
    coefficients[m_y % native[0], m_x] = amplitude
    on_axis = m_x == 0
    coefficients[-m_y[on_axis] % native[0], 0] = np.conj(amplitude[on_axis])
    return BandLimitedSurface(size, shape, spectrum, coefficients, native)


def _wavy(section: SurfaceSection, size: tuple[float, float], shape: tuple[int, int]) -> Surface:
    """h = amplitude · cos(2π m_y y/L_y) · cos(2π m_x x/L_x); a mode 0 leaves that axis flat."""
    m_y, m_x = section.modes
    native = (2 * m_y + 1, 2 * m_x + 1)
    y, x = np.arange(native[0]) / native[0], np.arange(native[1]) / native[1]
    waves = np.cos(2 * np.pi * m_y * y)[:, None] * np.cos(2 * np.pi * m_x * x)[None, :]
    coefficients = np.fft.rfft2(section.amplitude * waves) / waves.size
    coefficients[0, 0] = 0.0
    return BandLimitedSurface(size, shape, None, coefficients, native)


def _from_file(case: Case) -> Surface:
    section = case.surface
    assert case.height_map is not None  # checked by SurfaceSection
    height_map = read_height_map(case.height_map, section.height_unit, section.size)
    heights = height_map.heights - height_map.heights.mean()
    return BandLimitedSurface(
        height_map.size,
        section.shape or heights.shape,
        None,
        fourier.transform(heights),
        heights.shape,
    )
