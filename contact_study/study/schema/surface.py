"""The section ``[surface]`` of a study file: the keys of each kind, its heights and its scales."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import ClassVar

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.physics.height_maps.height_map import read_height_map
from contact_study.physics.roughness.measurement import SAMPLED
from contact_study.physics.roughness.spectrum import RoughnessSpectrum, SelfAffineSpectrum, TabulatedSpectrum
from contact_study.physics.surfaces import drawn
from contact_study.physics.surfaces import surface as made
from contact_study.physics.surfaces.surface import BandLimitedSurface, Surface, SurfaceScales, spectrum_of_waves
from contact_study.study.schema import keys
from contact_study.study.schema.keys import ANGLE, FACTOR, METRES, OFFSET, TEXT, choice, integer, key, pair, quantity
from contact_study.study.schema.modes import Modes, check_carried, check_modes, spectrum_of_modes

_POINTS = pair(integer(4, 2**31 - 1))
_SIZE = pair(METRES, broadcast=True), "lateral periods (a height map may bring its own)"
_SHAPE = _POINTS, "points of the continuum grid (a height map may bring its own)"


@dataclass(frozen=True, kw_only=True)
class SurfaceSection(ABC):
    """The rigid rough surface; heights point toward the block. A kind declares its keys as fields and checks them.

    Relative paths start in ``directory``; methods raise InputError if a height map cannot be read or used.
    """

    # The surface in a sentence; names in braces are replaced by the values of keys, or their phrases.
    words: ClassVar[str]
    phrases: ClassVar[dict[str, str]] = {}
    height_key: ClassVar[str]  # to look at when the heights make no sense
    rough: ClassVar[bool] = True  # whether it has height
    periodic: ClassVar[bool] = True  # whether it continues over the edge of the cell
    absent: ClassVar[bool] = False  # a spectrum only, for theories

    kind: str = key(TEXT, "geometry of the rigid surface")
    size: tuple[float, float] | None = key(*_SIZE, None)
    shape: tuple[int, int] | None = key(*_SHAPE, None)
    offset: tuple[float, float] = key(OFFSET, "way that the roughness is moved along y and x", (0.0, 0.0))
    rotation: float = key(ANGLE, "quarter turns of the roughness from x to y", 0.0)

    @abstractmethod
    def realise(self, directory: Path) -> Surface:
        """The heights."""

    @abstractmethod
    def scales(self, directory: Path) -> SurfaceScales:
        """Scales of heights and slopes by the study alone."""

    def cell(self, directory: Path) -> tuple[float, float] | None:
        """Periods along y and x (m), None if they are not known."""
        return self.size

    @property
    def map_path(self) -> str | None:
        """File of the heights as the study writes it; None for a surface that needs none."""
        return None

    @property
    def map_keys(self) -> dict[str, str]:
        """Files of heights, by the dotted keys that name them."""
        return {} if self.map_path is None else {"surface.path": self.map_path}

    @property
    def target_spectrum(self) -> RoughnessSpectrum | None:
        """The spectrum that a random surface is a sample of."""
        return None

    @property
    def realisation(self) -> int | None:
        """Seed of a random surface."""
        return getattr(self, "seed", None)


@dataclass(frozen=True, kw_only=True)
class CellSection(SurfaceSection):
    """A surface made on a cell that the study must give."""

    size: tuple[float, float] = key(*_SIZE)
    shape: tuple[int, int] = key(*_SHAPE)


@dataclass(frozen=True, kw_only=True)
class SelfAffine(CellSection):
    """A random surface; its modes count waves on the longest side."""

    words = (
        "rigid, periodic, randomly rough, {size}: self-affine with Hurst exponent {hurst_exponent} between "
        "{roll_off_mode:or} and {cutoff_mode:or} times 2π/L, flat spectrum from {low_mode:or} to {roll_off_mode:or} "
        "times 2π/L, h_rms = {rms_height} ({normalisation})"
    )
    phrases = {"realised": "each sample exactly", "spectrum": "in the mean over samples"}  # noqa: RUF012
    height_key = "surface.rms_height"

    hurst_exponent: float = key(quantity("1", minimum=0.0, maximum=1.0), "Hurst exponent H", 0.8)
    rms_height: float = key(METRES, "root-mean-square roughness")
    low_mode: float = key(FACTOR, "q_L in units of 2π over the longest side of size", 1.0)
    roll_off_mode: float = key(FACTOR, "q_0 in units of 2π over the longest side of size", 1.0)
    cutoff_mode: float = key(FACTOR, "q_1 in units of 2π over the longest side of size")
    seed: int = key(integer(0), "random realisation", 1)
    normalisation: str = key(
        choice("spectrum", "realised"),
        "rms_height of the ensemble (spectrum) or exactly of each sample (realised)",
        "spectrum",
    )

    def __post_init__(self):
        check_modes("surface", self._modes)
        check_carried("surface", self.cutoff_mode, self.size, self.shape)

    @property
    def _modes(self) -> Modes:
        return self.low_mode, self.roll_off_mode, self.cutoff_mode

    @cached_property
    def target_spectrum(self) -> SelfAffineSpectrum:
        return spectrum_of_modes(self.hurst_exponent, self.rms_height, self._modes, self.size)

    def realise(self, directory: Path) -> Surface:
        exact = self.normalisation == "realised"
        return made.gaussian_surface(self.target_spectrum, self.size, self.shape, self.seed, exact)

    def scales(self, directory: Path) -> SurfaceScales:
        spectrum, shortest = self.target_spectrum, 2 * np.pi / self.target_spectrum.cutoff
        height, slope = spectrum.rms_height, spectrum.rms_slope
        peak = made.gaussian_peak_to_valley(height, slope, self.size[0] * self.size[1])
        return SurfaceScales(self.size, self.shape, height, slope, peak, shortest, spectrum)


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

    path: str = key(TEXT, "height map: NetCDF, npy, npz, text or an instrument's")
    channel: str | int | None = key(
        keys.NAME_OR_NUMBER, "name or number, from 0, of the map in a file that holds several", None
    )
    height_unit: str | None = key(TEXT, "unit of the map's heights where its file does not say, default m", None)
    lateral_unit: str | None = key(TEXT, "unit of the map's x and y where its file does not say, default m", None)
    crop: tuple[tuple[float, float], tuple[float, float]] | None = key(
        pair(pair(quantity("m", minimum=0.0), names="[from, to]")), "part of the map that is taken", None
    )
    detrend: str = key(
        choice("mean", "tilt", "curvature"),
        "least-squares surface that is subtracted: mean, plane or second order",
        "mean",
    )
    fill: str = key(choice("none", "harmonic"), "missing heights: refused, or continued from around them", "none")
    edges: str = key(
        choice("periodic", "mirror", "window"),
        "edges: as they are, joined to mirror images or faded to the mean",
        "periodic",
    )
    window_share: float = key(keys.SHARE, 'share of each side over which edges = "window" fades them', 0.2)
    resample: tuple[int, int] | None = key(
        _POINTS, "points of the map for all models, by trigonometric interpolation", None
    )
    lowpass: float | None = key(METRES, "shortest wavelength that is kept", None)

    @property
    def map_path(self) -> str:
        return self.path

    def __post_init__(self):
        if self.crop is not None and any(low >= high for low, high in self.crop):
            raise InputError(f"surface.crop = {[list(side) for side in self.crop]}: each [from, to] must increase")

    def cell(self, directory: Path) -> tuple[float, float]:
        # The file, if it says a size, says the same.
        stated = self.size if self.crop is None and self.edges != "mirror" else None
        return stated or self.measured(directory).grid.size

    def realise(self, directory: Path) -> Surface:
        return self.measured(directory).surface(self.shape)

    def scales(self, directory: Path) -> SurfaceScales:
        return self.measured(directory).scales(self.shape, self.lowpass)

    def measured(self, directory: Path) -> made.MeasuredMap:
        """The map, made ready."""
        path = directory / self.path
        state = path.stat() if path.is_file() else None
        return _measured(replace(self, shape=None), path, (state.st_mtime_ns, state.st_size) if state else None)


@lru_cache(maxsize=4)
def _measured(section: MapFile, path: Path, state: tuple[int, int] | None) -> made.MeasuredMap:
    """Read and prepare a map once for the realisation and the scales; ``state`` identifies the file's content."""
    whole = read_height_map(path, section.height_unit, section.size, section.channel, section.lateral_unit)
    return made.prepared_map(path, whole, section)


