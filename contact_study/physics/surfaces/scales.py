"""Scales of a surface that follow from the study alone, the same for all realisations of a random surface."""

from dataclasses import dataclass, field

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.physics.roughness.spectrum import RadialSpectrum, RoughnessSpectrum
from contact_study.physics.roughness.statistics import Roughness
from contact_study.physics.solids import Elasticity


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
        if self.apex_curvature is not None:
            return self.apex_curvature
        if self.measured is not None:
            return self.measured.sample.rms_curvature
        return 0.0 if self.spectrum is None else self.spectrum.rms_laplacian / 2

    def full_contact_stress(self, solid: Elasticity) -> float:
        """Deviation of the stress that a solid feels in full contact, of a half-space E* ξ / 2 (Pa)."""
        if self.spectrum is None:
            return 0.0
        return float(np.sqrt(self.spectrum.full_contact_stress_variance(solid.stiffness)))


def spectrum_of_waves(wavenumber: np.ndarray, variance: np.ndarray) -> RadialSpectrum | None:
    """Collect waves of |q| (1/m) and variance (m²) in eighths of an octave of their height and slope."""
    band = np.floor(8 * np.log2(wavenumber / wavenumber.min()) + 1e-6).astype(int)
    heights, slopes = np.bincount(band, variance), np.bincount(band, wavenumber**2 * variance)
    present = heights > 0
    return RadialSpectrum(np.sqrt(slopes[present] / heights[present]), heights[present]) if present.any() else None
