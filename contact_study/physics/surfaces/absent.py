"""No surface: a study of theories alone whose roughness is a table of its spectrum."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.errors import InputError
from contact_study.physics.roughness.tabulated_spectrum import TabulatedSpectrum
from contact_study.physics.surfaces.base import SurfaceSection
from contact_study.physics.surfaces.realisation import Surface
from contact_study.physics.surfaces.scales import SurfaceScales
from contact_study.physics.surfaces.self_affine import gaussian_peak_to_valley


@dataclass(frozen=True)
class SpectrumOnly(Surface):
    """A spectrum in place of heights; its cell holds the longest wave once and its grid carries the shortest."""

    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        """Raise InputError: there are none."""
        raise InputError("missing key surface.kind: the study has a roughness spectrum only, no surface")


@dataclass(frozen=True, kw_only=True)
class AbsentSurface(SurfaceSection):
    """What a study without ``[surface]`` has, whose theories take the spectrum of ``[theory]``."""

    words = "no surface: a roughness spectrum"
    height_key = "theory.density"
    periodic = False
    absent = True

    kind: str = "none"
    table: TabulatedSpectrum

    def realise(self, directory: Path) -> SpectrumOnly:
        scales = self.scales(directory)
        return SpectrumOnly(scales.size, scales.shape, None)

    def scales(self, directory: Path) -> SurfaceScales:
        longest, shortest = (2 * np.pi / q for q in self.table.limits)
        height, slope = float(np.sqrt(self.table.mean_square_height)), self.table.rms_slope
        points = 2 * int(np.ceil(longest / shortest)) + 2
        peak = gaussian_peak_to_valley(height, slope, longest**2)
        return SurfaceScales((longest, longest), (points, points), height, slope, peak, shortest, self.table)
