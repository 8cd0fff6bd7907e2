"""The sphere of Hertz and JKR."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.physics.surfaces.base import CellSection
from contact_study.physics.surfaces.realisation import Surface
from contact_study.physics.surfaces.scales import SurfaceScales, spectrum_of_waves
from contact_study.study.schema.keys import key, quantity


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


@dataclass(frozen=True, kw_only=True)
class Sphere(CellSection):
    """A paraboloid in the middle of the cell; its slope jumps at the cell's edge."""

    words = "a rigid sphere of radius {radius}, {size}"
    height_key = "surface.radius"
    periodic = False

    radius: float = key(quantity("m", positive=True), "radius of curvature of the apex")

    def realise(self, directory: Path) -> Surface:
        return Paraboloid(self.size, self.shape, None, self.radius)

    def scales(self, directory: Path) -> SurfaceScales:
        y2, x2, radius = self.size[0] ** 2, self.size[1] ** 2, self.radius
        # Moments of h = −r²/2R over the rectangle: <y²> = y2/12, the variance of y² is y2²/180.
        height = np.sqrt((y2**2 + x2**2) / 180) / (2 * radius)
        slope = np.sqrt((y2 + x2) / 12) / radius
        peak = (y2 + x2) / (8 * radius)
        waves = np.hstack([_waves(length, radius) for length in self.size])
        spectrum = spectrum_of_waves(*waves)
        return SurfaceScales(
            self.size, self.shape, float(height), float(slope), peak, float("inf"), spectrum, apex_curvature=1 / radius
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
