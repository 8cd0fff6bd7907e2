"""Derjaguin, Muller and Toporov: adhesion of long range on a stiff sphere.

B. V. Derjaguin, V. M. Muller, Y. P. Toporov, J. Colloid Interface Sci. 53, 314 (1975).
"""

from dataclasses import dataclass

import numpy as np

from contact_study.physics.spheres.base import Number, SphereTheory
from contact_study.physics.spheres.hertz import hertz_contact_radius, hertz_force


def dmt_contact_radius(force: Number, radius: Number, contact_modulus: Number, work_of_adhesion: Number) -> Number:
    """Hertz's under F + 2πwR (m); arguments as :func:`jkr_contact_radius`. Tabor parameter below about 0.1.

    B. V. Derjaguin, V. M. Muller, Y. P. Toporov, J. Colloid Interface Sci. 53, 314 (1975).
    """
    return hertz_contact_radius(force - dmt_pull_off_force(radius, work_of_adhesion), radius, contact_modulus)


def dmt_pull_off_force(radius: Number, work_of_adhesion: Number) -> Number:
    """F = −2πwR (N); arguments and source as :func:`dmt_contact_radius`."""
    return -2 * np.pi * np.asarray(work_of_adhesion) * radius


@dataclass(frozen=True)
class DMT(SphereTheory):
    """Contact of a stiff sphere under adhesion of long range, Tabor parameter below about 0.1.

    F = 4E*a³/3R − 2πwR and δ = a²/R. The attraction outside of the contact is a constant force, and the contact is
    Hertz's under the sum: the form that D. Maugis, J. Colloid Interface Sci. 150, 243–269 (1992), has as his limit.
    The paper of B. V. Derjaguin, V. M. Muller, Y. P. Toporov, J. Colloid Interface Sci. 53, 314 (1975), has the same
    pull-off force. Attraction before contact, at δ < 0, is left out.

    Parameters
    ----------
    radius, contact_modulus, work_of_adhesion : float
        Radius R (m), contact modulus E* (Pa) and work of adhesion w (J/m²).

    Examples
    --------
    >>> from theory import DMT
    >>> f"{DMT(1e-6, 1e9, 0.05).pull_off_force:.4g}"
    '-3.142e-07'
    """

    work_of_adhesion: float

    def states(self, coordinate: Number) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        # The coordinate is the contact radius over that without load.
        constants = self.radius, self.contact_modulus
        a = np.asarray(coordinate) * dmt_contact_radius(0.0, *constants, self.work_of_adhesion)
        pull = dmt_pull_off_force(self.radius, self.work_of_adhesion)
        return np.asarray(hertz_force(a, *constants) + pull), a**2 / self.radius, a
