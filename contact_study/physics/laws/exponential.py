"""Attraction that fades exponentially, outside a hard wall or with an exponential repulsion."""

from dataclasses import dataclass

import numpy as np

from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.laws.cored import CoredLaw


@dataclass(frozen=True)
class Exponential(TractionLaw):
    """Attraction φ(u) = −Δγ exp(−u/ρ) at gaps u >= 0 outside a hard wall.

    The interaction of the contact-mechanics challenge: M. H. Müser et al., Tribol. Lett. 65, 118 (2017).

    Parameters
    ----------
    work_of_adhesion : float
        Δγ (J/m²).
    length : float
        Range ρ (m).

    Examples
    --------
    >>> from bem_adhesion import Exponential
    >>> f"{Exponential(0.05, 1e-9).peak_tensile_stress:.3g}"
    '5e+07'
    """

    has_wall = True
    title = "exponential"
    words = "Attraction (Δγ/ρ) exp(−u/ρ) outside a hard wall"
    counts_as_contact = "a gap of zero"

    def potential(self, gap):
        return -self.work_of_adhesion * np.exp(-np.asarray(gap) / self.length)


@dataclass(frozen=True)
class ExponentialCore(CoredLaw):
    """Attraction and repulsion that both fade exponentially, σ(d) = σ0 [e^(−(d−d0)/ρ) − e^(−(d−d0)/c)].

    With c = ρ/2 it is Morse's law, with c → 0 the exponential attraction outside a wall at d0.

    Parameters
    ----------
    work_of_adhesion : float
        Δγ (J/m²).
    length, range, core : float
        Equilibrium distance d0, range ρ of the attraction and decay length c < ρ of the repulsion (m).

    Examples
    --------
    >>> from bem_adhesion import ExponentialCore
    >>> ExponentialCore(0.05, 3e-10, 1e-9, 3e-10).equilibrium_distance
    3e-10
    """

    title = "exponential with a core"
    words = "Attraction that fades exponentially, with an exponential core"

    def _outside_wall(self, work_of_adhesion: float) -> TractionLaw:
        return Exponential(work_of_adhesion, self.range)

    @property
    def peak_distance(self) -> float:
        return self.length + self._past_peak(1)

    @property
    def strongest_softening(self) -> float:
        return -float(self.stiffness(np.array(self.length + self._past_peak(2))))

    def _past_peak(self, order: int) -> float:
        """Solve e^(−x/ρ)/ρⁿ = e^(−x/c)/cⁿ: the peak for n = 1, the strongest softening for n = 2."""
        ratio = self.range / self.core
        return order * float(np.log(ratio)) / (1 / self.core - 1 / self.range)
