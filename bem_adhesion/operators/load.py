"""Load on the elastic solid: a uniform pressure, and a field or the heights that the solid bends over.

A solver needs only ``pressing`` = K d + field, which follows the changes of d, and the energy of the field. K h of the
heights is therefore not stored: where it is the field, pressing = K (d + h), and as K is symmetric

    ½ <d, K d> + <d, K h> = ½ <pressing, d + h> − ½ <h, K h>.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from bem_adhesion.operators.fourier import Operator
from contact_study.numerics.inner_product import inner_product


@dataclass(frozen=True, kw_only=True)
class Load(ABC):
    """A load with a uniform pressure (Pa), and the part of its energy that does not depend on the gap (J/m²)."""

    pressure: float = 0.0
    energy: float = 0.0

    def __sub__(self, pressure: float) -> Self:
        return replace(self, pressure=self.pressure - pressure)

    @abstractmethod
    def press(self, gap: np.ndarray, solid: Operator) -> np.ndarray:
        """Write K d + field of a gap (Pa) into the operator's field; return it."""

    @abstractmethod
    def rest_of_energy(self, pressing: np.ndarray, gap: np.ndarray, here: slice) -> float:
        """Return Σ ½ d·K d + field·d − ½ pressing·d in some rows, without their part of :attr:`energy` (J/m²)."""


@dataclass(frozen=True)
class FieldLoad(Load):
    """A field of pressures (Pa), separate from the uniform one so that a new pressure needs no new field."""

    field: np.ndarray

    def press(self, gap: np.ndarray, solid: Operator) -> np.ndarray:
        solid.field[...] = gap
        pressing = solid.apply(solid.stiffness)
        pressing += self.field
        return pressing

    def rest_of_energy(self, pressing: np.ndarray, gap: np.ndarray, here: slice) -> float:
        return 0.5 * inner_product(self.field[here], gap[here])


@dataclass(frozen=True)
class HeightLoad(Load):
    """The pressure K h that flattens heights, given in a unit (m); its constant energy is −½ <h, K h>."""

    height: np.ndarray
    unit: float

    @classmethod
    def on(cls, solid: Operator, height: np.ndarray, unit: float) -> "HeightLoad":
        """Return the load of heights on a solid, without pressure."""
        load = cls(height, unit)
        flattening = load.press(np.zeros(height.shape), solid)
        return replace(load, energy=-0.5 * unit * inner_product(flattening, height))

    def press(self, gap: np.ndarray, solid: Operator) -> np.ndarray:
        np.multiply(self.height, self.unit, out=solid.field)
        solid.field += gap
        return solid.apply(solid.stiffness)

    def rest_of_energy(self, pressing: np.ndarray, gap: np.ndarray, here: slice) -> float:
        return 0.5 * self.unit * inner_product(pressing[here], self.height[here])
