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
from contact_study.physics.laws.cored import CoredLaw

RAMP = 0.05


@dataclass(frozen=True)
class Dugdale(TractionLaw):
    """Constant tension outside a hard wall.

    Parameters
    ----------
    work_of_adhesion : float
        Δγ (J/m²).
    length : float
        Reach h of the tension (m).
    ramp : float, optional
        Width w of the end of the tension over its reach.

    Examples
    --------
    >>> from bem_adhesion import Dugdale
    >>> f"{Dugdale(0.05, 1e-9).peak_tensile_stress:.3g}"
    '5e+07'
    """

    has_wall = True
    title = "Dugdale"
    words = "A constant tension out to a finite reach, outside a hard wall"
    counts_as_contact = "a gap of zero"

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


@dataclass(frozen=True)
class DugdaleCore(CoredLaw):
    """Constant tension over ``range`` from the equilibrium distance on, with an exponential repulsion.

    Parameters
    ----------
    work_of_adhesion : float
        Δγ (J/m²).
    length, range, core : float
        Equilibrium distance, reach of the tension and decay length of the repulsion (m).
    ramp : float, optional
        Width of the end of the tension over its reach.

    Examples
    --------
    >>> from bem_adhesion import DugdaleCore
    >>> DugdaleCore(0.05, 3e-10, 1e-9, 3e-11).equilibrium_distance
    3e-10
    """

    title = "Dugdale with a core"
    words = "A constant tension out to a finite reach, with an exponential core"

    ramp: float = RAMP

    def _outside_wall(self, work_of_adhesion: float) -> TractionLaw:
        return Dugdale(work_of_adhesion, self.range, self.ramp)
