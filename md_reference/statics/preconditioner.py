"""The block on a uniform bed of springs, inverted: what preconditions the linear problem where atoms attract.

Only waves longer than a few atoms need S there (:mod:`contact_study.numerics.multigrid`): the rest is answered by one
stiffness for each component.
"""

from typing import Protocol

import numpy as np

from contact_study.numerics.fourier import RealTransform
from contact_study.numerics.grid import Grid
from contact_study.numerics.multigrid import HALVINGS, HalvedInverse, Inverse, can_be_halved
from md_reference.block.spectral import invert


class Bed(Inverse, Protocol):
    """An inverse, on a field of shape (3, ny, nx), that says what work it took."""

    @property
    def pairs(self) -> float:
        """Transform pairs beyond those of the owner of :attr:`field`, in proportion to their points."""


class FourierPreconditioner:
    """The inverse by transforms.

    Parameters
    ----------
    transform : RealTransform
        Of three components, in float32.
    coefficients : numpy.ndarray of float32, shape (6, ny, nx // 2 + 1)
        S, see :mod:`md_reference.block.condensed` (N/m).
    shift : float
        Stiffness of the springs (N/m).
    """

    def __init__(self, transform: RealTransform, coefficients: np.ndarray, shift: float):
        self.field = transform.field
        self._transform = transform
        self._coefficients = coefficients
        self._shift = shift
        grid = Grid((transform.shape[1], transform.shape[2]), (1.0, 1.0))
        self._multiplicity = grid.multiplicity[0].astype(np.float32)

    def apply_and_sum(self) -> float:
        transform = self._transform
        spectrum = transform.forward().view(np.float32)
        product = invert(spectrum, self._coefficients, self._multiplicity, self._shift, 1 / transform.points)
        transform.backward()
        return product

    @property
    def pairs(self) -> float:
        return 0.0


class TwoLevelPreconditioner(HalvedInverse[Bed]):
    """The inverse with long waves on half the resolution.

    Parameters
    ----------
    field : numpy.ndarray of float32, shape (3, 2·rows, 2·columns)
        Buffer of the finer grid.
    coarser : Bed
        The inverse on half the resolution.
    transform : RealTransform
        That owns the buffer of ``coarser``.
    largest : numpy.ndarray, shape (3,)
        Largest stiffness of each component on the finer grid (N/m).
    """

    def __init__(self, field: np.ndarray, coarser: Bed, transform: RealTransform, largest: np.ndarray):
        super().__init__(field, coarser, largest)
        self._transform = transform

    @property
    def pairs(self) -> float:
        return (self._transform.pairs + self._coarser.pairs) / 4


def preconditioner_for(
    transform: RealTransform, coefficients: np.ndarray, shift: float, halvings: int = HALVINGS, threads: int = 1
) -> Bed:
    """The bed for a layer, with its long waves on a coarser one where that saves work."""
    rows, columns = transform.shape[1:]
    if not (halvings and can_be_halved((rows, columns))):
        return FourierPreconditioner(transform, coefficients, shift)
    coarse = RealTransform((3, rows // 2, columns // 2), np.float32, threads)
    coarser = preconditioner_for(coarse, _of_every_second_atom(coefficients, columns), shift, halvings - 1, threads)
    return TwoLevelPreconditioner(transform.field, coarser, coarse, coefficients[:3].max(axis=(1, 2)))


def _of_every_second_atom(coefficients: np.ndarray, columns: int) -> np.ndarray:
    """S of the waves that every second atom of a layer with so many columns can carry."""
    rows = coefficients.shape[1]
    kept = np.r_[: rows // 4 + 1, rows - (rows // 2 - rows // 4 - 1) : rows]
    return np.ascontiguousarray(coefficients[:, kept, : columns // 4 + 1])
