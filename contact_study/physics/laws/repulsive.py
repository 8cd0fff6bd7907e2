"""Repulsion alone, soft: what the 9-3 law does below its equilibrium distance, and nothing beyond.

φ(d) = U [(1/3)(z0/d)⁸ − (4/3)(z0/d)² + 1] for d < z0, zero from there on, with a continuous traction; the cut is that
of J. D. Weeks, D. Chandler & H. C. Andersen, J. Chem. Phys. 54, 5237 (1971).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.errors import InputError
from contact_study.numerics.arguments import positive
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.laws.lennard_jones_9_3 import LennardJones93
from contact_study.study.schema.interaction import InteractionSection
from contact_study.study.schema.keys import key, quantity


@dataclass(frozen=True, kw_only=True)
class RepulsiveInteraction(InteractionSection):
    """Keys of a law that does not attract."""

    length: float = key(quantity("m", positive=True), "gap at which the repulsion begins")
    repulsion: float = key(
        quantity("J/m^2", positive=True), "U, its strength: that of the 9-3 law of this work of adhesion"
    )

    def __post_init__(self):
        super().__post_init__()
        for name in ("well_depth", "work_of_adhesion"):
            if getattr(self, name) is not None:
                raise InputError(f'interaction.{name}: law = "{self.law}" does not attract; give interaction.repulsion')


@dataclass(frozen=True)
class Repulsive(TractionLaw):
    """The repulsive half of the 9-3 law: ``length`` is z0, ``repulsion`` its U (J/m²); it has no work of adhesion."""

    attracts = False
    title = "repulsive"
    words = "a soft repulsion"
    section = RepulsiveInteraction

    repulsion: float

    def __post_init__(self):
        if self.work_of_adhesion:
            raise ValueError("a law that does not attract has no work of adhesion")
        positive("length", self.length, "m")
        positive("repulsion", self.repulsion, "J/m²")

    @cached_property
    def _whole(self) -> LennardJones93:
        return LennardJones93(self.repulsion, self.length)

    def _below(self, gap, values, beyond=0.0):
        return np.where(np.asarray(gap).real < self.length, values, beyond)

    def potential(self, gap):
        return self._below(gap, self._whole.potential(gap) + self.repulsion)

    def traction(self, gap):
        return self._below(gap, self._whole.traction(gap))

    def stiffness(self, gap):
        return self._below(gap, self._whole.stiffness(gap))

    def repulsive_gap(self, traction):
        return self._whole.repulsive_gap(traction)

    @property
    def equilibrium_distance(self) -> float:
        return self.length

    @property
    def peak_distance(self) -> float:
        return self.length

    @property
    def equilibrium_stiffness(self) -> float:
        return self._whole.equilibrium_stiffness

    @property
    def strongest_softening(self) -> float:
        return 0.0

    @property
    def contact_distance(self) -> float:
        return self.length

    def scaled(self, length: float, stress: float) -> "Repulsive":
        return Repulsive(0.0, self.length / length, self.repulsion / (length * stress))
