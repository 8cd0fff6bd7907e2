"""Hard wall without adhesion: a constraint, not a potential.

The surfaces may touch but not interpenetrate and exert no force at a distance (Signorini conditions): gap >= 0,
pressure >= 0, gap × pressure = 0.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_study.physics.laws.base import TractionLaw
from contact_study.study.schema.interaction import InteractionSection


@dataclass(frozen=True)
class HardWall(TractionLaw):
    """Gap >= 0, pressure >= 0, gap × pressure = 0: nothing to gain (J/m²), no length, no range, no tension.

    Contact is where the pressure is positive.
    """

    has_wall = True
    attracts = False
    title = "hard wall"
    words = "a hard wall without adhesion"
    counts_as_contact = "a positive pressure"
    section = InteractionSection

    work_of_adhesion: float = 0.0
    length: float = 0.0

    def __post_init__(self):
        if self.work_of_adhesion or self.length:
            raise ValueError("a hard wall has neither work of adhesion nor length")

    @classmethod
    def of(cls, section: InteractionSection, work_of_adhesion: float) -> "HardWall":
        return cls()

    def keys(self) -> dict[str, Any]:
        return {}

    def potential(self, gap):
        return np.zeros(np.shape(gap))

    def traction(self, gap):
        return np.zeros(np.shape(gap))

    def stiffness(self, gap):
        return np.zeros(np.shape(gap))

    def in_contact(self, gap, pressure, contact_distance):
        return pressure > 0

    @property
    def peak_distance(self) -> float:
        return 0.0

    @property
    def strongest_softening(self) -> float:
        return 0.0
