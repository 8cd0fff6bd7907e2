"""Laws of exponentials: attraction outside a hard wall or with a repulsion in its place, and Morse's law."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contact_study.physics.laws.base import LawAtLength, TractionLaw

RAMP = 0.05
_INVERSE_STEPS = 12


@dataclass(frozen=True)
class Exponential(TractionLaw):
    """Attraction φ(u) = −Δγ exp(−u/ρ) at gaps u >= 0 outside a hard wall.

    The interaction of the contact-mechanics challenge: M. H. Müser et al., Tribol. Lett. 65, 118 (2017).

    Parameters
    ----------
    work_of_adhesion, length : float
        Δγ (J/m²) and range ρ (m).

    Examples
    --------
    >>> from bem_adhesion import Exponential
    >>> f"{Exponential(0.05, 1e-9).peak_tensile_stress:.3g}"
    '5e+07'
    """

    has_wall = True
    jump_onset = 1.14
    title = "exponential"
    words = "Attraction (Δγ/ρ) exp(−u/ρ) outside a hard wall"
    counts_as_contact = "a gap of zero"

    def potential(self, gap):
        return -self.work_of_adhesion * np.exp(-np.asarray(gap) / self.length)


@dataclass(frozen=True)
class Dugdale(TractionLaw):
    """Constant tension outside a hard wall: Dugdale's law, that of Maugis' sphere.

    σ = Δγ/h for gaps below h and nothing beyond (D. Maugis, J. Colloid Interface Sci. 150, 243 (1992)). Its end is a
    ramp, as a grid's contact follows no smooth path where tension has no stiffness: σ(u) = σ0/(1 + e^((u−h)/w)) with
    w = ramp × h falls from nine tenths to one tenth over 4.4 w; σ0 = Δγ/(w ln(1 + e^(h/w))) keeps Δγ.

    Parameters
    ----------
    work_of_adhesion, length, ramp : float
        Δγ (J/m²), reach h of the tension (m) and width w of its end over the reach.

    Examples
    --------
    >>> from bem_adhesion import Dugdale
    >>> f"{Dugdale(0.05, 1e-9).peak_tensile_stress:.3g}"
    '5e+07'
    """

    has_wall = True
    jump_onset = 0.89
    title = "Dugdale"
    words = "A constant tension out to a finite reach, outside a hard wall"
    counts_as_contact = "a gap of zero"
    ramp: float = RAMP

    @property
    def width(self) -> float:
        """w of the ramp (m)."""
        return self.ramp * self.length

    @property
    def plateau(self) -> float:
        """σ0 (Pa)."""
        return self.work_of_adhesion / (self.width * float(np.logaddexp(0, 1 / self.ramp)))

    def _past(self, gap):
        """(u − h)/w."""
        return (np.asarray(gap) - self.length) / self.width

    def _held(self, gap):
        """1/(1 + e^((u−h)/w)), to the last digit far out too, where a core still compares with it."""
        return np.exp(-np.logaddexp(0, self._past(gap)))

    def potential(self, gap):
        x = self._past(gap)
        # ln(1 + e^−x), for complex gaps too, without overflow.
        rest = np.log1p(np.exp(np.where(np.real(x) > 0, -x, x)))
        return -self.plateau * self.width * (rest + np.where(np.real(x) > 0, 0, -x))

    def traction(self, gap):
        return self.plateau * self._held(gap)

    def stiffness(self, gap):
        held = self._held(gap)
        return -self.plateau / self.width * held * (1 - held)

    @property
    def strongest_softening(self) -> float:
        return 0.25 * self.plateau / self.width


@dataclass(frozen=True)
class CoredLaw(LawAtLength):
    """An exponential repulsion in place of a wall at d0, σ(d) = σ_wall(x) − σ_wall(0) e^(−x/c) with x = d − d0."""

    diverges = False
    own_lengths = ("range", "core")
    range: float
    core: float

    @property
    def _wall(self) -> TractionLaw:
        """The law with the wall, Δγ = 1."""
        return Exponential(1.0, self.range)

    @cached_property
    def _attraction(self) -> TractionLaw:
        """The law with the wall whose Δγ leaves this one's beside the core."""
        share = 1 - self.core * float(self._wall.traction(np.array(0.0)))
        return replace(self._wall, work_of_adhesion=self.work_of_adhesion / share)

    @cached_property
    def _repulsion(self) -> float:
        """Pressure of the core at equilibrium."""
        return float(self._attraction.traction(np.array(0.0)))

    def potential(self, gap):
        x = np.asarray(gap) - self.length
        return self._attraction.potential(x) + self.core * self._repulsion * np.exp(-x / self.core)

    def traction(self, gap):
        x = np.asarray(gap) - self.length
        return self._attraction.traction(x) - self._repulsion * np.exp(-x / self.core)

    def stiffness(self, gap):
        x = np.asarray(gap) - self.length
        return self._attraction.stiffness(x) + self._repulsion / self.core * np.exp(-x / self.core)

    def repulsive_gap(self, traction):
        # x = −c ln((σ_wall(x) − σ)/σ_wall(0)): nearly linear, the attraction changing little over a core.
        wanted = -np.asarray(traction, dtype=float)
        x = np.zeros(wanted.shape)
        for _ in range(_INVERSE_STEPS):
            pressure = wanted + self._attraction.traction(x)
            excess = x / self.core + np.log(pressure / self._repulsion)
            x = x - excess / (1 / self.core + self._attraction.stiffness(x) / pressure)
        return self.length + np.minimum(x, 0.0)

    def lowest(self, function):
        return self.length + self._attraction.lowest(lambda x: function(self.length + x))  # in units of the range


