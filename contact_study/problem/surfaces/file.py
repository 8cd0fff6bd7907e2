"""A measured surface: heights from a file, taken as periodic."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.fields import fourier
from contact_study.fields.grid import Grid
from contact_study.problem.height_map import HeightMap, read_height_map
from contact_study.problem.keys import key, text
from contact_study.problem.surface import BandLimitedSurface, Surface
from contact_study.problem.surface_scales import SurfaceScales, spectrum_of_waves
from contact_study.problem.surfaces.base import SurfaceSection


@dataclass(frozen=True, kw_only=True)
class MapFile(SurfaceSection):
    """The trigonometric polynomial through the heights of a map, less their mean."""

    words = "rigid, periodic, height map {path}, {size}"
    height_key = "surface.height_unit"

    path: str = key(text(), "height map: NetCDF, npy or text, relative to the study file")
    height_unit: str | None = key(text(), "unit of the height map, default m or the file's own", None)

    @property
    def map_path(self) -> str:
        return self.path

    def realise(self, directory: Path) -> Surface:
        height_map = self._read(directory)
        heights = height_map.heights - height_map.heights.mean()
        shape = self.shape or height_map.shape
        return BandLimitedSurface(height_map.size, shape, None, fourier.transform(heights), height_map.shape)

    def scales(self, directory: Path) -> SurfaceScales:
        height_map = self._read(directory)
        heights, shape = height_map.heights, self.shape
        grid = Grid(height_map.shape, height_map.size)
        coefficients = fourier.transform(heights)
        lost = None
        if shape is not None and (shape[0] < grid.shape[0] or shape[1] < grid.shape[1]):
            lost = _moments(fourier.resize_spectrum(coefficients, grid.shape, shape), Grid(shape, grid.size))
        height, slope = _moments(coefficients, grid)
        peak_to_valley = float(np.ptp(heights))
        power = (grid.multiplicity * np.abs(coefficients) ** 2).reshape(-1)[1:]
        spectrum = spectrum_of_waves(grid.wavenumber.reshape(-1)[1:], power)
        shortest = 2 * max(grid.spacing)
        return SurfaceScales(grid.size, shape or grid.shape, height, slope, peak_to_valley, shortest, spectrum, lost)

    def _read(self, directory: Path) -> HeightMap:
        return read_height_map(directory / self.path, self.height_unit, self.size)


def _moments(coefficients: np.ndarray, grid: Grid) -> tuple[float, float]:
    """Rms height (m) and rms slope of a trigonometric polynomial, its mean apart."""
    power = grid.multiplicity * np.abs(coefficients) ** 2
    power[0, 0] = 0.0
    return float(np.sqrt(power.sum())), float(np.sqrt(np.sum(grid.wavenumber**2 * power)))
