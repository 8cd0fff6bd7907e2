"""The rigid surface of a case: one height function, which each model samples on its own points."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.roughness.spectrum import RadialSpectrum, SelfAffineSpectrum, radial_spectrum
from contact_study.physics.roughness.statistics import Roughness, roughness_of


@dataclass(frozen=True)
class Surface(ABC):
    """A periodic height function of zero mean, toward the block."""

    size: tuple[float, float]  # periods along y and x (m)
    shape: tuple[int, int]  # points of the continuum grid
    spectrum: SelfAffineSpectrum | None  # target of a random one

    @abstractmethod
    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        """Heights of this surface on a grid of the given shape (m)."""

    @property
    def grid(self) -> Grid:
        """The continuum grid."""
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
        return roughness_of(self.sampled, self.grid, None if target is None else (target.roll_off, target.cutoff))

    def measured_spectrum(self) -> RadialSpectrum:
        """Radial spectrum of this very surface."""
        return radial_spectrum(self.sampled, self.grid)


@dataclass(frozen=True)
class BandLimitedSurface(Surface):
    """A trigonometric polynomial: refined, never changed, by more points."""

    coefficients: np.ndarray  # h_q (m) in the layout of ``rfft2`` on the native shape
    native_shape: tuple[int, int]  # the smallest grid for every mode

    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        coefficients = fourier.resize_spectrum(self.coefficients, self.native_shape, shape)
        return fourier.synthesise(coefficients, shape)
