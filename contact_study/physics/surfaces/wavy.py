"""A product of two cosines, or one wave."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.errors import InputError
from contact_study.physics.surfaces.base import CellSection
from contact_study.physics.surfaces.realisation import BandLimitedSurface, Surface
from contact_study.physics.surfaces.scales import SurfaceScales, spectrum_of_waves
from contact_study.study.schema.keys import integer, key, pair, quantity


@dataclass(frozen=True, kw_only=True)
class Wavy(CellSection):
    """h = amplitude · cos(2π m_y y/L_y) · cos(2π m_x x/L_x); a mode 0 leaves that axis flat."""

    words = "a rigid wavy surface of amplitude {amplitude}, modes {modes}, {size}"
    height_key = "surface.amplitude"

    amplitude: float = key(quantity("m", positive=True), "h = amplitude·cos·cos")
    modes: tuple[int, int] = key(pair(integer(minimum=0, maximum=2**31 - 1)), "waves along y and x", (1, 1))

    def __post_init__(self):
        if self.modes == (0, 0):
            raise InputError("surface.modes = [0, 0]: make no wave; at least one must be positive")
        for axis, mode, points in zip("yx", self.modes, self.shape, strict=True):
            if 2 * mode >= points:
                raise InputError(
                    f"surface.modes = {list(self.modes)}: {mode} waves along {axis} are beyond what "
                    f"surface.shape = {list(self.shape)} can carry; use more than {2 * mode} points along {axis} or "
                    "a smaller mode"
                )

    def realise(self, directory: Path) -> Surface:
        m_y, m_x = self.modes
        native = (2 * m_y + 1, 2 * m_x + 1)
        y, x = np.arange(native[0]) / native[0], np.arange(native[1]) / native[1]
        waves = np.cos(2 * np.pi * m_y * y)[:, None] * np.cos(2 * np.pi * m_x * x)[None, :]
        coefficients = np.fft.rfft2(self.amplitude * waves) / waves.size
        coefficients[0, 0] = 0.0
        return BandLimitedSurface(self.size, self.shape, None, coefficients, native)

    def scales(self, directory: Path) -> SurfaceScales:
        q_y, q_x = (2 * np.pi * mode / length for mode, length in zip(self.modes, self.size, strict=True))
        # <cos²> is one half along each axis that has waves.
        height = self.amplitude * 0.5 ** (0.5 * np.count_nonzero(self.modes))
        wavenumber = float(np.hypot(q_y, q_x))
        slope = float(height) * wavenumber
        spectrum = spectrum_of_waves(np.array([wavenumber]), np.array([height**2]))
        shortest = 2 * np.pi / wavenumber
        return SurfaceScales(self.size, self.shape, float(height), slope, 2 * self.amplitude, shortest, spectrum)
