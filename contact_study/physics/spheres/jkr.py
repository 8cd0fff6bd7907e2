"""Johnson, Kendall and Roberts: adhesion of no range. Proc. R. Soc. A 324, 301–313 (1971)."""

from dataclasses import dataclass

import numpy as np

from contact_study.physics.spheres.base import Number, SphereTheory, check
from contact_study.physics.spheres.hertz import hertz_force


def jkr_contact_radius(force: Number, radius: Number, contact_modulus: Number, work_of_adhesion: Number) -> Number:
    """a³ = (3R/4E*)[F + 3πwR + √(6πwRF + 9π²w²R²)], the stable branch (m).

    K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301–313 (1971). Tabor parameter above about 3; the
    force F is no lower than the pull-off.
    """
    check(radius=radius, contact_modulus=contact_modulus)
    check(0.0, work_of_adhesion=work_of_adhesion)
    wpr = 3 * np.pi * np.asarray(work_of_adhesion) * radius
    check(-0.5 * wpr, force=force)
    cube = 3 * radius / (4 * np.asarray(contact_modulus)) * (force + wpr + np.sqrt(2 * wpr * force + wpr**2))
    return np.cbrt(cube)


def jkr_force(contact_radius: Number, radius: Number, contact_modulus: Number, work_of_adhesion: Number) -> Number:
    """F = 4E*a³/3R − √(8πwE*a³) (N), both branches; arguments and source as :func:`jkr_contact_radius`."""
    crack = np.sqrt(8 * np.pi * np.asarray(work_of_adhesion) * contact_modulus * np.asarray(contact_radius) ** 3)
    return hertz_force(contact_radius, radius, contact_modulus) - crack


def jkr_approach(contact_radius: Number, radius: Number, contact_modulus: Number, work_of_adhesion: Number) -> Number:
    """δ = a²/R − √(2πwa/E*) (m), at the contact radius a (m); others and source as :func:`jkr_contact_radius`."""
    check(radius=radius, contact_modulus=contact_modulus)
    crack = np.sqrt(2 * np.pi * np.asarray(work_of_adhesion) * contact_radius / contact_modulus)
    return np.asarray(contact_radius) ** 2 / radius - crack


def jkr_pull_off_force(radius: Number, work_of_adhesion: Number) -> Number:
    """F = −(3/2)πwR under force control (N); arguments and source as :func:`jkr_contact_radius`."""
    return -1.5 * np.pi * work_of_adhesion * radius


@dataclass(frozen=True)
class JKR(SphereTheory):
    """Contact of a soft sphere under adhesion of no range, Tabor parameter above about 3.

    F = 4E*a³/3R − √(8πwE*a³) and δ = a²/R − √(2πwa/E*), both branches by the contact radius a. K. L. Johnson, K.
    Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301–313 (1971).

    Parameters
    ----------
    radius, contact_modulus, work_of_adhesion : float
        Radius R (m), contact modulus E* (Pa) and work of adhesion w (J/m²).

    Examples
    --------
    >>> from theory import JKR
    >>> f"{JKR(1e-6, 1e9, 0.05).pull_off_force:.4g}"
    '-2.356e-07'
    """

    work_of_adhesion: float

    def states(self, coordinate: Number) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        # The coordinate is the contact radius over that without load.
        constants = self.radius, self.contact_modulus, self.work_of_adhesion
        a = np.asarray(coordinate) * jkr_contact_radius(0.0, *constants)
        return np.asarray(jkr_force(a, *constants)), np.asarray(jkr_approach(a, *constants)), a
