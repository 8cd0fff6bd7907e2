"""The traction-separation law: its energy, and all that follows from it by derivatives and search."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from contact_study.numerics.arguments import positive

# Steps of the numerical derivatives, in units of the law's length: nothing cancels along the imaginary axis; along the
# real one truncation (fourth order) and rounding stay below 1e-9 of the curvature.
_IMAGINARY_STEP, _REAL_STEP = 1e-30, 3e-4
# Gaps, in units of the law's length, that bracket its characteristic points.
_SAMPLES = np.geomspace(1e-2, 1e2, 4001)
# Halvings and Newton steps that find a gap from its traction; a power law needs half of them.
_INVERSE_STEPS = 100
# Largest gap that is searched over the law's length, and inverse of the smallest.
_FARTHEST = 1e100
# Gap below which points count as contact unless a study says otherwise, in units of the law's length.
CONTACT_DISTANCE = 2 ** (1 / 6)
_Function = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class TractionLaw(ABC):
    """Interaction energy φ per area as a function of the local gap; the traction φ'(gap) is positive in tension.

    A law must give :meth:`potential`, written so that it takes complex gaps; all else follows from it, by derivatives
    in the complex plane and by search, and may be given in closed form for speed.

    Parameters
    ----------
    work_of_adhesion, length : float
        Depth of the minimum of φ (J/m²) and the law's length, r0 or range (m), both positive.

    Examples
    --------
    >>> from bem_adhesion import Morse, TractionLaw
    >>> issubclass(Morse, TractionLaw)
    True
    """

    has_wall: ClassVar[bool] = False  # the gap cannot fall below zero: a constraint, of which φ says nothing
    attracts: ClassVar[bool] = True  # carries tension
    title: ClassVar[str]  # in a label
    words: ClassVar[str]  # in a sentence
    counts_as_contact: ClassVar[str] = "a gap below the contact distance"  # see :meth:`in_contact`
    diverges: ClassVar[bool] = True  # repulsion grows without bound as the gap closes: no gap is zero or less
    own_lengths: ClassVar[tuple[str, ...]] = ()  # fields beside ``length`` that are lengths
    jump_onset: ClassVar[float] = 0.96  # Maugis' λ from which one asperity jumps at a prescribed separation
    work_of_adhesion: float
    length: float

    def __post_init__(self):
        positive("work_of_adhesion", self.work_of_adhesion, "J/m²")
        positive("length", self.length, "m")

    @abstractmethod
    def potential(self, gap: np.ndarray) -> np.ndarray:
        """Energy φ (J/m²), zero at infinite gap."""

    def traction(self, gap: np.ndarray) -> np.ndarray:
        """Traction φ' (Pa), tension positive."""
        step = _IMAGINARY_STEP * self.length
        return np.imag(self.potential(np.asarray(gap) + 1j * step)) / step

    def stiffness(self, gap: np.ndarray) -> np.ndarray:
        """Curvature φ'' (Pa/m)."""
        gap = np.asarray(gap)
        step = _REAL_STEP * (self.length if self.has_wall else gap)
        near = self.traction(gap + step) - self.traction(gap - step)
        far = self.traction(gap + 2 * step) - self.traction(gap - 2 * step)
        return (8 * near - far) / (12 * step)

    def repulsive_gap(self, traction: np.ndarray) -> np.ndarray:
        """The gap at or below equilibrium at which the traction has the given value <= 0 (m); ValueError if none."""
        traction = np.asarray(traction, dtype=float)
        high = np.full(traction.shape, self.equilibrium_distance)
        if self.has_wall:
            return high
        low, below = 0.5 * high, self.length
        while np.any(deeper := self.traction(low) > traction):
            if not self.length / _FARTHEST < (np.min(low) if self.diverges else below) < _FARTHEST * self.length:
                raise ValueError(
                    f"law: {self.title}: its repulsion reaches {-self.traction(low).min():.3g} Pa, not "
                    f"{-traction.min():.3g} Pa" + ("; with a finite one at zero gap, diverges is False" * self.diverges)
                )
            low = np.where(deeper, 0.5 * low if self.diverges else low - below, low)
            below *= 2
        return solved(self.traction, self.stiffness, traction, low, high, high)

    @cached_property
    def equilibrium_distance(self) -> float:
        """Gap at which the traction vanishes, at a wall the wall (m); ValueError if nothing keeps the bodies apart."""
        if self.has_wall:
            return 0.0
        from scipy.optimize import brentq  # slow to import

        lowest = int(np.argmin(self.potential(self.length * _SAMPLES)))
        if lowest in (0, _SAMPLES.size - 1):
            raise ValueError(f"law: {self.title}: has no core, or none from 0.01 to 100 times its length: give it one")
        near, far = _SAMPLES[lowest - 1], _SAMPLES[lowest + 1]
        return self.length * float(brentq(lambda gap: float(self.traction(np.array(self.length * gap))), near, far))

    @property
    def bare_wall(self) -> bool:
        """Whether this is a wall without attraction: contact alone carries a stress."""
        return self.has_wall and not self.attracts

    @cached_property
    def peak_distance(self) -> float:
        """Gap of the largest tensile traction (m)."""
        return self.lowest(lambda gap: -self.traction(gap))

    @cached_property
    def peak_tensile_stress(self) -> float:
        """Largest tensile traction (Pa)."""
        return float(self.traction(np.array(self.peak_distance)))

    @cached_property
    def equilibrium_stiffness(self) -> float:
        """φ'' at the equilibrium distance (Pa/m); a wall's own is infinite and not meant."""
        return float(self.stiffness(np.array(self.equilibrium_distance)))

    @cached_property
    def strongest_softening(self) -> float:
        """Largest −φ'' of the attractive tail (Pa/m)."""
        return -float(self.stiffness(np.array(self.lowest(self.stiffness))))

    def lowest(self, function: _Function) -> float:
        """Gap from equilibrium outwards where a function is lowest (m)."""
        gaps = self.equilibrium_distance + self.length * np.concatenate([[0.0], _SAMPLES])
        at = int(np.argmin(function(gaps)))
        if at == 0:
            return self.equilibrium_distance
        from scipy.optimize import minimize_scalar  # slow to import

        found = minimize_scalar(
            lambda gap: float(function(np.array(self.length * gap))),
            bounds=(gaps[at - 1] / self.length, gaps[at + 1] / self.length),
            method="bounded",
            options={"xatol": 1e-9},
        )
        return self.length * float(found.x)

    @property
    def contact_distance(self) -> float:
        """Gaps up to it count as contact unless a study says otherwise (m)."""
        return 0.0 if self.has_wall else CONTACT_DISTANCE * self.length

    def in_contact(self, gap: np.ndarray, pressure: np.ndarray, contact_distance: float) -> np.ndarray:
        """Which points of an interface are in contact, by their gap (m) and pressure (Pa)."""
        return gap <= contact_distance if self.has_wall else gap < contact_distance

    def wall_bounded(self, contact_distance: float) -> tuple[str, ...]:
        """Which areas, of contact or repulsion, end where the gap leaves a wall, not at a level of a smooth field."""
        if not self.has_wall:
            return ()
        return ("repulsive",) if contact_distance > 0 else ("contact", "repulsive")

    def scaled(self, length: float, stress: float) -> Self:
        """The same law in other units: lengths divided by ``length`` (m), stresses by ``stress`` (Pa)."""
        lengths = {name: getattr(self, name) / length for name in ("length", *self.own_lengths)}
        return replace(self, work_of_adhesion=self.work_of_adhesion / (length * stress), **lengths)


@dataclass(frozen=True)
class LawAtLength(TractionLaw):
    """A law whose length is its equilibrium distance."""

    @property
    def equilibrium_distance(self) -> float:
        return self.length


def solved(function: _Function, slope: _Function, value: np.ndarray, low: Any, high: Any, x: np.ndarray) -> np.ndarray:
    """Solve function = value in brackets where it rises, by Newton's steps or halves where they leave the bracket."""
    for _ in range(_INVERSE_STEPS):
        excess = function(x) - value
        low, high = np.where(excess <= 0, x, low), np.where(excess >= 0, x, high)
        if np.all(high - low <= 4 * np.finfo(float).eps * np.abs(high)):
            break
        newton = x - excess / slope(x)
        x = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
    return x