@dataclass(frozen=True)
class ExponentialCore(CoredLaw):
    """Attraction and repulsion that both fade exponentially, σ(d) = σ0 [e^(−(d−d0)/ρ) − e^(−(d−d0)/c)].

    With c = ρ/2 it is Morse's law, with c → 0 the exponential attraction outside a wall at d0.

    Parameters
    ----------
    work_of_adhesion, length, range, core : float
        Δγ (J/m²), equilibrium distance d0, range ρ of the attraction and decay length c < ρ of the repulsion (m).

    Examples
    --------
    >>> from bem_adhesion import ExponentialCore
    >>> ExponentialCore(0.05, 3e-10, 1e-9, 3e-10).equilibrium_distance
    3e-10
    """

    title = "exponential with a core"
    words = "Attraction that fades exponentially, with an exponential core"
    jump_onset = Exponential.jump_onset

    def _past_peak(self, order: int) -> float:
        """Solve e^(−x/ρ)/ρⁿ = e^(−x/c)/cⁿ: the peak for n = 1, the strongest softening for n = 2."""
        return order * float(np.log(self.range / self.core)) / (1 / self.core - 1 / self.range)

    @property
    def peak_distance(self) -> float:
        return self.length + self._past_peak(1)

    @property
    def strongest_softening(self) -> float:
        return -float(self.stiffness(np.array(self.length + self._past_peak(2))))


@dataclass(frozen=True)
class DugdaleCore(CoredLaw):
    """Constant tension over ``range`` from the equilibrium distance on, with an exponential repulsion.

    Parameters
    ----------
    work_of_adhesion, length, range, core, ramp : float
        Δγ (J/m²), equilibrium distance, reach of the tension, decay length of the repulsion (m) and, over the reach,
        width of the tension's end.

    Examples
    --------
    >>> from bem_adhesion import DugdaleCore
    >>> DugdaleCore(0.05, 3e-10, 1e-9, 3e-11).equilibrium_distance
    3e-10
    """

    title = "Dugdale with a core"
    words = "A constant tension out to a finite reach, with an exponential core"
    jump_onset = Dugdale.jump_onset
    ramp: float = RAMP

    @property
    def _wall(self) -> TractionLaw:
        return Dugdale(1.0, self.range, self.ramp)


@dataclass(frozen=True)
class Morse(LawAtLength):
    """Morse's law, σ(d) = (2Δγ/w)[y − y²] with y = e^(−(d−d0)/w), for bonds across an interface.

    φ(d) = Δγ [y² − 2y]; P. M. Morse, Phys. Rev. 34, 57 (1929). Its repulsion is finite at a gap of zero.

    Parameters
    ----------
    work_of_adhesion, length, range : float
        Δγ (J/m²), equilibrium distance d0 and range w of the attraction (m).

    Examples
    --------
    >>> from bem_adhesion import Morse
    >>> f"{Morse(0.05, 3e-10, 1e-10).peak_tensile_stress:.3g}"
    '2.5e+08'
    """

    title = "Morse"
    words = "Morse's law"
    diverges = False
    own_lengths = ("range",)
    range: float

    def _decay(self, gap):
        return np.exp(-(np.asarray(gap) - self.length) / self.range)

    def potential(self, gap):
        y = self._decay(gap)
        return self.work_of_adhesion * y * (y - 2)

    def traction(self, gap):
        y = self._decay(gap)
        return 2 * self.work_of_adhesion / self.range * y * (1 - y)

    def stiffness(self, gap):
        y = self._decay(gap)
        return 2 * self.work_of_adhesion / self.range**2 * y * (2 * y - 1)

    def repulsive_gap(self, traction):
        # y² − y = x, with y − 1 written so that nothing cancels near equilibrium.
        x = -np.asarray(traction, dtype=float) * self.range / (2 * self.work_of_adhesion)
        return self.length - self.range * np.log1p(2 * x / (1 + np.sqrt(1 + 4 * x)))

    @property
    def peak_distance(self) -> float:
        return self.length + float(np.log(2)) * self.range

    @property
    def strongest_softening(self) -> float:
        # y (2y − 1) is lowest, −1/8, at y = 1/4.
        return self.work_of_adhesion / (4 * self.range**2)
