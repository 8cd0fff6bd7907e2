"""Attraction that fades exponentially outside a hard wall: φ(u) = −Δγ exp(−u/ρ) for gaps u >= 0.

The interaction of the contact-mechanics challenge: M. H. Müser et al., Tribol. Lett. 65, 118 (2017).
"""

from dataclasses import dataclass

import numpy as np

from contact_study.physics.laws.base import TractionLaw
from contact_study.study.schema.interaction import PlainAdhesion


@dataclass(frozen=True)
class Exponential(TractionLaw):
    """σ(u) = (Δγ/ρ) exp(−u/ρ) outside a hard wall; ``length`` is the range ρ."""

    has_wall = True
    title = "exponential"
    words = "Attraction (Δγ/ρ) exp(−u/ρ) outside a hard wall"
    counts_as_contact = "a gap of zero"
    section = PlainAdhesion

    def potential(self, gap):
        return -self.work_of_adhesion * np.exp(-np.asarray(gap) / self.length)
