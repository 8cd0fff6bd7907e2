"""Preconditioners of the linearised contact: (K + c)⁻¹, the elastic solid with a uniform stiffness c at every point.

Only waves longer than a few points need K: with them on coarser grids the iterations are as many, for a sixteenth of
the transforms (:mod:`contact_study.numerics.multigrid`).
"""

import numpy as np

from bem_adhesion.operators.fourier import MakeOperator, PeriodicOperator
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.numerics.multigrid import HALVINGS, SHORT_WAVES, HalvedInverse, Inverse, can_be_halved


def typical_wavenumber(height: np.ndarray, grid: Grid) -> float:
    """Return rms slope over rms height, at least the longest wave's wavenumber (1/m), whatever the size: for c."""
    power = grid.variances(fourier.transform(height))
    lowest = 2 * np.pi / max(grid.size)
    variance = power.sum()
    if variance == 0:
        return lowest
    return max(lowest, float(np.sqrt(np.sum(grid.wavenumber**2 * power) / variance)))


class FourierPreconditioner:
    """The inverse by the transforms of an operator, with the shift c (Pa/m)."""

    def __init__(self, operator: PeriodicOperator, shift: float):
        self.field = operator.field
        self._operator = operator
        self._inverse = operator.inverse_shifted(shift)

    def apply_and_sum(self) -> float:
        return self._operator.apply_and_sum(self._inverse)


def preconditioner_for(
    operator: PeriodicOperator,
    make_operator: MakeOperator,
    shift: float,
    short_waves: float = SHORT_WAVES,
    halvings: int = HALVINGS,
) -> tuple[Inverse, list[PeriodicOperator]]:
    """Return the inverse on an operator in float32, and the coarser operators that it has long waves on."""
    rows, columns = operator.grid.shape
    if not (halvings and can_be_halved((rows, columns))):
        return FourierPreconditioner(operator, shift), []
    coarse = make_operator(operator.grid.with_shape((rows // 2, columns // 2)), np.float32)
    inverse, coarser = preconditioner_for(coarse, make_operator, shift, short_waves, halvings - 1)
    return HalvedInverse(operator.field, inverse, operator.largest, short_waves), [coarse, *coarser]
