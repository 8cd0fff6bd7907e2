"""What every traction-separation law offers."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class TractionLaw(ABC):
    """Interaction energy φ per area as a function of the local gap, and its derivatives.

    Sign: the traction φ'(gap) is positive in tension. A subclass gives the three functions and four numbers; it may
    override :meth:`evaluate` by a compiled pass.

    Parameters
    ----------
    work_of_adhesion : float
        Depth of the minimum of φ (J/m²).
    length : float
        The law's length: r0 or range (m).
    """

    work_of_adhesion: float
    length: float

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
    @abstractmethod
    def peak_tensile_stress(self) -> float:
        """Largest tensile traction (Pa)."""

    @property
    @abstractmethod
    def equilibrium_stiffness(self) -> float:
        """φ'' at the equilibrium distance (Pa/m)."""

    def evaluate(self, gap: np.ndarray, traction: np.ndarray, stiffness: np.ndarray) -> float:
        """Write φ' and φ'' of ``gap`` into the two arrays; returns the sum of φ over all points (J/m²)."""
        traction[...] = self.traction(gap)
        stiffness[...] = self.stiffness(gap)
        return float(np.sum(self.potential(gap)))
