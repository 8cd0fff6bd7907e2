"""The longest range of an attraction whose contacts are those of Johnson, Kendall and Roberts.

Shorter ranges change nothing for a soft or large body but the number of grid points. The Tabor parameter is
μ = (R Δγ² / E*² r₀³)^(1/3); D. Tabor, J. Colloid Interface Sci. 58, 2 (1977).
"""

import numpy as np

# Below the one the pull-off of Maugis' sphere is within 3 % of DMT's, above the other within 1 % of JKR's.
DMT_LIKE, JKR_LIKE = 0.1, 3.0
# No attraction between solids is shorter: below it the body is not soft, and the interaction's own range decides.
ATOMIC = 0.3e-9
# A range above this part of the rms height would blur the roughness itself, and not only the edges of contact.
SHARE_OF_HEIGHT = 0.1


def tabor_parameter(radius: float, contact_modulus: float, work_of_adhesion: float, length: float) -> float:
    """μ of a law of range ``length`` (m) on an asperity of a radius of curvature (m)."""
    return float(np.cbrt(radius * (work_of_adhesion / contact_modulus) ** 2) / length)


def sphere_pull_off(radius: float, contact_modulus: float, work_of_adhesion: float, strength: float) -> float:
    """Calculate the pull-off force of a sphere over πRw, from 2 at a long range to 3/2 at a short one.

    Within 2 % of D. Maugis, J. Colloid Interface Sci. 150, 243 (1992), by λ = 2σ₀ (9R/16πwE*²)^(1/3).
    """
    scale = np.cbrt(9 * radius / (16 * np.pi * work_of_adhesion * contact_modulus**2))
    x = 4.04 * (2 * strength * scale) ** 1.4
    return float(7 / 4 - (x - 1) / (x + 1) / 4)


def longest_range(rms_curvature: float, rms_height: float, contact_modulus: float, work_of_adhesion: float) -> float:
    """Calculate the longest range (m) of JKR-like contacts, to two digits below; ValueError if flat or not soft."""
    if not rms_curvature > 0:
        raise ValueError("a flat surface has no curvature to compare a range with")
    longest = tabor_parameter(1 / rms_curvature, contact_modulus, work_of_adhesion, JKR_LIKE)
    longest = min(longest, SHARE_OF_HEIGHT * rms_height)
    if longest < ATOMIC:
        what = f"a range that leaves its contacts JKR-like, {longest:.2g} m"
        raise ValueError(f"this body is not soft: {what}, is below atomic distances")
    digits = 10 ** (np.floor(np.log10(longest)) - 1)
    return float(f"{np.floor(longest / digits * (1 + 1e-12)) * digits:.1e}")
