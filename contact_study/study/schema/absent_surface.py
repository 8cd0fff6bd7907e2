"""The surface of a study without ``[surface]``: a spectrum for theories, and no heights."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.physics.roughness.spectrum import TabulatedSpectrum
from contact_study.physics.surfaces.drawn import scales_of
from contact_study.physics.surfaces.surface import Surface, SurfaceScales
from contact_study.study.schema.keys import TEXT, key
from contact_study.study.schema.surface import SurfaceSection


@dataclass(frozen=True)
class SpectrumOnly(Surface):
    """A spectrum in place of heights; its cell holds the longest wave once and its grid carries the shortest."""

    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        """Raise InputError: there are none."""
        raise InputError("missing key surface.kind: the study has a roughness spectrum only, no surface")


@dataclass(frozen=True, kw_only=True)
class AbsentSurface(SurfaceSection):
    """The surface of a study without ``[surface]``, whose theories take the spectrum of ``[theory]``."""

    words = "no surface: a roughness spectrum"
    height_key = "theory.density"
    periodic = False
    absent = True

    kind: str = key(TEXT, "geometry of the rigid surface", "none")
    wavevectors: tuple[float, ...]
    density: tuple[float, ...]

    def realise(self, directory: Path) -> SpectrumOnly:
        scales = self.scales(directory)
        return SpectrumOnly(scales.size, scales.shape, None)

    def scales(self, directory: Path) -> SurfaceScales:
        table = TabulatedSpectrum(np.array(self.wavevectors), np.array(self.density))
        longest, shortest = (2 * np.pi / q for q in table.limits)
        points = 2 * int(np.ceil(longest / shortest)) + 2
        return scales_of(table, (longest, longest), (points, points))
