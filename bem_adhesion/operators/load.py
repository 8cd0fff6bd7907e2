"""Load on the elastic solid: a uniform pressure, and a field or the heights that the solid bends over.

A solver needs only ``pressing`` = K d + field, which follows the changes of d, and the energy of the field. K h of the
heights is not stored: pressing = K (d + h), and ½ <d, K d> + <d, K h> = ½ <pressing, d + h> − ½ <h, K h>.
"""

from dataclasses import dataclass, replace

import numpy as np

from bem_adhesion.operators.fourier import PeriodicOperator
from contact_study.numerics.inner_product import inner_product


@dataclass(frozen=True)
class Load:
    """A uniform pressure and a field of pressures (Pa), or with a ``unit`` heights in it (m)."""

    field: np.ndarray
    unit: float | None = None
    pressure: float = 0.0
    energy: float = 0.0  # the part that does not depend on the gap (J/m²)

    @classmethod
    def of_heights(cls, solid: PeriodicOperator, height: np.ndarray, unit: float) -> "Load":
        """Return the load of heights on a solid, without pressure; its energy is −½ <h, K h>."""
        load = cls(height, unit)
        flattening = load.press(np.zeros(height.shape), solid)
        return replace(load, energy=-0.5 * unit * inner_product(flattening, height))

    def press(self, gap: np.ndarray, solid: PeriodicOperator) -> np.ndarray:
        """Write K d + field of a gap (Pa) into the operator's field; return it."""
        if self.unit is not None:
            np.multiply(self.field, self.unit, out=solid.field)
            solid.field += gap
            return solid.apply(solid.stiffness)
        solid.field[...] = gap
        pressing = solid.apply(solid.stiffness)
        pressing += self.field
        return pressing

    def rest_of_energy(self, pressing: np.ndarray, gap: np.ndarray, here: slice) -> float:
        """Return Σ ½ d·K d + field·d − ½ pressing·d in some rows, without their part of :attr:`energy` (J/m²)."""
        if self.unit is None:
            return 0.5 * inner_product(self.field[here], gap[here])
        return 0.5 * self.unit * inner_product(pressing[here], self.field[here])
