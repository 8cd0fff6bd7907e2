"""The wavenumber that a surface's roughness stands for, where one number has to do."""

import numpy as np

from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid


def typical_wavenumber(height: np.ndarray, grid: Grid) -> float:
    """Root-mean-square slope over root-mean-square height, at least that of the longest wave (1/m).

    Unlike the size of the cell it does not change when the same roughness is studied on a larger area.
    """
    power = grid.variances(fourier.transform(height))
    lowest = 2 * np.pi / max(grid.size)
    variance = power.sum()
    if variance == 0:
        return lowest
    return max(lowest, float(np.sqrt(np.sum(grid.wavenumber**2 * power) / variance)))
