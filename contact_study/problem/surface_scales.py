"""What a study alone says of a surface's heights and slopes, before any surface is made.

Every realisation of a random surface gets the same numbers, so that what is chosen from them, such as the bins of the
distributions, is equal for all seeds.
"""

from dataclasses import dataclass

import numpy as np

from contact_study.fields import fourier
from contact_study.fields.grid import Grid
from contact_study.problem.case import Case
from contact_study.problem.height_map import HeightMap, read_height_map
from contact_study.problem.sections import SurfaceSection
from contact_study.problem.study import Study
from contact_study.problem.surface import target_spectrum

# Mean number of places per random surface that stand higher, or lie lower, than the peak-to-valley height allows for.
_RARE = 0.01


@dataclass(frozen=True)
class SurfaceScales:
    """Scales of a surface.

    Attributes
    ----------
    size : tuple of float
        Periods along y and x (m).
    shape : tuple of int
        Points of the continuum grid.
    rms_height : float
        Root-mean-square height (m).
    rms_slope : float
        √<|∇h|²>.
    peak_to_valley : float
        Highest minus lowest point (m); of a random surface one that few realisations exceed.
    shortest_wave : float
        Wavelength of the finest roughness (m), infinite if there is none.
    lost : tuple of float or None
        Height and slope of a map, as above, on a ``shape`` that cannot carry all of its waves.
    """

    size: tuple[float, float]
    shape: tuple[int, int]
    rms_height: float
    rms_slope: float
    peak_to_valley: float
    shortest_wave: float
    lost: tuple[float, float] | None = None

    @property
    def pixel(self) -> float:
        """Largest grid spacing (m)."""
        return max(Grid(self.shape, self.size).spacing)


def scales_of(study: Study) -> tuple[SurfaceScales, ...]:
    """Scales of the surface of each case; each section is looked at, and each height map read, once.

    Raises
    ------
    InputError
        If a height map cannot be used.
    """
    known: dict[SurfaceSection, SurfaceScales] = {}
    for case in study.cases:
        if case.surface not in known:
            known[case.surface] = _scales(case)
    return tuple(known[case.surface] for case in study.cases)


def _scales(case: Case) -> SurfaceScales:
    section = case.surface
    if case.height_map is not None:
        return _of_map(read_height_map(case.height_map, section.height_unit, section.size), section.shape)
    size, shape = section.size, section.shape
    assert size is not None  # checked by SurfaceSection
    assert shape is not None
    if section.kind == "self_affine":
        return _of_spectrum(section, size, shape)
    if section.kind == "sphere":
        assert section.radius is not None
        y2, x2, radius = size[0] ** 2, size[1] ** 2, section.radius
        # Moments of h = −r²/2R over the rectangle: <y²> = y2/12, the variance of y² is y2²/180.
        height = np.sqrt((y2**2 + x2**2) / 180) / (2 * radius)
        slope = np.sqrt((y2 + x2) / 12) / radius
        return SurfaceScales(size, shape, float(height), float(slope), (y2 + x2) / (8 * radius), float("inf"))
    if section.kind == "wavy":
        return _of_waves(section, size, shape)
    return SurfaceScales(size, shape, 0.0, 0.0, 0.0, float("inf"))


def _of_spectrum(section: SurfaceSection, size: tuple[float, float], shape: tuple[int, int]) -> SurfaceScales:
    spectrum = target_spectrum(section)
    height, slope = spectrum.rms_height, spectrum.rms_slope
    # A Gaussian surface stands above u rms heights at (2π)^(−3/2) A (ξ²/2 h_rms²) u exp(−u²/2) places in the mean, for
    # large u (the Euler characteristic of the region above); ξ²/2 is the variance of the slope along one axis.
    places = size[0] * size[1] * slope**2 / (2 * height**2) / (2 * np.pi) ** 1.5
    u = 3.0
    for _ in range(20):  # a contraction of factor 1/u² where places are many
        u = float(np.sqrt(2 * np.log(max(places * u / _RARE, np.exp(2.0)))))
    return SurfaceScales(size, shape, height, slope, 2 * u * height, 2 * np.pi / spectrum.cutoff)


def _of_waves(section: SurfaceSection, size: tuple[float, float], shape: tuple[int, int]) -> SurfaceScales:
    assert section.amplitude is not None
    q_y, q_x = (2 * np.pi * mode / length for mode, length in zip(section.modes, size, strict=True))
    # <cos²> is one half along each axis that has waves.
    height = section.amplitude * 0.5 ** (0.5 * np.count_nonzero(section.modes))
    wavenumber = float(np.hypot(q_y, q_x))
    return SurfaceScales(
        size, shape, float(height), float(height) * wavenumber, 2 * section.amplitude, 2 * np.pi / wavenumber
    )


def _of_map(height_map: HeightMap, shape: tuple[int, int] | None) -> SurfaceScales:
    heights, size = height_map.heights, height_map.size
    grid = Grid(heights.shape, size)
    coefficients = fourier.transform(heights)
    lost = None
    if shape is not None and (shape[0] < heights.shape[0] or shape[1] < heights.shape[1]):
        lost = _moments(fourier.resize_spectrum(coefficients, heights.shape, shape), Grid(shape, size))
    height, slope = _moments(coefficients, grid)
    peak_to_valley = float(np.ptp(heights))
    return SurfaceScales(size, shape or grid.shape, height, slope, peak_to_valley, 2 * max(grid.spacing), lost)


def _moments(coefficients: np.ndarray, grid: Grid) -> tuple[float, float]:
    """Rms height (m) and rms slope of a trigonometric polynomial, its mean apart."""
    power = grid.multiplicity * np.abs(coefficients) ** 2
    power[0, 0] = 0.0
    return float(np.sqrt(power.sum())), float(np.sqrt(np.sum(grid.wavenumber**2 * power)))
