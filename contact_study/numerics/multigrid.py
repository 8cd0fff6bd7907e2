"""Between a periodic grid and one of half its resolution: bilinear interpolation P, the mean Pᵀ/4, and inverses.

Of a solid's stiffness K on a bed of springs c only waves longer than a few points need K. :class:`HalvedInverse` takes
those to a grid of half the resolution and answers the rest by one stiffness for each component,

    P (K + c)⁻¹ Pᵀ / 4 + ω / K_max,

the first term by the same on the coarser grid: symmetric and positive, as the additive multilevel preconditioner of
J. H. Bramble, J. E. Pasciak and J. Xu, Math. Comp. 55, 1 (1990).
"""

from typing import Generic, Protocol, TypeVar

import numpy as np
from numba import njit

# ω. Pairs of the paper's path at 512² points, ε0, two surfaces: 371 with 1.5, 394 with 2, 405 with 2.5. Below 1 the
# iterations grow. Of 200² atoms at 8 ε0 under 0.1, 1 and 10 GPa: 306, 84, 74 with 1; 303, 66, 71 with 1.5; 319, 70, 91
# with 2.5; 467, 138, 125 with the transforms of all atoms.
SHORT_WAVES = 1.5
# Grids are halved so often, and down to so many points along an axis.
HALVINGS, FEWEST_POINTS = 2, 32


class Inverse(Protocol):
    """Where on a grid an inverse acts: on the buffer ``field``, in place."""

    field: np.ndarray

    def apply_and_sum(self) -> float:
        """Apply the inverse to :attr:`field`; returns the inner product of field and result."""


_Coarser = TypeVar("_Coarser", bound=Inverse)


class HalvedInverse(Generic[_Coarser]):
    """The inverse with long waves on a grid of half the resolution.

    Parameters
    ----------
    field : numpy.ndarray, shape (..., 2·rows, 2·columns)
        Buffer of the finer grid; leading axes are components.
    coarser : Inverse
        The inverse on half the resolution, of as many components.
    largest : float or numpy.ndarray
        Largest stiffness of each component on the finer grid.
    short_waves : float, optional
        ω.
    """

    def __init__(
        self, field: np.ndarray, coarser: _Coarser, largest: float | np.ndarray, short_waves: float = SHORT_WAVES
    ):
        self.field = field
        self._coarser = coarser
        self._components = _components(field)
        self._coarse_components = _components(coarser.field)
        self._short = np.atleast_1d(short_waves / largest).astype(np.float32)

    def apply_and_sum(self) -> float:
        """Apply the inverse to :attr:`field`; returns the inner product of field and result."""
        for fine, coarse in zip(self._components, self._coarse_components, strict=True):
            restrict(fine, coarse)
        product = 4 * self._coarser.apply_and_sum()
        for fine, coarse, short in zip(self._components, self._coarse_components, self._short, strict=True):
            product += prolong(coarse, short, fine)
        return product


def can_be_halved(shape: tuple[int, int]) -> bool:
    """Whether a grid of that shape has a coarser one, and points enough to save work by it."""
    return shape[0] % 2 == 0 and shape[1] % 2 == 0 and min(shape) >= 2 * FEWEST_POINTS


def _components(field: np.ndarray) -> np.ndarray:
    """A view of the field as a stack of grids."""
    return field.reshape(-1, *field.shape[-2:])


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def restrict(fine, coarse):
    """Write Pᵀ fine / 4: at every second point the mean of its neighbourhood with weights 1, ½ and ¼.

    Parameters
    ----------
    fine : numpy.ndarray, shape (2·rows, 2·columns)
    coarse : numpy.ndarray, shape (rows, columns)
    """
    rows, columns = coarse.shape
    quarter, half = fine.dtype.type(0.25), fine.dtype.type(0.5)
    line = np.empty(2 * columns, fine.dtype)
    for i in range(rows):
        above, here, below = fine[2 * i - 1], fine[2 * i], fine[2 * i + 1]
        for j in range(2 * columns):
            line[j] = half * here[j] + quarter * (above[j] + below[j])
        coarse[i, 0] = half * line[0] + quarter * (line[2 * columns - 1] + line[1])
        for j in range(1, columns):
            coarse[i, j] = half * line[2 * j] + quarter * (line[2 * j - 1] + line[2 * j + 1])


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def prolong(coarse, weight, fine):
    """Write weight·fine + P coarse; returns weight·Σ fine² of what was there.

    Parameters
    ----------
    coarse : numpy.ndarray, shape (rows, columns)
    weight : float
        Of the precision of the fields.
    fine : numpy.ndarray, shape (2·rows, 2·columns)
    """
    rows, columns = coarse.shape
    half = fine.dtype.type(0.5)
    line = np.empty(columns + 1, fine.dtype)
    total = 0.0
    for i in range(2 * rows):
        here, below = coarse[i // 2], coarse[(i // 2 + i % 2) % rows]
        for j in range(columns):
            line[j] = half * (here[j] + below[j])
        line[columns] = line[0]
        row = fine.dtype.type(0)
        for j in range(columns):
            left, right = fine[i, 2 * j], fine[i, 2 * j + 1]
            row += left * left + right * right
            fine[i, 2 * j] = weight * left + line[j]
            fine[i, 2 * j + 1] = weight * right + half * (line[j] + line[j + 1])
        total += row
    return weight * total
