"""Maugis and Dugdale: a constant tension within a range, from DMT to JKR.

D. Maugis, J. Colloid Interface Sci. 150, 243–269 (1992).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.physics.spheres.base import Number, SphereTheory, check
from contact_study.physics.spheres.numbers import maugis_parameter

_THIN = 1e-2  # √(m² − 1) below which differences of nearly equal numbers are series
_WIDEST = 9.0  # ln(m − 1) at which the contact is taken for a point: its area is 1e-8 of the zone's


def maugis_dugdale_contact(maugis_parameter: float, zone: Number) -> tuple[np.ndarray, np.ndarray]:
    """F/πwR and a/(3πwR²/4E*)^(1/3) along the curve of equilibrium, from the width of the process zone.

    λ > 0 is that of :func:`maugis_parameter`, also for the source; the zone is m − 1 > 0 with m = c/a, its outer over
    its inner radius.
    """
    check(maugis_parameter=maugis_parameter, zone=zone)
    width = np.asarray(zone, dtype=float)
    square = width * (width + 2)  # m² − 1
    root = np.sqrt(square)
    angle = np.arctan(root)  # arccos(1/m), exact for thin zones, too
    difference = np.where(root < _THIN, root**3 * (1 / 3 - square / 5 + square**2 / 7), root - angle)
    quadratic = maugis_parameter / 2 * (difference + square * angle)
    linear = 4 * maugis_parameter**2 / 3 * (root * angle - width)
    a = 2 / (linear + np.sqrt(linear**2 + 4 * quadratic))
    return a**3 - maugis_parameter * a**2 * (root + (square + 1) * angle), a


def maugis_dugdale_approach(maugis_parameter: float, zone: Number, relative_radius: Number) -> np.ndarray:
    """δ/(9π²w²R/16E*²)^(1/3) at a zone and the radius :func:`maugis_dugdale_contact` gives; others as there."""
    width, a = np.asarray(zone, dtype=float), np.asarray(relative_radius)
    return a**2 - 4 / 3 * maugis_parameter * a * np.sqrt(width * (width + 2))


def maugis_dugdale_pull_off(maugis_parameter: float) -> float:
    """−F/πwR at pull-off under force control: the least load of :func:`maugis_dugdale_contact`."""
    from scipy.optimize import minimize_scalar  # slow to import

    found = minimize_scalar(
        lambda logarithm: float(maugis_dugdale_contact(maugis_parameter, np.exp(logarithm))[0]),
        bounds=(-12, 12),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return -float(found.fun)


@dataclass(frozen=True)
class MaugisDugdale(SphereTheory):
    """Contact of a sphere under a constant tension within a range, from DMT's (λ → 0) to JKR's (λ → ∞).

    The gap at the outer radius c of the process zone is w/σ₀. The curve is followed along c/a, in which it has no
    folds, on to the attraction before contact, whose tension acts on a circle. D. Maugis, J. Colloid Interface Sci.
    150, 243–269 (1992).

    Parameters
    ----------
    radius, contact_modulus, work_of_adhesion : float
        Radius R (m), contact modulus E* (Pa) and work of adhesion w (J/m²).
    strength : float
        Constant tension σ₀ (Pa).

    Examples
    --------
    >>> from theory import MaugisDugdale
    >>> sphere = MaugisDugdale(1e-6, 1e9, 0.05, 1.5e8)
    >>> f"{sphere.parameter:.3f}, {sphere.pull_off_force:.4g}"
    '4.590, -2.368e-07'
    """

    work_of_adhesion: float
    strength: float
    _start = -_WIDEST - 1

    @classmethod
    def of_parameter(cls, parameter: float) -> "MaugisDugdale":
        """Make the sphere of a λ in Maugis' units, in which πwR, the contact radius's and δ's unit are 1."""
        return cls(1.0, 0.75, 1 / np.pi, parameter / 2)

    @cached_property
    def parameter(self) -> float:
        """λ of :func:`maugis_parameter`."""
        return float(maugis_parameter(self.radius, self.contact_modulus, self.work_of_adhesion, self.strength))

    def states(self, coordinate: Number) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        # The coordinate is −ln(m − 1) in contact; before it, c over its value at touch grows from 0 to 1.
        place = np.asarray(coordinate, dtype=float)
        zone = np.exp(-np.maximum(place, -_WIDEST))
        force, a = maugis_dugdale_contact(self.parameter, zone)
        approach = maugis_dugdale_approach(self.parameter, zone, a)
        unit = np.cbrt(3 * np.pi * self.work_of_adhesion * self.radius**2 / (4 * self.contact_modulus))
        apart = place < -_WIDEST
        pulled, away = self._apart(np.clip(place + _WIDEST + 1, 0, 1) * (1 + np.exp(_WIDEST)) * a * unit)
        force, approach = force * np.pi * self.work_of_adhesion * self.radius, approach * unit**2 / self.radius
        return np.where(apart, pulled, force), np.where(apart, away, approach), np.where(apart, 0.0, a * unit)

    def _apart(self, outer: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force (N) and displacement (m) under the tension on a circle (m), whose rim has the gap w/σ₀.

        A half-space rises by 4σ₀c/πE* there.
        """
        rise = 4 * self.strength * outer / (np.pi * self.contact_modulus)
        gap = self.work_of_adhesion / self.strength
        return -np.pi * outer**2 * self.strength, outer**2 / (2 * self.radius) - rise - gap
