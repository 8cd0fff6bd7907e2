"""The process zone at the edge of a contact, grids that do not resolve it, and ranges whose contacts are like JKR's."""

import itertools
import math

import numpy as np

from contact_study.inputs.units import length
from contact_study.physics.laws import TractionLaw
from contact_study.physics.spheres.numbers import maugis_parameter, tabor_parameter

TOO_COARSE = "grid too coarse"  # first words of a warning
# Points per process zone E*Δγ/σ_max² from which a grid does not trap contact edges.
POINTS_PER_PROCESS_ZONE = 4
# With fewer points a load in one step and in slow motion ends in two states; the second has up to this share less
# contact (docs/hysteresis.md).
POINTS_FOR_ONE_STATE, LESS_CONTACT = 1, 0.51
# Below the one the pull-off of Maugis' sphere is within 3 % of DMT's, above the other within 1 % of JKR's.
DMT_LIKE, JKR_LIKE = 0.1, 3.0
# No attraction between solids is shorter: below it the body is not soft, and the interaction's own range decides.
ATOMIC = 0.3e-9
# A range above this part of the rms height would blur the roughness itself, and not only the edges of contact.
SHARE_OF_HEIGHT = 0.1


def process_zone(contact_modulus: float, law: TractionLaw) -> float:
    """Return the length E* Δγ / σ_max² of attraction at the edge of a contact (m), infinite without attraction."""
    if not law.attracts:
        return np.inf
    return contact_modulus * law.work_of_adhesion / law.peak_tensile_stress**2


def jump_number(radius: float, contact_modulus: float, law: TractionLaw) -> float:
    """Return x, Maugis' λ of an asperity of a radius (m) over that from which one jumps, 0 without attraction.

    Its square is JKR's radius without load over the process zone, but for a factor of the law.
    """
    if not law.attracts:
        return 0.0
    number = maugis_parameter(radius, contact_modulus, law.work_of_adhesion, law.peak_tensile_stress)
    return float(number) / law.jump_onset


def resolves(spacing: float, zone: float) -> bool:
    """Return whether a grid spacing (m) resolves a process zone (m)."""
    return spacing * POINTS_PER_PROCESS_ZONE <= zone


def resolving_shape(size: tuple[float, float], zone: float) -> tuple[int, int]:
    """Return points along y and x that resolve a process zone (m): even, with small prime factors."""
    least = (math.ceil(POINTS_PER_PROCESS_ZONE * side / zone / 2) for side in size)
    # Numbers without a prime factor but 2, 3 and 5 divide a high power of 30.
    y, x = (2 * next(half for half in itertools.count(first) if 30**50 % half == 0) for first in least)
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


def sphere_pull_off(radius: float, contact_modulus: float, work_of_adhesion: float, strength: float) -> float:
    """Calculate the pull-off force of a sphere over πRw, from 2 at a long range to 3/2 at a short one.

    A fit in Maugis' λ, within 2 % of D. Maugis, J. Colloid Interface Sci. 150, 243 (1992).
    """
    x = 4.04 * maugis_parameter(radius, contact_modulus, work_of_adhesion, strength) ** 1.4
    return float(7 / 4 - (x - 1) / (x + 1) / 4)


def longest_range(rms_curvature: float, rms_height: float, contact_modulus: float, work_of_adhesion: float) -> float:
    """Calculate the longest range (m) of JKR-like contacts, to two digits below; ValueError if flat or not soft."""
    if not rms_curvature > 0:
        raise ValueError("a flat surface has no curvature to compare a range with")
    # μ is inversely proportional to the range.
    longest = float(tabor_parameter(1 / rms_curvature, contact_modulus, work_of_adhesion, JKR_LIKE))
    longest = min(longest, SHARE_OF_HEIGHT * rms_height)
    if longest < ATOMIC:
        what = f"a range that leaves its contacts JKR-like, {longest:.2g} m"
        raise ValueError(f"this body is not soft: {what}, is below atomic distances")
    digits = 10 ** (np.floor(np.log10(longest)) - 1)
    return float(f"{np.floor(longest / digits * (1 + 1e-12)) * digits:.1e}")
