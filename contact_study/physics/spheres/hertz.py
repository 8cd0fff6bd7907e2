"""Hertz: no adhesion. H. Hertz, J. reine angew. Math. 92, 156 (1882)."""

from dataclasses import dataclass

import numpy as np

from contact_study.physics.spheres.base import Number, SphereTheory, check


def hertz_force(contact_radius: Number, radius: Number, contact_modulus: Number) -> Number:
    """F = 4E*a³/3R (N), the inverse of :func:`hertz_contact_radius`."""
    return 4 * contact_modulus * np.asarray(contact_radius) ** 3 / (3 * radius)


def hertz_contact_radius(force: Number, radius: Number, contact_modulus: Number) -> Number:
    """a = (3FR/4E*)^(1/3) (m), F >= 0. H. Hertz, J. reine angew. Math. 92, 156 (1882)."""
    check(0.0, force=force)
    check(radius=radius, contact_modulus=contact_modulus)
    return np.cbrt(3 * np.asarray(force) * radius / (4 * np.asarray(contact_modulus)))


def hertz_approach(force: Number, radius: Number, contact_modulus: Number) -> Number:
    """δ = a²/R (m); arguments and source as :func:`hertz_contact_radius`."""
    return hertz_contact_radius(force, radius, contact_modulus) ** 2 / radius


def hertz_pressure(distance: Number, force: Number, radius: Number, contact_modulus: Number) -> np.ndarray:
    """p = (2E*a/πR) √(1 − r²/a²), zero outside (Pa), at the distance r from the axis (m).

    Other arguments and source as :func:`hertz_contact_radius`.
    """
    a = hertz_contact_radius(force, radius, contact_modulus)
    peak = 2 * contact_modulus * a / (np.pi * radius)
    return peak * np.sqrt(np.clip(1 - (np.asarray(distance) / a) ** 2, 0, None))


@dataclass(frozen=True)
class Hertz(SphereTheory):
    """Contact of a sphere without adhesion, F = 4E*a³/3R and δ = a²/R.

    H. Hertz, J. reine angew. Math. 92, 156 (1882).

    Parameters
    ----------
    radius, contact_modulus : float
        Radius R (m) and contact modulus E* (Pa).

    Examples
    --------
    >>> from theory import Hertz
    >>> f"{Hertz(1e-6, 0.75e9).at_force(1e-6)[1]:.3g}"
    '1e-08'
    """

    def states(self, coordinate: Number) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        # The coordinate is the contact radius over that of the sphere.
        a = np.asarray(coordinate) * self.radius
        return np.asarray(hertz_force(a, self.radius, self.contact_modulus)), a**2 / self.radius, a
