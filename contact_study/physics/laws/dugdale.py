"""A constant tension out to a finite reach, outside a hard wall: Dugdale's law, that of Maugis' sphere.

σ = Δγ/h for gaps below h and nothing beyond (D. Maugis, J. Colloid Interface Sci. 150, 243 (1992)). A tension that ends
at one point has no stiffness there, and a grid's contact then follows no smooth path. The end is therefore a ramp,

    σ(u) = σ0 / (1 + e^((u−h)/w)),    w = ramp × h,

nine tenths to one tenth over 4.4 w. The work of adhesion stays Δγ, σ0 = Δγ/(w ln(1 + e^(h/w))), at the default ramp of
0.05 Δγ/h to 1e-10.
"""

from dataclasses import dataclass

import numpy as np

from contact_study.physics.laws.base import TractionLaw
from contact_study.study.schema.interaction import PlainAdhesion
from contact_study.study.schema.keys import key, quantity

RAMP = 0.05


def ramp_key() -> float:
    """The key ``ramp`` of a section."""
    number: float = key(
        quantity("1", positive=True, maximum=0.5), "width of the end of the constant tension, over its reach", RAMP
    )
    return number


@dataclass(frozen=True, kw_only=True)
class DugdaleInteraction(PlainAdhesion):
    """Keys of Dugdale's law."""

    ramp: float = ramp_key()


@dataclass(frozen=True)
class Dugdale(TractionLaw):
    """Constant tension outside a hard wall; ``length`` is its reach h, ``ramp`` the width of its end over h."""

    has_wall = True
    title = "Dugdale"
    words = "A constant tension out to a finite reach, outside a hard wall"
    counts_as_contact = "a gap of zero"
    section = DugdaleInteraction

    ramp: float = RAMP

    @property
    def width(self) -> float:
        """w of the ramp (m)."""
        return self.ramp * self.length

    def _past(self, gap):
        """(u − h)/w."""
        return (np.asarray(gap) - self.length) / self.width

    @property
    def plateau(self) -> float:
        """σ0 (Pa)."""
        return self.work_of_adhesion / (self.width * float(np.logaddexp(0, 1 / self.ramp)))

    def potential(self, gap):
        x = self._past(gap)
        # ln(1 + e^−x), for complex gaps too, without overflow.
        rest = np.log1p(np.exp(np.where(np.real(x) > 0, -x, x)))
        return -self.plateau * self.width * (rest + np.where(np.real(x) > 0, 0, -x))

    def _held(self, gap):
        """1/(1 + e^x), to the last digit far out too, where a core still compares with it."""
        return np.exp(-np.logaddexp(0, self._past(gap)))

    def traction(self, gap):
        return self.plateau * self._held(gap)

    def stiffness(self, gap):
        held = self._held(gap)
        return -self.plateau / self.width * held * (1 - held)

    @property
    def peak_distance(self) -> float:
        return 0.0

    @property
    def strongest_softening(self) -> float:
        return 0.25 * self.plateau / self.width
