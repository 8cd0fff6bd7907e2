"""A measured surface: heights from a file, made ready as the study asks and taken as periodic."""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from contact_study.errors import InputError
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps import preparation
from contact_study.physics.height_maps.height_map import HeightMap, read_height_map
from contact_study.physics.roughness.statistics import Roughness, roughness_of, roughness_of_sample
from contact_study.physics.surfaces.base import SurfaceSection
from contact_study.physics.surfaces.realisation import BandLimitedSurface
from contact_study.physics.surfaces.scales import SurfaceScales, spectrum_of_waves
from contact_study.study.schema.keys import choice, integer, key, name_or_number, pair, quantity, text

_DEGREES = {"mean": 0, "tilt": 1, "curvature": 2}


@dataclass(frozen=True)
class MeasuredMap:
    """A map made ready.

    Attributes
    ----------
    heights : numpy.ndarray, shape (ny, nx)
        Heights about their mean (m).
    grid : Grid
        Their points.
    filled : float
        Share of the points of the crop that were missing and filled.
    unit : str
        Unit that the heights were taken to be in, and who says so.
    sample : Roughness
        What it is like by itself, before its edges were joined or faded.
    """

    heights: np.ndarray
    grid: Grid
    filled: float
    unit: str
    sample: Roughness

    @cached_property
    def roughness(self) -> Roughness:
        """What it is like, repeated."""
        return roughness_of(self.heights, self.grid)


@dataclass(frozen=True)
class MeasuredSurface(BandLimitedSurface):
    """The trigonometric polynomial through a measured map, which remembers the map."""

    measured: MeasuredMap

    @property
    def roughness(self) -> Roughness:
        return self.measured.roughness

    @property
    def sample(self) -> Roughness:
        return self.measured.sample

    @property
    def filled(self) -> float:
        return self.measured.filled


