"""Two bodies of several parts as one height function: only the distance between the bodies matters."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.roughness.spectrum import PIECES, RadialSpectrum, RoughnessSpectrum
from contact_study.physics.roughness.statistics import Roughness, roughness_of
from contact_study.physics.surfaces.forms import Form
from contact_study.physics.surfaces.surface import BandLimitedSurface, Surface, SurfaceScales, spectrum_of_waves


@dataclass(frozen=True)
class CompositeSurface(Surface):
    """The sum of parts, each on the whole cell."""

    parts: tuple[Surface, ...]

    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        return np.sum([part.heights(shape) for part in self.parts], axis=0)

    @cached_property
    def roughness(self) -> Roughness:
        """Description of the roughness on the continuum grid, without the form if there is any roughness."""
        rough = [part.heights(self.shape) for part in self.parts if not isinstance(part, Form)]
        heights = np.sum(rough, axis=0)
        return roughness_of(heights if np.any(heights) else self.sampled, self.grid)


@dataclass(frozen=True)
class TurnedOver(Surface):
    """A surface seen from the body that it faces: x is −x."""

    of: Surface

    def heights(self, shape: tuple[int, int]) -> np.ndarray:
        return _mirrored_x(self.of.heights(shape))


def _mirrored_x(heights: np.ndarray) -> np.ndarray:
    return np.roll(heights[:, ::-1], 1, axis=1)


def _quarter_turned(heights: np.ndarray) -> np.ndarray:
    """Turn periodic heights about the origin by 90° from x to y: h'(y, x) = h(−x, y)."""
    return np.roll(heights[::-1], 1, axis=0).T


def placed(
    part: Surface,
    size: tuple[float, float],
    shape: tuple[int, int],
    offset: tuple[float, float] = (0.0, 0.0),
    rotation: float = 0.0,
    facing: bool = False,
) -> Surface:
    """Place a periodic part on a cell: ``facing`` turns it over, then it is rotated, repeated and moved, in this order.

    Parameters
    ----------
    part : Surface
        Roughness on a period of its own.
    size, shape : pair
        Periods of the cell along y and x (m), and points of its continuum grid.
    offset : pair of float
        Way along y and x (m).
    rotation : float
        Turn from x to y about the middle of a period (rad), of quarter turns.
    facing : bool
        Whether the part is of the other body, its heights outward from there.

    Returns
    -------
    Surface

    Raises
    ------
    ValueError
        If the period does not divide the cell, the rotation is no quarter turn, or the part is no sum of waves.
    """
    turns = round(rotation / (np.pi / 2)) % 4
    if abs(math.remainder(rotation, np.pi / 2)) > 1e-6:
        raise ValueError(
            f"rotation = {np.degrees(rotation):g} deg: periodic roughness fits its cell after quarter turns only, of "
            "90 deg"
        )
    if not isinstance(part, BandLimitedSurface):
        if turns or any(offset) or part.size != size:
            raise ValueError(
                "kind: only a sum of waves (self_affine, wavy, a file) can be moved, rotated or repeated; use [form]"
            )
        return TurnedOver(size, shape, None, part) if facing else part
    if not (turns or facing or any(offset)) and part.size == size:
        return part
    heights, period = part.heights(part.native_shape), part.size
    if facing:
        heights = _mirrored_x(heights)
    for _ in range(turns):
        heights, period = _quarter_turned(heights), period[::-1]
    copies = tuple(round(whole / own) for whole, own in zip(size, period, strict=True))
    for count, whole, own in zip(copies, size, period, strict=True):
        if count < 1 or not math.isclose(count * own, whole, rel_tol=1e-9):
            raise ValueError(f"size: a period of {own:g} m does not divide the side of the cell, {whole:g} m")
    # On an odd number of points no wave is cut: one at the Nyquist mode of an even number has no phase.
    odd = heights.shape[0] // 2 * 2 + 1, heights.shape[1] // 2 * 2 + 1
    coefficients = fourier.resize_spectrum(fourier.transform(heights), heights.shape, odd)
    q_y, q_x = Grid(odd, period).wavevectors
    native = odd[0] * copies[0], odd[1] * copies[1]
    repeated = np.zeros((native[0], native[1] // 2 + 1), complex)
    rows = np.rint(np.fft.fftfreq(odd[0], 1 / native[0])).astype(int)
    repeated[rows, : copies[1] * (odd[1] // 2) + 1 : copies[1]] = coefficients * np.exp(
        -1j * (q_y * offset[0] + q_x * offset[1])
    )
    return BandLimitedSurface(size, shape, None, repeated, native)


def combined_scales(
    parts: Sequence[SurfaceScales], form: Form | None, size: tuple[float, float], shape: tuple[int, int]
) -> SurfaceScales:
    """Combine scales as of independent parts, whose mean squares add."""
    every = [*parts, *([] if form is None else [form.scales])]

    def together(name: str) -> float:
        return math.hypot(*(getattr(part, name) for part in every))

    waves = [_waves_of(part.spectrum) for part in every if part.spectrum is not None]
    rough = [part.rms_curvature for part in parts]
    return SurfaceScales(
        size,
        shape,
        together("rms_height"),
        together("rms_slope"),
        sum(part.peak_to_valley for part in every),
        min(part.shortest_wave for part in every),
        spectrum_of_waves(*np.concatenate(waves, axis=1)) if waves else None,
        apex_curvature=None if form is None else math.hypot(*rough) or form.apex_curvature,
    )


def _waves_of(spectrum: RoughnessSpectrum) -> np.ndarray:
    """Wavevectors (1/m) and variances (m²) of waves with the height and slope of a spectrum, shape (2, n)."""
    if isinstance(spectrum, RadialSpectrum):
        return np.array([spectrum.wavevectors, spectrum.variances])
    edges = spectrum.band_edges(PIECES)
    height, slope = (2 * np.pi * np.diff(spectrum.moment(order, upper=edges)) for order in (1, 3))
    return np.array([np.sqrt(slope / height), height])
