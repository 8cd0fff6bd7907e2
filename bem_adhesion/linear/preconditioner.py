"""The solid on a uniform bed of springs, inverted: what preconditions the linearised contact where surfaces attract.

Only waves longer than a few points need K there (:mod:`contact_study.numerics.multigrid`). Conjugate gradients need as
many iterations with long waves on coarser grids as with (K + c)⁻¹ of the finest, for a sixteenth of its transforms.
"""

from typing import Protocol

import numpy as np

from bem_adhesion.operators.fourier import MakeOperator, Operator
from contact_study.numerics.grid import Grid
from contact_study.numerics.multigrid import HALVINGS, SHORT_WAVES, HalvedInverse, Inverse, can_be_halved


class Bed(Inverse, Protocol):
    """An inverse that says what work it took."""

    def equivalent_pairs(self, grid: Grid) -> float:
        """Transform pairs beyond those of the operator that owns :attr:`field`, as float64 pairs on ``grid``."""


class FourierPreconditioner:
    """The inverse by the transforms of an operator.

    Parameters
    ----------
    operator : Operator
        The elastic solid.
    shift : float
        Stiffness of the springs (Pa/m).
    """

    def __init__(self, operator: Operator, shift: float):
        self.field = operator.field
        self._operator = operator
        self._inverse = operator.inverse_shifted(shift)

    def apply_and_sum(self) -> float:
        return self._operator.apply_and_sum(self._inverse)

    def equivalent_pairs(self, grid: Grid) -> float:
        return 0.0


class TwoLevelPreconditioner(HalvedInverse[Bed]):
    """The inverse with long waves on a grid of half the resolution.

    Parameters
    ----------
    field : numpy.ndarray, shape (2·rows, 2·columns)
        Buffer of the finer grid.
    coarser : Bed
        The inverse on half the resolution, ``rows`` by ``columns``.
    operator : Operator
        The solid there, which owns the buffer of ``coarser``.
    largest : float
        Largest eigenvalue of K on the finer grid (Pa/m).
    short_waves : float
        ω of :class:`HalvedInverse`.
    """

    def __init__(self, field: np.ndarray, coarser: Bed, operator: Operator, largest: float, short_waves: float):
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
) -> Bed:
    """The bed for an operator in float32, with its long waves on a coarser grid where that saves work."""
    rows, columns = operator.grid.shape
    if not (halvings and can_be_halved((rows, columns))):
        return FourierPreconditioner(operator, shift)
    coarse = make_operator(operator.grid.with_shape((rows // 2, columns // 2)), np.float32)
    coarser = preconditioner_for(coarse, make_operator, shift, short_waves, halvings - 1)
    return TwoLevelPreconditioner(operator.field, coarser, coarse, operator.largest, short_waves)