@dataclass(frozen=True, kw_only=True)
class DrawnSurface(MapFile):
    """A random surface of a tabulated power spectrum, below the long waves of a measured map if there is one."""

    words = "rigid, periodic, randomly rough: drawn from a tabulated power spectrum, {size}"
    height_key = "surface.spectrum_path"

    path: str | None = key(TEXT, "measured map of the long waves, kept down to lowpass; default none", None)  # type: ignore[assignment]
    spectrum_path: str | None = key(TEXT, "power spectrum: NetCDF, or text with q and C(q) a row", None)
    wavevector_unit: str | None = key(TEXT, "unit of its q, where the file does not say it", None)
    density_unit: str | None = key(TEXT, "unit of its C(q), where the file does not say it", None)
    wavevectors: tuple[float, ...] | None = key(keys.sequence(keys.PER_METRE), "rising wavevectors q of a table", None)
    density: tuple[float, ...] | None = key(
        keys.sequence(quantity("m^4", positive=True)), "C(q) at each, a power law between two, zero outside", None
    )
    bound_ratio: tuple[float, ...] | None = key(
        keys.sequence(FACTOR), "upper over lower bound of C(q) at each q, from the file", None
    )
    spectrum_bound: float = key(
        quantity("1", minimum=-5.0, maximum=5.0), "C(q) between its bounds: -1 the lower, 0 the mean, 1 the upper", 0.0
    )
    seed: int = key(integer(0), "random realisation", 1)
    shortest_wave: float | None = key(METRES, "shortest wavelength that is drawn; default two grid spacings", None)

    def __post_init__(self):
        super().__post_init__()
        if self.spectrum_path is not None:
            raise InputError("surface.spectrum_path: one table a study; it cannot be swept or overridden")
        if self.wavevectors is None or self.density is None:
            raise InputError('missing key surface.spectrum_path: kind = "spectrum" needs the file of a spectrum')
        if self.spectrum_bound and len(self.bound_ratio or ()) != len(self.wavevectors):
            raise InputError(
                f"surface.spectrum_bound = {self.spectrum_bound:g}: needs bounds of C(q) at each q; name a dataset of "
                "bem-adhesion spectrum in surface.spectrum_path"
            )
        try:
            _ = self.table
        except ValueError as error:
            raise InputError(f"surface.{error}") from None
        if self.path is not None:
            return
        for name in ("size", "shape"):
            if getattr(self, name) is None:
                raise InputError(f'missing key surface.{name}: kind = "spectrum" needs it, or a map (surface.path)')
        for name in keys.keys_of(MapFile):
            if name not in keys.keys_of(SurfaceSection) and getattr(self, name) != keys.default_of(DrawnSurface, name):
                raise InputError(f"surface.{name}: belongs to a measured map, surface.path; leave it out, or give one")

    @cached_property
    def table(self) -> TabulatedSpectrum:
        density = np.array(self.density)
        if self.spectrum_bound:  # bounds are alike above and below in ln C
            density = density * np.array(self.bound_ratio) ** (0.5 * self.spectrum_bound)
        return TabulatedSpectrum(np.array(self.wavevectors), density)

    @property
    def map_path(self) -> str | None:  # type: ignore[override]
        return self.path

    @cached_property
    def target_spectrum(self) -> RoughnessSpectrum | None:
        if self.path is not None or self.size is None or self.shape is None:
            return None
        waves, variance = drawn.drawn_waves(self.table, self.size, self.shape, self.shortest_wave)
        return spectrum_of_waves(waves.q, variance)

    def cell(self, directory: Path) -> tuple[float, float]:
        return self.size if self.path is None and self.size else super().cell(directory)

    def realise(self, directory: Path) -> Surface:
        whole = None if self.path is None else self.measured(directory)
        size, shape = (whole.grid.size, self.shape or whole.grid.shape) if whole else (self.size, self.shape)
        assert size is not None
        assert shape is not None
        waves, variance = drawn.drawn_waves(self.table, size, shape, self.shortest_wave)
        surface = drawn.drawn_surface(waves, variance, size, shape, self.seed)
        if whole is None:
            return surface
        return drawn.conditioned_surface(whole, surface, self.lowpass or SAMPLED * max(whole.grid.spacing))

    def scales(self, directory: Path) -> SurfaceScales:
        if self.target_spectrum is not None and self.size is not None and self.shape is not None:
            return drawn.scales_of(self.target_spectrum, self.size, self.shape)
        surface = self.realise(directory)
        return drawn.scales_of(surface.measured_spectrum(), surface.size, surface.shape)


