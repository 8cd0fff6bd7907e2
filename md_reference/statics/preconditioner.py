"""Inverse of the block on uniform springs, which preconditions the linear problem where atoms attract.

Only waves longer than a few atoms need S there (:mod:`contact_study.numerics.multigrid`): one stiffness per component
represents the rest.
"""

from typing import Protocol

import numpy as np

from contact_study.numerics.fourier import RealTransform
from contact_study.numerics.grid import Grid
from contact_study.numerics.multigrid import HALVINGS, HalvedInverse, Inverse, can_be_halved
from md_reference.block.spectral import invert


class Preconditioner(Inverse, Protocol):
    """An inverse, on a field of shape (3, ny, nx), that counts its work."""

    @property
    def pairs(self) -> float:
        """Transform pairs beyond those of the owner of :attr:`field`, in proportion to their points."""


class FourierPreconditioner:
    """The inverse by transforms of three components in float32; S and the springs' stiffness ``shift`` in N/m."""

    pairs = 0.0  # the transform's owner counts them

    def __init__(self, transform: RealTransform, coefficients: np.ndarray, shift: float):
        self.field = transform.field
        self._transform = transform
        grid = Grid((transform.shape[1], transform.shape[2]), (1.0, 1.0))
        self._operator = coefficients, grid.multiplicity[0].astype(np.float32), shift, 1 / transform.points

    def apply_and_sum(self) -> float:
        product = invert(self._transform.forward().view(np.float32), *self._operator)
        self._transform.backward()
        return product


class TwoLevelPreconditioner(HalvedInverse[Preconditioner]):
    """The inverse with long waves on half the resolution.

    ``field`` is the buffer of the finer grid, ``largest`` each component's largest stiffness there (N/m), and
    ``transform`` owns the buffer of ``coarser``.
    """

    def __init__(self, field: np.ndarray, coarser: Preconditioner, transform: RealTransform, largest: np.ndarray):
        super().__init__(field, coarser, largest)
        self._transform = transform

    @property
    def pairs(self) -> float:
        return (self._transform.pairs + self._coarser.pairs) / 4


def preconditioner_for(
    transform: RealTransform, coefficients: np.ndarray, shift: float, halvings: int = HALVINGS, threads: int = 1
) -> Preconditioner:
    """Return the preconditioner of a layer, with its long waves on a coarser one where that saves work."""
    rows, columns = transform.shape[1:]
    if not (halvings and can_be_halved((rows, columns))):
        return FourierPreconditioner(transform, coefficients, shift)
    coarse = RealTransform((3, rows // 2, columns // 2), np.float32, threads)
    # S of the waves that every second atom can carry.
    kept = np.r_[: rows // 4 + 1, rows - (rows // 2 - rows // 4 - 1) : rows]
    coarse_coefficients = np.ascontiguousarray(coefficients[:, kept, : columns // 4 + 1])
    coarser = preconditioner_for(coarse, coarse_coefficients, shift, halvings - 1, threads)
    return TwoLevelPreconditioner(transform.field, coarser, coarse, coefficients[:3].max(axis=(1, 2)))
