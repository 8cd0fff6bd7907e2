"""What every traction-separation law offers."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from numbers import Real

import numpy as np

# Pressure at which a point lands that enters repulsion in one step, in units of the law's peak: enough to hold it
# there, not so much that its overshoot decides the line search. Zero costs half as many iterations again.
LANDING = 0.35


@dataclass(frozen=True)
class TractionLaw(ABC):
    """Interaction energy φ per area as a function of the local gap, and its derivatives.

    Sign: the traction φ'(gap) is positive in tension. A subclass gives the functions and the numbers; it may
    override :meth:`evaluate` and :meth:`advance` by compiled passes, and :meth:`scaled` if it has further lengths.

    Parameters
    ----------
    work_of_adhesion : float
        Depth of the minimum of φ (J/m²).
    length : float
        The law's length: r0 or range (m).

    Raises
    ------
    ValueError
        If either is not a positive finite number.
    """

    work_of_adhesion: float
    length: float

    def __post_init__(self):
        for name, unit in (("work_of_adhesion", "J/m²"), ("length", "m")):
            value = getattr(self, name)
            number = isinstance(value, Real) and not isinstance(value, bool)
            if not (number and math.isfinite(value) and value > 0):
                raise ValueError(f"{name} = {value!r}: must be a positive finite number, in {unit}")

    @abstractmethod
    def potential(self, gap: np.ndarray) -> np.ndarray:
        """Energy φ (J/m²), zero at infinite gap."""

    @abstractmethod
    def traction(self, gap: np.ndarray) -> np.ndarray:
        """Traction φ' (Pa), tension positive."""

    @abstractmethod
    def stiffness(self, gap: np.ndarray) -> np.ndarray:
        """Curvature φ'' (Pa/m)."""

    @abstractmethod
    def repulsive_gap(self, traction: np.ndarray) -> np.ndarray:
        """The gap at or below equilibrium at which the traction has the given value <= 0 (m)."""

    @property
    @abstractmethod
    def equilibrium_distance(self) -> float:
        """Gap at which the traction vanishes (m)."""

    @property
    @abstractmethod
    def peak_distance(self) -> float:
        """Gap of the largest tensile traction (m)."""

    @property
    def peak_tensile_stress(self) -> float:
        """Largest tensile traction (Pa)."""
        return float(self.traction(np.array(self.peak_distance)))

    @property
    @abstractmethod
    def equilibrium_stiffness(self) -> float:
        """φ'' at the equilibrium distance (Pa/m)."""

    @property
    @abstractmethod
    def strongest_softening(self) -> float:
        """Largest −φ'' of the attractive tail (Pa/m)."""

    def evaluate(self, gap: np.ndarray, traction: np.ndarray, stiffness: np.ndarray) -> float:
        """Write φ' and φ'' of ``gap`` into the two arrays; returns the sum of φ over all points (J/m²)."""
        traction[...] = self.traction(gap)
        stiffness[...] = self.stiffness(gap)
        return float(np.sum(self.potential(gap)))

    def advance(self, gap: np.ndarray, step: np.ndarray, limit: float, out: np.ndarray) -> None:
        """Write the gap after a Newton step into ``out``, moving each point in the variable it is nearly linear in.

        A point in repulsion moves by ``step`` in its linearised traction φ' + φ''·step, from which the gap follows by
        :meth:`repulsive_gap`; another moves in its gap. No gap changes by more than the fraction ``limit`` away from
        repulsion, and a point that enters repulsion does so along the tangent at equilibrium, down to a pressure of
        LANDING times the law's peak. Without this a single point deep in the repulsive wall would shorten the step
        of all.

        Parameters
        ----------
        gap, step : numpy.ndarray
            Present gap and Newton step (m).
        limit : float
            Largest relative change of an attracted gap, below one.
        out : numpy.ndarray
            The new gap (m).
        """
        equilibrium, tangent = self.equilibrium_distance, self.equilibrium_stiffness
        repelled = gap < equilibrium
        moved = gap + np.clip(step, -limit * gap, limit * gap)
        landing = np.maximum(tangent * (moved - equilibrium), -LANDING * self.peak_tensile_stress)
        traction = np.where(repelled, self.traction(gap) + self.stiffness(gap) * step, landing)
        left = np.where(repelled, equilibrium + np.minimum(traction / tangent, limit * equilibrium), moved)
        out[...] = np.where(traction < 0, self.repulsive_gap(np.minimum(traction, 0.0)), left)

    def scaled(self, length: float, stress: float) -> "TractionLaw":
        """The same law in other units: lengths divided by ``length`` (m), stresses by ``stress`` (Pa)."""
        return replace(self, work_of_adhesion=self.work_of_adhesion / (length * stress), length=self.length / length)