@dataclass(frozen=True, kw_only=True)
class Sphere(CellSection):
    """A paraboloid in the middle of the cell; its slope jumps at the cell's edge."""

    words = "a rigid sphere of radius {radius}, {size}"
    height_key = "surface.radius"
    periodic = False

    radius: float = key(METRES, "radius of curvature of the apex")

    def realise(self, directory: Path) -> Surface:
        return made.Paraboloid(self.size, self.shape, None, self.radius)

    def scales(self, directory: Path) -> SurfaceScales:
        y2, x2 = self.size[0] ** 2, self.size[1] ** 2
        # Moments of h = −r²/2R over the rectangle: <y²> = y2/12, the variance of y² is y2²/180.
        height = float(np.sqrt((y2**2 + x2**2) / 180) / (2 * self.radius))
        slope = float(np.sqrt((y2 + x2) / 12) / self.radius)
        peak, curvature = (y2 + x2) / (8 * self.radius), 1 / self.radius
        spectrum = spectrum_of_waves(*np.hstack([made.paraboloid_waves(length, self.radius) for length in self.size]))
        return SurfaceScales(self.size, self.shape, height, slope, peak, np.inf, spectrum, apex_curvature=curvature)


@dataclass(frozen=True, kw_only=True)
class Wavy(CellSection):
    """h = amplitude · cos(2π m_y y/L_y) · cos(2π m_x x/L_x); a mode 0 leaves that axis flat."""

    words = "a rigid wavy surface of amplitude {amplitude}, modes {modes}, {size}"
    height_key = "surface.amplitude"

    amplitude: float = key(METRES, "h = amplitude·cos·cos")
    modes: tuple[int, int] = key(pair(integer(0, 2**31 - 1)), "waves along y and x", (1, 1))

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
        native = (2 * self.modes[0] + 1, 2 * self.modes[1] + 1)
        y, x = (np.cos(2 * np.pi * mode * (np.arange(n) / n)) for mode, n in zip(self.modes, native, strict=True))
        coefficients = np.fft.rfft2(self.amplitude * (y[:, None] * x[None, :])) / (native[0] * native[1])
        coefficients[0, 0] = 0.0
        return BandLimitedSurface(self.size, self.shape, None, coefficients, native)

    def scales(self, directory: Path) -> SurfaceScales:
        # <cos²> is one half along each axis that has waves.
        height = float(self.amplitude * 0.5 ** (0.5 * np.count_nonzero(self.modes)))
        q_y, q_x = (2 * np.pi * mode / length for mode, length in zip(self.modes, self.size, strict=True))
        q = float(np.hypot(q_y, q_x))
        spectrum = spectrum_of_waves(np.array([q]), np.array([height**2]))
        return SurfaceScales(self.size, self.shape, height, height * q, 2 * self.amplitude, 2 * np.pi / q, spectrum)


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


SURFACES = keys.TaggedUnion(
    "kind",
    {
        "self_affine": SelfAffine,
        "file": MapFile,
        "spectrum": DrawnSurface,
        "sphere": Sphere,
        "wavy": Wavy,
        "flat": Flat,
    },
)
register_surface = SURFACES.register
