"""The elastic solid, as solvers and theories see it: the stiffness K(q) of a wave of its surface."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from contact_study.numerics.arguments import positive
from contact_study.numerics.grid import Grid


@dataclass(frozen=True)
class Elasticity(ABC):
    """Linear response of a block's flat surface to a frictionless normal pressure, wave by wave.

    A pressure p of wavenumber q displaces the surface by p/K(q), along the pressure. A subclass gives
    :meth:`stiffness`, and scales its further lengths in :meth:`scaled`.

    Parameters
    ----------
    contact_modulus : float
        E*, the modulus that is quoted and the unit of stresses; of a homogeneous solid short waves feel E* q/2 (Pa).

    Raises
    ------
    ValueError
        If it is not a positive finite number.

    Attributes
    ----------
    on_any_grid : bool
        Whether K is known at the waves of any grid, of part of a surface for one.

    Examples
    --------
    >>> from contact_study.physics.solids import Elasticity, HalfSpace
    >>> isinstance(HalfSpace(1e9), Elasticity)
    True
    """

    on_any_grid: ClassVar[bool] = True
    contact_modulus: float

    def __post_init__(self) -> None:
        positive("contact_modulus", self.contact_modulus, "Pa")

    @abstractmethod
    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        """K(q) at wavenumbers q > 0 (1/m), of their shape (Pa/m)."""

    @property
    def depth(self) -> float:
        """Distance from the surface to what holds the block (m)."""
        return np.inf

    @property
    def layer_thickness(self) -> float:
        """Thickness of the layer under the surface, which may be all there is; infinite without one (m)."""
        return self.depth

    @property
    def mean_compliance(self) -> float:
        """Displacement of the surface's mean towards what holds the block, per mean pressure (m/Pa).

        Zero where there is none, or none to speak of: the compression of an infinitely deep half-space is left out.
        """
        return 0.0

    def mean_stiffness_on(self, grid: Grid) -> float:
        """Stiffness of the mean displacement of a grid against what holds the block (Pa/m); zero where nothing does."""
        return 1 / self.mean_compliance if self.mean_compliance else 0.0

    def compression(self, mean_pressure: float) -> float:
        """How far a mean pressure (Pa), known or not, moves the surface's mean towards what holds the block (m)."""
        return self.mean_compliance * mean_pressure if self.mean_compliance else 0.0

    def compression_energy(self, mean_pressure: float) -> float:
        """Energy of that movement per area (J/m²)."""
        return 0.5 * self.compression(mean_pressure) * mean_pressure if self.mean_compliance else 0.0

    def stiffness_on(self, grid: Grid) -> np.ndarray:
        """K of each wavevector of a grid, zero at q = 0, in the layout of ``rfft2`` (Pa/m)."""
        stiffness_q = np.zeros(grid.spectrum_shape)
        # The rows of −qy are those of qy.
        half = grid.shape[0] // 2 + 1
        q_y, q_x = grid.wavevectors
        wavenumber = np.sqrt(q_y[:half] ** 2 + q_x**2)
        stiffness_q[:half].reshape(-1)[1:] = self.stiffness(wavenumber.reshape(-1)[1:])
        stiffness_q[half:] = stiffness_q[grid.shape[0] - half : 0 : -1]
        return stiffness_q

    def softest_modulus(self, longest: float, shortest: float) -> float:
        """The least E*(q) = 2 K(q)/q of waves between two lengths, that of a homogeneous half-space (Pa).

        Parameters
        ----------
        longest, shortest : float
            Wavelengths (m).
        """
        # Solids change over an octave at the earliest.
        count = 2 + math.ceil(8 * math.log2(max(longest / shortest, 1.0)))
        q = np.geomspace(2 * np.pi / longest, 2 * np.pi / shortest, count)
        return float(np.min(contact_modulus_of(self.stiffness(q), q)))

    def scaled(self, length: float, stress: float) -> Self:
        """The same solid in other units: lengths divided by ``length`` (m), stresses by ``stress`` (Pa)."""
        return replace(self, contact_modulus=self.contact_modulus / stress)


def contact_modulus_of(stiffness: np.ndarray, wavenumber: np.ndarray) -> np.ndarray:
    """Calculate E*(q) = 2 K(q)/q, the contact modulus of the half-space that is as stiff for a wave (Pa)."""
    return 2 * stiffness / wavenumber
