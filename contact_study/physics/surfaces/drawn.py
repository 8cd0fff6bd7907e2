"""Random surfaces drawn from a tabulated power spectrum, alone or below the long waves of a measured map."""

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.roughness.spectrum import RoughnessSpectrum, TabulatedSpectrum
from contact_study.physics.surfaces.surface import (
    BandLimitedSurface,
    MeasuredMap,
    SurfaceScales,
    Waves,
    gaussian_peak_to_valley,
    spectrum_of_waves,
    waves_between,
)


def drawn_waves(
    spectrum: TabulatedSpectrum, size: tuple[float, float], shape: tuple[int, int], shortest: float | None
) -> tuple[Waves, np.ndarray]:
    """Modes of a cell that its grid carries and the table covers, with the expected variance of each (m²).

    ``shortest`` is the shortest wavelength (m), by default two grid spacings.
    """
    # The mode of half the points of a side is real, and none of a random surface.
    carried = min(2 * np.pi / side * ((points - 1) // 2) for side, points in zip(size, shape, strict=True))
    low, high = spectrum.limits
    highest = min(high, carried if shortest is None else 2 * np.pi / shortest)
    if highest > carried * (1 + 1e-9):
        raise InputError(
            f"surface.shortest_wave = {shortest:g} m: surface.shape = {list(shape)} carries waves down to "
            f"{2 * np.pi / carried:.4g} m; use more points or a longer wave"
        )
    waves = waves_between(size, low, highest)
    if waves.q.size == 0:
        raise InputError(
            f"surface.spectrum_path: the spectrum ends at wavelengths of {2 * np.pi / high:.4g} and "
            f"{2 * np.pi / low:.4g} m, between which no wave fits surface.size = {size[0]:g} x {size[1]:g} m and "
            f"surface.shape = {list(shape)}"
        )
    cell = (2 * np.pi) ** 2 / (size[0] * size[1])  # area of a wave in the plane of wavevectors
    return waves, 2 * cell * spectrum.density_at(np.clip(waves.q, low, high))


def drawn_surface(
    waves: Waves, variance: np.ndarray, size: tuple[float, float], shape: tuple[int, int], seed: int
) -> BandLimitedSurface:
    """Draw a Gaussian surface of expected variances (m²) of its modes, in order of |q|, which a seed thus fixes."""
    draws = np.random.default_rng(seed).standard_normal((waves.q.size, 2))
    amplitude = 0.5 * np.sqrt(variance) * (draws[:, 0] + 1j * draws[:, 1])
    return BandLimitedSurface(
        size, shape, spectrum_of_waves(waves.q, variance), waves.coefficients(amplitude), waves.native
    )


def conditioned_surface(measured: MeasuredMap, drawn: BandLimitedSurface, shortest: float) -> BandLimitedSurface:
    """Replace the waves of a drawn surface down to a wavelength (m) by those of a measured map of the same cell."""
    limit = 2 * np.pi / shortest * (1 + 1e-9)
    for side, points in zip(drawn.size, drawn.shape, strict=True):
        if limit * side / np.pi > points:
            raise InputError(
                f"surface.shape = {list(drawn.shape)}: does not carry the map's waves down to {shortest:.4g} m "
                f"(surface.lowpass); use more than {int(limit * side / np.pi)} points on {side:.4g} m"
            )
    own, native = measured.grid, drawn.native_shape
    # Odd numbers of points have no mode without a sign.
    shape = (max(native[0], own.shape[0] | 1), max(native[1], own.shape[1] | 1))
    short = fourier.resize_spectrum(drawn.coefficients, native, shape) * (Grid(shape, own.size).wavenumber > limit)
    if not short.any():
        raise InputError(f"surface.spectrum_path: has no waves below the map's, {shortest:.4g} m (surface.lowpass)")
    long = fourier.transform(measured.heights) * (own.wavenumber <= limit)
    coefficients = short + fourier.resize_spectrum(long, own.shape, shape)
    return BandLimitedSurface(drawn.size, drawn.shape, None, coefficients, shape)


def scales_of(spectrum: RoughnessSpectrum, size: tuple[float, float], shape: tuple[int, int]) -> SurfaceScales:
    """Scales of a Gaussian surface by its spectrum."""
    height, slope = float(np.sqrt(spectrum.mean_square_height)), spectrum.rms_slope
    peak = gaussian_peak_to_valley(height, slope, size[0] * size[1])
    return SurfaceScales(size, shape, height, slope, peak, 2 * np.pi / spectrum.limits[1], spectrum)
