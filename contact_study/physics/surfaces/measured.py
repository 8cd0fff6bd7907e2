"""A measured surface: heights from a file, prepared as asked and taken as periodic."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps import preparation
from contact_study.physics.height_maps.height_map import HeightMap
from contact_study.physics.roughness.statistics import Roughness, roughness_of, roughness_of_sample
from contact_study.physics.surfaces.surface import BandLimitedSurface, SurfaceScales, spectrum_of_waves

_DEGREES = {"mean": 0, "tilt": 1, "curvature": 2}


@dataclass(frozen=True)
class MeasuredMap:
    """A prepared map."""

    heights: np.ndarray  # about their mean (m)
    grid: Grid
    unit: str  # of the heights, and its source
    roughness: Roughness  # of the map repeated periodically

    def surface(self, shape: tuple[int, int] | None) -> "MeasuredSurface":
        """Make the trigonometric polynomial through the map, on the map's grid or a continuum grid of a shape."""
        native = self.grid.shape
        return MeasuredSurface(self.grid.size, shape or native, None, fourier.transform(self.heights), native, self)

    def scales(self, shape: tuple[int, int] | None, lowpass: float | None) -> SurfaceScales:
        """Calculate the scales on a continuum grid of a shape; ``lowpass`` is the shortest wave kept (m)."""
        grid, own = self.grid, self.roughness
        coefficients = fourier.transform(self.heights)
        lost = None
        if shape is not None and (shape[0] < grid.shape[0] or shape[1] < grid.shape[1]):
            coarser = Grid(shape, grid.size)
            power = coarser.variances(fourier.resize_spectrum(coefficients, grid.shape, shape))
            lost = float(np.sqrt(power.sum())), float(np.sqrt(np.sum(coarser.wavenumber**2 * power)))
        spectrum = spectrum_of_waves(grid.wavenumber.reshape(-1)[1:], grid.variances(coefficients).reshape(-1)[1:])
        height, shortest = float(np.ptp(self.heights)), max(2 * max(grid.spacing), lowpass or 0.0)
        scales = grid.size, shape or grid.shape, own.rms_height, own.rms_slope, height, shortest, spectrum, lost
        return SurfaceScales(*scales, measured=own, unit=self.unit)


@dataclass(frozen=True)
class MeasuredSurface(BandLimitedSurface):
    """The trigonometric polynomial through a measured map, which remembers the map."""

    measured: MeasuredMap

    @property
    def roughness(self) -> Roughness:
        return self.measured.roughness


@dataclass(frozen=True, kw_only=True)
class MapPreparation:
    """How a map becomes a periodic surface: the keys of a study of the same names, lengths in m."""

    crop: tuple[tuple[float, float], tuple[float, float]] | None = None
    detrend: str = "mean"
    fill: str = "none"
    edges: str = "periodic"
    window_share: float = 0.2
    resample: tuple[int, int] | None = None
    lowpass: float | None = None

    def prepare(self, path: Path, whole: HeightMap) -> MeasuredMap:
        """Crop, detrend, fill and join the edges of a map of a file; InputError if it does not fit what is asked."""
        found = self._cropped(path, whole)
        heights, own = found.heights, found.grid
        missing = float(np.mean(np.isnan(heights)))
        if missing and self.fill == "none":
            row, column = np.argwhere(np.isnan(heights))[0]
            raise InputError(
                f"surface.path: {100 * missing:.2g} % of the heights in {path} are missing, the first at row {row}, "
                f'column {column}; surface.fill = "harmonic" fills them, surface.crop leaves them out'
            )
        if missing == 1:
            raise InputError(f"surface.crop: all heights of {path} in it are missing")
        if self.detrend != "mean":  # the mean is taken at the end, and what fills holes follows any constant
            heights = preparation.detrended(heights, _DEGREES[self.detrend])
        alone = heights = preparation.filled(heights, own.spacing)
        size = own.size
        if self.edges == "mirror":
            heights, size = preparation.mirrored(heights), (2 * size[0], 2 * size[1])
        elif self.edges == "window":
            heights = preparation.windowed(heights, self.window_share)
        if self.resample is not None:
            heights = fourier.interpolate(heights, self.resample)
        grid = Grid((heights.shape[0], heights.shape[1]), size)
        if self.lowpass is not None:
            if self.lowpass > min(size) / 2:
                raise InputError(
                    f"surface.lowpass = {self.lowpass:g} m: leaves less than two waves on a side of {min(size):g} m"
                )
            heights = preparation.lowpassed(heights, grid, self.lowpass)
        heights = heights - heights.mean()
        heights.setflags(write=False)
        coarser = 2 * max(grid.spacing) if max(grid.spacing) > max(own.spacing) * (1 + 1e-9) else None
        sample = roughness_of_sample(alone, own, self.lowpass or coarser)
        roughness = replace(roughness_of(heights, grid), alone=sample, filled=missing)
        return MeasuredMap(heights, grid, found.unit, roughness)

    def _cropped(self, path: Path, found: HeightMap) -> HeightMap:
        if self.crop is None:
            return found
        parts, size = [], []
        grid = found.grid
        for axis, (low, high), count, step in zip("yx", self.crop, grid.shape, grid.spacing, strict=True):
            # A point on a limit is meant, whatever the rounding of its unit.
            first, last = (int(np.ceil(limit / step - 1e-6)) for limit in (low, high))
            if last > count:
                raise InputError(
                    f"surface.crop: {axis} = {high:g} m lies beyond {path}, which ends at {count * step:g} m"
                )
            if last - first < 4:
                raise InputError(
                    f"surface.crop: holds {last - first} points of {path} along {axis}; at least 4 are needed"
                )
            parts.append(slice(first, last))
            size.append((last - first) * step)
        return HeightMap(found.heights[parts[0], parts[1]], (size[0], size[1]), found.unit)
