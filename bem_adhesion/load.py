"""What presses on the elastic solid: a field and a uniform pressure, kept apart so that a new load is no new field."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Load:
    """The sum of a field and a number.

    Parameters
    ----------
    field : numpy.ndarray, shape grid.shape
        As the pressure K h that flattens the heights (Pa); not changed.
    pressure : float, optional
        The same at all points (Pa).
    """

    field: np.ndarray
    pressure: float = 0.0

    def __sub__(self, pressure: float) -> "Load":
        return Load(self.field, self.pressure - pressure)
