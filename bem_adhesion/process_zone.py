"""The length over which a law bridges the edge of a contact, and what a grid does that is coarser."""

import math

import numpy as np
from scipy.fft import next_fast_len

from contact_study.physics.laws.base import TractionLaw
from contact_study.units import length

TOO_COARSE = "grid too coarse"
"""First words of a warning."""

# A grid that resolves the process zone E*Δγ/σ_max² by at least this many points is free of lattice trapping.
POINTS_PER_PROCESS_ZONE = 4
# With fewer points a load in one step and in slow motion ends in two states, of which the second has up to this share
# less contact (docs/loading_paths.md).
POINTS_FOR_ONE_STATE, LESS_CONTACT = 1, 0.5


def process_zone(contact_modulus: float, law: TractionLaw) -> float:
    """Length E* Δγ / σ_max² over which the law bridges the edge of a contact (m), infinite without attraction."""
    if not law.attracts:
        return np.inf
    return contact_modulus * law.work_of_adhesion / law.peak_tensile_stress**2


def resolves(spacing: float, zone: float) -> bool:
    """Whether a grid spacing (m) resolves a process zone (m)."""
    return spacing * POINTS_PER_PROCESS_ZONE <= zone


def resolving_shape(size: tuple[float, float], zone: float) -> tuple[int, int]:
    """Points along y and x that resolve a process zone (m): even, of small prime factors."""
    y, x = (2 * int(next_fast_len(math.ceil(POINTS_PER_PROCESS_ZONE * side / zone / 2), real=True)) for side in size)
    return y, x


def resolved_length(law: TractionLaw, spacing: float, zone: float) -> float:
    """The law's length (m) at which a grid spacing (m) resolves its process zone, at the same work of adhesion.

    The zone, now ``zone`` (m), grows with the square of that length. It is the next larger number of two digits.
    """
    least = law.length * math.sqrt(POINTS_PER_PROCESS_ZONE * spacing / zone)
    digits = 10 ** (math.floor(math.log10(least)) - 1)
    return float(f"{math.ceil(least / digits * (1 - 1e-12)) * digits:.1e}")


def too_coarse(spacing: float, zone: float, where: str = "") -> str:
    """What a grid does that does not resolve a process zone (m), in words."""
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
