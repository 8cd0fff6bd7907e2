"""No roughness at all."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.physics.surfaces.base import CellSection
from contact_study.physics.surfaces.realisation import BandLimitedSurface, Surface
from contact_study.physics.surfaces.scales import SurfaceScales


@dataclass(frozen=True, kw_only=True)
class Flat(CellSection):
    """h = 0."""

    words = "rigid and flat, {size}"
    height_key = "surface.size"
    rough = False

    def realise(self, directory: Path) -> Surface:
        return BandLimitedSurface(self.size, self.shape, None, np.zeros((1, 1), complex), (1, 1))

    def scales(self, directory: Path) -> SurfaceScales:
        return SurfaceScales(self.size, self.shape, 0.0, 0.0, 0.0, float("inf"))
