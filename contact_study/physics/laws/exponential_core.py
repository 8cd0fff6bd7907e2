"""Attraction that fades exponentially, with an exponential core: σ(d) = σ0 [e^(−(d−d0)/ρ) − e^(−(d−d0)/c)].

With c = ρ/2 it is Morse's law, with c → 0 the exponential attraction outside a wall at d0.
"""

from dataclasses import dataclass

import numpy as np

from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.laws.cored import CoredInteraction, CoredLaw
from contact_study.physics.laws.exponential import Exponential


@dataclass(frozen=True, kw_only=True)
class ExponentialCoreInteraction(CoredInteraction):
    """A core shorter than the range."""

    def __post_init__(self):
        super().__post_init__()
        self._check_core(self.range, "interaction.range")


@dataclass(frozen=True)
class ExponentialCore(CoredLaw):
    """Exponential attraction of range ρ with a core."""

    title = "exponential with a core"
    words = "Attraction that fades exponentially, with an exponential core"
    section = ExponentialCoreInteraction

    def _outside_wall(self, work_of_adhesion: float) -> TractionLaw:
        return Exponential(work_of_adhesion, self.range)

    @property
    def peak_distance(self) -> float:
        return self.length + self._past_peak(1)

    @property
    def strongest_softening(self) -> float:
        return -float(self.stiffness(np.array(self.length + self._past_peak(2))))

    def _past_peak(self, order: int) -> float:
        """Where e^(−x/ρ)/ρⁿ = e^(−x/c)/cⁿ, for n = 1 the peak, for n = 2 the strongest softening."""
        ratio = self.range / self.core
        return order * float(np.log(ratio)) / (1 / self.core - 1 / self.range)
