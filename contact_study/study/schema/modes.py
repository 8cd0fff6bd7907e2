"""Modes of a self-affine spectrum, which count waves on the longest side of a cell: of heights and of adhesion maps."""

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.physics.roughness.spectrum import SelfAffineSpectrum

Modes = tuple[float, float, float]  # low, roll-off, cutoff


def check_modes(section: str, modes: Modes) -> None:
    """Raise InputError unless the modes of a section follow each other."""
    low, roll_off, cutoff = modes
    if not low <= roll_off <= cutoff or low == cutoff:
        raise InputError(
            f"{section}.low_mode = {low:g}, roll_off_mode = {roll_off:g}, cutoff_mode = {cutoff:g}: must not decrease, "
            "and the last must exceed the first"
        )


def check_carried(section: str, cutoff: float, size: tuple[float, float], shape: tuple[int, int]) -> None:
    """Raise InputError if a grid cannot carry the waves of a cutoff mode; ``size`` (m) and ``shape`` along y and x."""
    for points, side in zip(shape, size, strict=True):
        highest = cutoff * side / max(size)  # must lie below the axis' Nyquist mode
        if 2 * highest >= points:
            raise InputError(
                f"{section}.cutoff_mode = {cutoff:g}: beyond what surface.shape = {list(shape)} can carry; use more "
                f"than {int(2 * highest)} points or a smaller mode"
            )


def spectrum_of_modes(hurst_exponent: float, rms: float, modes: Modes, size: tuple[float, float]) -> SelfAffineSpectrum:
    """Spectrum of modes on a cell (m)."""
    return SelfAffineSpectrum(hurst_exponent, rms, *(mode * (2 * np.pi / max(size)) for mode in modes))
