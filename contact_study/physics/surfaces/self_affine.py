"""A Gaussian surface of a self-affine spectrum with roll-off."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from contact_study.errors import InputError
from contact_study.physics.roughness.spectrum import SelfAffineSpectrum
from contact_study.physics.surfaces.base import CellSection
from contact_study.physics.surfaces.realisation import BandLimitedSurface, Surface
from contact_study.physics.surfaces.scales import SurfaceScales
from contact_study.study.schema.keys import choice, integer, key, quantity

# Mean number of places per random surface that stand higher, or lie lower, than the peak-to-valley height allows for.
_RARE = 0.01


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
    rms_height: float = key(quantity("m", positive=True), "root-mean-square roughness")
    low_mode: float = key(quantity("1", positive=True), "q_L in units of 2π over the longest side of size", 1.0)
    roll_off_mode: float = key(quantity("1", positive=True), "q_0 in units of 2π over the longest side of size", 1.0)
    cutoff_mode: float = key(quantity("1", positive=True), "q_1 in units of 2π over the longest side of size")
    seed: int = key(integer(minimum=0), "random realisation", 1)
    normalisation: str = key(
        choice("spectrum", "realised"),
        "rms_height is that of the ensemble (spectrum) or of each sample exactly (realised)",
        "spectrum",
    )

    def __post_init__(self):
        if not self.low_mode <= self.roll_off_mode <= self.cutoff_mode or self.low_mode == self.cutoff_mode:
            raise InputError(
                f"surface.low_mode = {self.low_mode:g}, roll_off_mode = {self.roll_off_mode:g}, "
                f"cutoff_mode = {self.cutoff_mode:g}: must not decrease, and the last must exceed the first"
            )
        # Modes count waves on the longest side; every axis must resolve that wavevector below its Nyquist mode.
        longest = max(self.size)
        for points, size in zip(self.shape, self.size, strict=True):
            highest = self.cutoff_mode * size / longest
            if 2 * highest >= points:
                raise InputError(
                    f"surface.cutoff_mode = {self.cutoff_mode:g}: beyond what surface.shape = {list(self.shape)} can "
                    f"carry; use more than {int(2 * highest)} points or a smaller mode"
                )

    @cached_property
    def target_spectrum(self) -> SelfAffineSpectrum:
        unit = 2 * np.pi / max(self.size)
        return SelfAffineSpectrum(
            self.hurst_exponent,
            self.rms_height,
            self.low_mode * unit,
            self.roll_off_mode * unit,
            self.cutoff_mode * unit,
        )

    @property
    def realisation(self) -> int:
        return self.seed

    def realise(self, directory: Path) -> Surface:
        """Gaussian surface: independent complex amplitudes of variance ∝ C(q), drawn in order of |q|.

        The order makes the surface of a seed independent of ``shape`` and keeps its long waves when only
        ``cutoff_mode`` grows. The variances are scaled so that the *expected* mean square is rms_height² on this
        discrete set of modes; normalisation "realised" then scales the sample to rms_height exactly.
        """
        spectrum = self.target_spectrum
        unit_y, unit_x = 2 * np.pi / self.size[0], 2 * np.pi / self.size[1]
        # A mode on the limit belongs to the set whatever the rounding of 2π.
        highest, lowest = spectrum.cutoff * (1 + 1e-9), spectrum.low * (1 - 1e-9)
        rows, columns = int(highest / unit_y), int(highest / unit_x)
        m_y, m_x = np.meshgrid(np.arange(-rows, rows + 1), np.arange(columns + 1), indexing="ij")
        q = np.hypot(m_y * unit_y, m_x * unit_x)
        independent = (q >= lowest) & (q <= highest) & ((m_x > 0) | (m_y > 0))
        m_y, m_x, q = m_y[independent], m_x[independent], q[independent]
        if q.size == 0:
            raise InputError("surface: no mode between low_mode and cutoff_mode fits the cell")
        order = np.lexsort((m_x, m_y, np.round(q / min(unit_y, unit_x), 9)))
        m_y, m_x, q = m_y[order], m_x[order], q[order]
        draws = np.random.default_rng(self.seed).standard_normal((q.size, 2))
        variance = spectrum.density(np.clip(q, spectrum.low, spectrum.cutoff))
        variance = variance * spectrum.rms_height**2 / (2 * variance.sum())  # each mode and its conjugate
        amplitude = np.sqrt(variance / 2) * (draws[:, 0] + 1j * draws[:, 1])
        if self.normalisation == "realised":
            amplitude *= spectrum.rms_height / np.sqrt(2 * np.sum(np.abs(amplitude) ** 2))
        native = (2 * rows + 1, 2 * columns + 1)
        coefficients = np.zeros((native[0], columns + 1), complex)
        coefficients[m_y % native[0], m_x] = amplitude
        on_axis = m_x == 0
        coefficients[-m_y[on_axis] % native[0], 0] = np.conj(amplitude[on_axis])
        return BandLimitedSurface(self.size, self.shape, spectrum, coefficients, native)

    def scales(self, directory: Path) -> SurfaceScales:
        spectrum = self.target_spectrum
        height, slope = spectrum.rms_height, spectrum.rms_slope
        peak = gaussian_peak_to_valley(height, slope, self.size[0] * self.size[1])
        shortest = 2 * np.pi / spectrum.cutoff
        return SurfaceScales(self.size, self.shape, height, slope, peak, shortest, spectrum)


def gaussian_peak_to_valley(rms_height: float, rms_slope: float, area: float) -> float:
    """Highest minus lowest point (m) that few Gaussian surfaces of an area (m²) exceed."""
    # A Gaussian surface stands above u rms heights at (2π)^(−3/2) A (ξ²/2 h_rms²) u exp(−u²/2) places in the mean,
    # for large u (the Euler characteristic of the region above); ξ²/2 is the variance of the slope along one axis.
    places = area * rms_slope**2 / (2 * rms_height**2) / (2 * np.pi) ** 1.5
    u = 3.0
    for _ in range(20):  # a contraction of factor 1/u² where places are many
        u = float(np.sqrt(2 * np.log(max(places * u / _RARE, np.exp(2.0)))))
    return 2 * u * rms_height
