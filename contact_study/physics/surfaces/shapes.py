"""Surfaces of one formula: the sphere of Hertz and JKR, and waves."""

from dataclasses import dataclass

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.physics.surfaces.scales import SurfaceScales, spectrum_of_waves
from contact_study.physics.surfaces.surface import BandLimitedSurface, Surface


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


def paraboloid_scales(radius: float, size: tuple[float, float], shape: tuple[int, int]) -> SurfaceScales:
    """Calculate the scales of a paraboloid of a radius (m) in a cell of a size (m)."""
    y2, x2 = size[0] ** 2, size[1] ** 2
    # Moments of h = −r²/2R over the rectangle: <y²> = y2/12, the variance of y² is y2²/180.
    height = np.sqrt((y2**2 + x2**2) / 180) / (2 * radius)
    slope = np.sqrt((y2 + x2) / 12) / radius
    peak = (y2 + x2) / (8 * radius)
    waves = np.hstack([_waves(length, radius) for length in size])
    spectrum = spectrum_of_waves(*waves)
    return SurfaceScales(
        size, shape, float(height), float(slope), peak, float("inf"), spectrum, apex_curvature=1 / radius
    )


def _waves(length: float, radius: float) -> np.ndarray:
    """Wavenumbers and height variances of −x²/2R over a period L, shape (2, n).

    The n-th harmonic has (L²/2π²n²R)²/2; one last wave has the height and slope of all that are left out.
    """
    n = np.arange(1.0, 101.0)
    wavenumber = 2 * np.pi * n / length
    variance = (length / (np.pi * n)) ** 4 / (8 * radius**2)
    height = (length**4 / 720) / radius**2 - variance.sum()
    slope = (length**2 / 12) / radius**2 - np.sum(wavenumber**2 * variance)
    return np.array([np.append(wavenumber, np.sqrt(slope / height)), np.append(variance, height)])


def wavy_surface(
    amplitude: float, modes: tuple[int, int], size: tuple[float, float], shape: tuple[int, int]
) -> BandLimitedSurface:
    """Make h = amplitude · cos(2π m_y y/L_y) · cos(2π m_x x/L_x) (m); a mode 0 leaves that axis flat."""
    m_y, m_x = modes
    native = (2 * m_y + 1, 2 * m_x + 1)
    y, x = np.arange(native[0]) / native[0], np.arange(native[1]) / native[1]
    waves = np.cos(2 * np.pi * m_y * y)[:, None] * np.cos(2 * np.pi * m_x * x)[None, :]
    coefficients = np.fft.rfft2(amplitude * waves) / waves.size
    coefficients[0, 0] = 0.0
    return BandLimitedSurface(size, shape, None, coefficients, native)


def wavy_scales(
    amplitude: float, modes: tuple[int, int], size: tuple[float, float], shape: tuple[int, int]
) -> SurfaceScales:
    """Calculate the scales of a wavy surface; parameters as :func:`wavy_surface`."""
    q_y, q_x = (2 * np.pi * mode / length for mode, length in zip(modes, size, strict=True))
    # <cos²> is one half along each axis that has waves.
    height = amplitude * 0.5 ** (0.5 * np.count_nonzero(modes))
    wavenumber = float(np.hypot(q_y, q_x))
    slope = float(height) * wavenumber
    spectrum = spectrum_of_waves(np.array([wavenumber]), np.array([height**2]))
    shortest = 2 * np.pi / wavenumber
    return SurfaceScales(size, shape, float(height), slope, 2 * amplitude, shortest, spectrum)
