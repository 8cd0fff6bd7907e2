"""Preconditioners of the linearised contact: (K + c)⁻¹, the elastic solid with a uniform stiffness c at every point.

Only waves longer than a few points need K (:mod:`contact_study.numerics.multigrid`). With long waves on coarser grids
conjugate gradients need as many iterations as with (K + c)⁻¹ of the finest grid, for a sixteenth of its transforms.
"""

from typing import Protocol

import numpy as np

from bem_adhesion.operators.fourier import MakeOperator, Operator
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.numerics.multigrid import HALVINGS, SHORT_WAVES, HalvedInverse, Inverse, can_be_halved


def typical_wavenumber(height: np.ndarray, grid: Grid) -> float:
    """Return rms slope over rms height, at least the wavenumber of the longest wave (1/m).

    It sets the shift c. It does not change when the same roughness is studied on a larger area.
    """
    power = grid.variances(fourier.transform(height))
    lowest = 2 * np.pi / max(grid.size)
    variance = power.sum()
    if variance == 0:
        return lowest
    return max(lowest, float(np.sqrt(np.sum(grid.wavenumber**2 * power) / variance)))


class Preconditioner(Inverse, Protocol):
    """An inverse that counts its work."""

    def equivalent_pairs(self, grid: Grid) -> float:
        """Return the transform pairs on coarser grids than :attr:`field`, as float64 pairs on ``grid``."""


class FourierPreconditioner:
    """The inverse by the transforms of an operator, with the shift c (Pa/m)."""

    def __init__(self, operator: Operator, shift: float):
        self.field = operator.field
        self._operator = operator
        self._inverse = operator.inverse_shifted(shift)

    def apply_and_sum(self) -> float:
        return self._operator.apply_and_sum(self._inverse)

    def equivalent_pairs(self, grid: Grid) -> float:
        return 0.0


class TwoLevelPreconditioner(HalvedInverse[Preconditioner]):
    """The inverse with long waves on a grid of half the resolution."""

    def __init__(
        self, field: np.ndarray, coarser: Preconditioner, operator: Operator, largest: float, short_waves: float
    ):
        super().__init__(field, coarser, largest, short_waves)
        self._operator = operator

    def equivalent_pairs(self, grid: Grid) -> float:
        return self._operator.equivalent_pairs(grid) + self._coarser.equivalent_pairs(grid)


def preconditioner_for(
    operator: Operator,
    make_operator: MakeOperator,
    shift: float,
    short_waves: float = SHORT_WAVES,
    halvings: int = HALVINGS,
) -> Preconditioner:
    """Return the preconditioner of an operator in float32, with long waves on a coarser grid where that saves work."""
    rows, columns = operator.grid.shape
    if not (halvings and can_be_halved((rows, columns))):
        return FourierPreconditioner(operator, shift)
    coarse = make_operator(operator.grid.with_shape((rows // 2, columns // 2)), np.float32)
    coarser = preconditioner_for(coarse, make_operator, shift, short_waves, halvings - 1)
    return TwoLevelPreconditioner(operator.field, coarser, coarse, operator.largest, short_waves)