@dataclass(frozen=True, kw_only=True)
class MapFile(SurfaceSection):
    """The trigonometric polynomial through the heights of a map, less their mean."""

    words = "rigid, periodic, height map {path} less its {detrend}, edges {edges}, {size}"
    phrases = {  # noqa: RUF012
        "tilt": "mean plane",
        "curvature": "surface of second order",
        "periodic": "as they are",
        "mirror": "joined to mirror images",
        "window": "faded to the mean",
    }
    height_key = "surface.height_unit"

    path: str = key(
        text(),
        "height map: NetCDF, npy, npz, text, xyz, ESRI or WSxM ASCII, or an instrument's (extra instruments), relative "
        "to the study file",
    )
    channel: str | int | None = key(
        name_or_number(), "name or number, from 0, of the map in a file that holds several", None
    )
    height_unit: str | None = key(text(), "unit of the map's heights where its file does not say, default m", None)
    lateral_unit: str | None = key(
        text(), "unit of the map's x and y or cell size where its file does not say, default m", None
    )
    crop: tuple[tuple[float, float], tuple[float, float]] | None = key(
        pair(pair(quantity("m", minimum=0.0), names="[from, to]")), "part of the map that is taken", None
    )
    detrend: str = key(
        choice("mean", "tilt", "curvature"),
        "what is subtracted by least squares: the mean, the mean plane, or a surface of second order",
        "mean",
    )
    fill: str = key(choice("none", "harmonic"), "missing heights: refused, or continued from around them", "none")
    edges: str = key(
        choice("periodic", "mirror", "window"),
        "edges that do not meet: left as they are, joined to mirror images (twice the sides), or faded to the mean",
        "periodic",
    )
    window_share: float = key(
        quantity("1", positive=True, maximum=1.0), 'share of each side over which edges = "window" fades them', 0.2
    )
    resample: tuple[int, int] | None = key(
        pair(integer(minimum=4, maximum=2**31 - 1)),
        "points of the map for all models, by trigonometric interpolation",
        None,
    )
    lowpass: float | None = key(quantity("m", positive=True), "shortest wavelength that is kept", None)

    def __post_init__(self):
        if self.crop is not None and any(low >= high for low, high in self.crop):
            raise InputError(f"surface.crop = {[list(side) for side in self.crop]}: each [from, to] must increase")

    @property
    def map_path(self) -> str:
        return self.path

    @property
    def stated_cell(self) -> tuple[float, float] | None:
        # The file, if it says a size, says the same.
        return self.size if self.crop is None and self.edges != "mirror" else None

    def cell(self, directory: Path) -> tuple[float, float]:
        return self.stated_cell or self.measured(directory).grid.size

    def realise(self, directory: Path) -> MeasuredSurface:
        found = self.measured(directory)
        native = found.grid.shape
        return MeasuredSurface(
            found.grid.size, self.shape or native, None, fourier.transform(found.heights), native, found
        )

    def scales(self, directory: Path) -> SurfaceScales:
        found = self.measured(directory)
        grid, heights, shape = found.grid, found.heights, self.shape
        coefficients = fourier.transform(heights)
        lost = None
        if shape is not None and (shape[0] < grid.shape[0] or shape[1] < grid.shape[1]):
            lost = _moments(fourier.resize_spectrum(coefficients, grid.shape, shape), Grid(shape, grid.size))
        height, slope = _moments(coefficients, grid)
        power = grid.variances(coefficients)
        spectrum = spectrum_of_waves(grid.wavenumber.reshape(-1)[1:], power.reshape(-1)[1:])
        return SurfaceScales(
            grid.size,
            shape or grid.shape,
            height,
            slope,
            float(np.ptp(heights)),
            max(2 * max(grid.spacing), self.lowpass or 0.0),
            spectrum,
            lost,
            found.roughness,
            found.sample,
            found.unit,
            found.filled,
        )

    def measured(self, directory: Path) -> MeasuredMap:
        """The map, made ready; errors as :meth:`realise`."""
        path = directory / self.path
        state = path.stat() if path.is_file() else None
        return _measured(self, path, (state.st_mtime_ns, state.st_size) if state else None)

    def _prepared(self, path: Path) -> MeasuredMap:
        found = self._cropped(path, read_height_map(path, self.height_unit, self.size, self.channel, self.lateral_unit))
        heights = found.heights
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
        heights = preparation.filled(heights, found.spacing)
        alone, own = heights, Grid(found.shape, found.size)
        size = found.size
        if self.edges == "mirror":
            heights, size = preparation.mirrored(heights), (2 * size[0], 2 * size[1])
        elif self.edges == "window":
            heights = preparation.windowed(heights, self.window_share)
        if self.resample is not None:
            heights = fourier.interpolate(heights, self.resample)
        grid = Grid((heights.shape[0], heights.shape[1]), size)
        if self.lowpass is not None:
            heights = preparation.lowpassed(heights, grid, self._shortest(grid))
        heights = heights - heights.mean()
        heights.setflags(write=False)
        coarser = 2 * max(grid.spacing) if max(grid.spacing) > max(own.spacing) * (1 + 1e-9) else None
        sample = roughness_of_sample(alone, own, self.lowpass or coarser)
        return MeasuredMap(heights, grid, missing, found.unit, sample)

    def _cropped(self, path: Path, found: HeightMap) -> HeightMap:
        if self.crop is None:
            return found
        parts, size = [], []
        for axis, (low, high), count, step in zip("yx", self.crop, found.shape, found.spacing, strict=True):
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

    def _shortest(self, grid: Grid) -> float:
        assert self.lowpass is not None
        if self.lowpass > min(grid.size) / 2:
            raise InputError(
                f"surface.lowpass = {self.lowpass:g} m: leaves less than two waves on a side of {min(grid.size):g} m"
            )
        return self.lowpass


@lru_cache(maxsize=2)
def _measured(section: MapFile, path: Path, state: tuple[int, int] | None) -> MeasuredMap:
    """A study asks for one map several times; ``state`` tells one content of the file from another."""
    return section._prepared(path)


def _moments(coefficients: np.ndarray, grid: Grid) -> tuple[float, float]:
    """Rms height (m) and rms slope of a trigonometric polynomial, its mean apart."""
    power = grid.variances(coefficients)
    return float(np.sqrt(power.sum())), float(np.sqrt(np.sum(grid.wavenumber**2 * power)))
