"""Load on the elastic solid: a uniform pressure, and a field or the heights that the solid bends over.

A solver needs only ``pressing`` = K d + field, which follows the changes of d, and the energy of the field. K h of the
heights is therefore not stored: where it is the field, pressing = K (d + h), and as K is symmetric

    ½ <d, K d> + <d, K h> = ½ <pressing, d + h> − ½ <h, K h>.
"""

from dataclasses import dataclass, replace
from typing import Protocol, Self

import numpy as np

from bem_adhesion.operators.fourier import Operator
from contact_study.numerics.inner_product import inner_product


class Load(Protocol):
    """A load on the solid.

    Attributes
    ----------
    pressure : float
        Uniform pressure (Pa).
    energy : float
        Part of the field's energy that does not depend on the gap, a sum over all points (J/m²).
    """

    @property
    def pressure(self) -> float: ...
    @property
    def energy(self) -> float: ...

    def __sub__(self, pressure: float) -> Self:
        """Return the load with a pressure subtracted."""

    def press(self, gap: np.ndarray, solid: Operator) -> np.ndarray:
        """Write K d + field of a gap (Pa) into the operator's field; return it."""

    def rest_of_energy(self, pressing: np.ndarray, gap: np.ndarray, here: slice) -> float:
        """Return Σ ½ d·K d + field·d − ½ pressing·d in some rows, without their part of :attr:`energy` (J/m²)."""


@dataclass(frozen=True)
class FieldLoad:
    """A field and a uniform pressure, separate so that a new pressure needs no new field.

    Parameters
    ----------
    field : numpy.ndarray, shape grid.shape
        Pressure at each point (Pa); not changed.
    pressure : float, optional
        Uniform pressure (Pa).
    """

    field: np.ndarray
    pressure: float = 0.0
    energy = 0.0

    def __sub__(self, pressure: float) -> "FieldLoad":
        return replace(self, pressure=self.pressure - pressure)

    def press(self, gap: np.ndarray, solid: Operator) -> np.ndarray:
        solid.field[...] = gap
        pressing = solid.apply(solid.stiffness)
        pressing += self.field
        return pressing

    def rest_of_energy(self, pressing: np.ndarray, gap: np.ndarray, here: slice) -> float:
        return 0.5 * inner_product(self.field[here], gap[here])


@dataclass(frozen=True)
class HeightLoad:
    """The pressure K h that flattens heights, and a uniform pressure.

    Parameters
    ----------
    height : numpy.ndarray, shape grid.shape
        Heights h, in any unit; not changed.
    unit : float
        Unit of the heights (m).
    energy : float
        −½ <h, K h>, the sum over all points (J/m²).
    pressure : float, optional
        Uniform pressure (Pa).
    """

    height: np.ndarray
    unit: float
    energy: float
    pressure: float = 0.0

    @classmethod
    def on(cls, solid: Operator, height: np.ndarray, unit: float) -> "HeightLoad":
        """Return the load of heights on a solid, without pressure."""
        load = cls(height, unit, 0.0)
        flattening = load.press(np.zeros(height.shape), solid)
        return replace(load, energy=-0.5 * unit * inner_product(flattening, height))

    def __sub__(self, pressure: float) -> "HeightLoad":
        return replace(self, pressure=self.pressure - pressure)

    def press(self, gap: np.ndarray, solid: Operator) -> np.ndarray:
        np.multiply(self.height, self.unit, out=solid.field)
        solid.field += gap
        return solid.apply(solid.stiffness)

    def rest_of_energy(self, pressing: np.ndarray, gap: np.ndarray, here: slice) -> float:
        return 0.5 * self.unit * inner_product(pressing[here], self.height[here])
