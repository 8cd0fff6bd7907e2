"""The solid on a uniform bed of springs, inverted: what preconditions the linearised contact where surfaces attract.

Only waves longer than a few points need K there. :class:`HalvedBed` takes those to a grid of half the resolution and
answers the rest by one stiffness,

    P (K + c)⁻¹ Pᵀ / 4 + ω / K_max,

P bilinear interpolation, the first term by the same on the coarser grid: symmetric and positive, as the additive
multilevel preconditioner of J. H. Bramble, J. E. Pasciak and J. Xu, Math. Comp. 55, 1 (1990; the abstract was read).
Conjugate gradients need as many iterations with it as with (K + c)⁻¹ of the finest grid, for a sixteenth of its
transforms.
"""

from typing import Protocol

import numpy as np

from bem_adhesion.operator import MakeOperator, Operator
from contact_study.fields.grid import Grid
from contact_study.fields.halving import prolong, restrict

# ω. Pairs of the paper's path at 512² points, ε0, two surfaces: 371 with 1.5, 394 with 2, 405 with 2.5. Below 1 the
# iterations grow.
SHORT_WAVES = 1.5
# Grids are halved so often, and down to so many points along an axis.
HALVINGS, FEWEST_POINTS = 2, 32


class Bed(Protocol):
    """Where on a grid the inverse acts: on the buffer ``field``, in place."""

    field: np.ndarray

    def apply_and_sum(self) -> float:
        """Apply the inverse to :attr:`field`; returns the inner product of field and result."""

    def equivalent_pairs(self, grid: Grid) -> float:
        """Transform pairs beyond those of the operator that owns :attr:`field`, as float64 pairs on ``grid``."""


class FullBed:
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


class HalvedBed:
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
    """

    def __init__(self, field: np.ndarray, coarser: Bed, operator: Operator, largest: float):
        self.field = field
        self._coarser = coarser
        self._operator = operator
        self._short = np.float32(SHORT_WAVES / largest)

    def apply_and_sum(self) -> float:
        restrict(self.field, self._coarser.field)
        long_waves = 4 * self._coarser.apply_and_sum()
        return long_waves + prolong(self._coarser.field, self._short, self.field)

    def equivalent_pairs(self, grid: Grid) -> float:
        return self._operator.equivalent_pairs(grid) + self._coarser.equivalent_pairs(grid)


def bed_under(operator: Operator, make_operator: MakeOperator, shift: float, halvings: int = HALVINGS) -> Bed:
    """The bed for an operator in float32, with its long waves on a coarser grid where that saves work."""
    rows, columns = operator.grid.shape
    if not halvings or rows % 2 or columns % 2 or min(rows, columns) < 2 * FEWEST_POINTS:
        return FullBed(operator, shift)
    coarse = make_operator(operator.grid.with_shape((rows // 2, columns // 2)), np.float32)
    return HalvedBed(operator.field, bed_under(coarse, make_operator, shift, halvings - 1), coarse, operator.largest)
