"""The process zone of a law at the edge of a contact, and grids that do not resolve it."""

import math

import numpy as np

from contact_study.inputs.units import length
from contact_study.physics.laws import TractionLaw

TOO_COARSE = "grid too coarse"
"""First words of a warning."""

# Points per process zone E*Δγ/σ_max² from which a grid does not trap contact edges.
POINTS_PER_PROCESS_ZONE = 4
# With fewer points a load in one step and in slow motion ends in two states; the second has up to this share less
# contact (docs/hysteresis.md).
POINTS_FOR_ONE_STATE, LESS_CONTACT = 1, 0.51


def process_zone(contact_modulus: float, law: TractionLaw) -> float:
    """Return the length E* Δγ / σ_max² of attraction at the edge of a contact (m), infinite without attraction."""
    if not law.attracts:
        return np.inf
    return contact_modulus * law.work_of_adhesion / law.peak_tensile_stress**2


def resolves(spacing: float, zone: float) -> bool:
    """Return whether a grid spacing (m) resolves a process zone (m)."""
    return spacing * POINTS_PER_PROCESS_ZONE <= zone


def resolving_shape(size: tuple[float, float], zone: float) -> tuple[int, int]:
    """Return points along y and x that resolve a process zone (m): even, with small prime factors."""
    from scipy.fft import next_fast_len  # slow to import

    y, x = (2 * int(next_fast_len(math.ceil(POINTS_PER_PROCESS_ZONE * side / zone / 2), real=True)) for side in size)
    return y, x


def resolved_length(law: TractionLaw, spacing: float, zone: float) -> float:
    """Return the law's length (m), to two digits, at which a spacing (m) resolves its zone, now ``zone`` (m)."""
    least = law.length * math.sqrt(POINTS_PER_PROCESS_ZONE * spacing / zone)
    digits = 10 ** (math.floor(math.log10(least)) - 1)
    return float(f"{math.ceil(least / digits * (1 - 1e-12)) * digits:.1e}")


def too_coarse(spacing: float, zone: float, where: str = "") -> str:
    """Describe the effect of a grid that does not resolve a process zone (m)."""
    head = f"{TOO_COARSE}: its spacing is {length(spacing)}"
    if spacing * POINTS_FOR_ONE_STATE > zone:
        return (
            f"{head}, the process zone {length(zone)}{where}: contact edges are trapped by the grid; pull-off is the "
            f"grid's, and slow loading ends with up to {100 * LESS_CONTACT:.0f} % less contact than one step"
        )
    return (
        f"{head}, a quarter of the process zone {length(zone / 4)}{where}: contact edges may be trapped by the grid, "
        "and area and pull-off with them"
    )
