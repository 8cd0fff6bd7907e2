"""Description of the surface of a study, and warnings of a measured map.

Criteria of the warnings, each a ratio or a size that no useful surface has:

- **edges**: heights differ across an edge of the cell :data:`JUMP` times as much as from line to line inside. A
  periodic surface has 1, for scatter rarely more than 2; a map cut from a larger surface tens.
- **order**: rms heights outside :data:`HEIGHTS`, a cell above
:data:`~contact_study.physics.height_maps.height_map.WIDEST`, an rms
  slope below :data:`FLATTEST`; the usual cause is a unit taken for another.
- **noise**: the spectrum of the waves shorter than four points falls more slowly than 1/q, as noise of single points
  does and no self-affine surface (q⁻² and steeper), and they make more than a tenth of the mean square slope.
"""

from collections.abc import Sequence

import numpy as np

from contact_study.inputs.units import length
from contact_study.physics.height_maps.height_map import WIDEST
from contact_study.physics.roughness.statistics import Roughness, SelfAffineFit
from contact_study.physics.surfaces.scales import SurfaceScales
from contact_study.study.case import Case

JUMP = 4.0
HEIGHTS = (1e-12, 1e-3)
FLATTEST = 1e-4
NOISE_POWER, NOISE_SHARE = -1.0, 0.1


def described(roughness: Roughness, sample: Roughness, filled: float = 0.0) -> list[str]:
    """Describe a surface, repeated and alone (without the edges of a map), in a few lines.

    ``filled`` is the fraction of the points of a map that were missing.
    """
    grid, fit = roughness.grid, sample.fit
    lines = [
        f"{grid.shape[0]} x {grid.shape[1]} points, spacing {length(*grid.spacing)}, size {length(*grid.size)} "
        f"(y, x), {100 * filled:.3g} % filled",
        f"h_rms {length(roughness.rms_height)}, rms slope {sample.rms_slope:.4g}, rms curvature "
        f"{sample.rms_curvature:.4g} 1/m, jump at the edges {length(roughness.edge_jump)} "
        f"({roughness.edge_ratio:.3g} times that of neighbouring lines)",
    ]
    if fit is not None:
        lines.append(
            f"spectrum: {law_in_words(fit)} between wavelengths of {length(2 * np.pi / fit.roll_off)} and "
            f"{length(2 * np.pi / fit.cutoff)}"
        )
    return lines


def law_in_words(fit: SelfAffineFit) -> str:
    """Write the Hurst exponent of a law with its uncertainty, or the power of q of one that is not self-affine."""
    hurst, error = fit.hurst_exponent, fit.uncertainty
    if hurst + error >= 0 and hurst - error <= 1:
        return f"Hurst exponent {hurst:.2f} ± {error:.2f}"
    how = "steeper, as of filtered surfaces" if hurst > 1 else "flatter, as of noise"
    return f"C falls as q^{-2 - 2 * hurst:.1f} ± {2 * error:.1f}, {how}, than any self-affine surface's,"


def map_warnings(path: str, scales: SurfaceScales) -> list[str]:
    """Warn of a measured map that looks wrong; each line says what to do."""
    found, sample, notes = scales.measured, scales.sample, []
    if found is None or sample is None:
        return []
    strange = []
    if found.rms_height and not HEIGHTS[0] <= found.rms_height <= HEIGHTS[1]:
        strange.append(f"rms heights of {found.rms_height:.3g} m")
    if max(scales.size) > WIDEST:
        strange.append(f"a cell of {length(*scales.size)}")
    if 0 < sample.rms_slope < FLATTEST:
        strange.append(f"an rms slope of {sample.rms_slope:.2g}")
    if strange:
        notes.append(
            f"surface: {path} has {' and '.join(strange)}; are its units right (heights in {scales.unit}, cell of "
            f"{length(*scales.size)})?"
        )
    if found.edge_ratio > JUMP:
        notes.append(
            f"surface: the edges of {path} do not meet: heights jump by {length(found.edge_jump)} across them, "
            f"{found.edge_ratio:.3g} times as much as between neighbouring lines, and repeated the map has an rms "
            f'slope of {scales.rms_slope:.3g} in place of {sample.rms_slope:.3g}; surface.detrend = "tilt" and '
            'surface.edges = "mirror" or "window" join them'
        )
    power, share = sample.noise
    if power > NOISE_POWER and share > NOISE_SHARE:
        notes.append(
            f"surface: {path} has the spectrum of noise in single points (q^{power:.2g} below four of them), which "
            f"makes {100 * share:.0f} % of the mean square slope; surface.lowpass = "
            f'"{length(4 * max(found.grid.spacing))}" would leave it out'
        )
    return notes


def describe_maps(cases: Sequence[Case]) -> list[str]:
    """Describe each measured map of a study as it was read, each once."""
    words = (
        f"surface {case.surface.map_path}: {line}"
        for case in cases
        if (scale := case.scales).measured is not None and scale.sample is not None
        for line in described(scale.measured, scale.sample, scale.filled)
    )
    return list(dict.fromkeys(words))
