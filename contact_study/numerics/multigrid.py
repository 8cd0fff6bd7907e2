"""A periodic grid and one of half its resolution: bilinear interpolation P, the mean Pᵀ/4, and an inverse.

For a stiffness K beside springs c, P (K + c)⁻¹ Pᵀ / 4 + ω / K_max, by levels: the additive multilevel preconditioner of
J. H. Bramble, J. E. Pasciak and J. Xu, Math. Comp. 55, 1 (1990).
"""

from typing import Protocol

import numpy as np

from contact_study.numerics.kernel import kernel

# ω; below 1 the iterations grow, between 1 and 2.5 their number changes by a few per cent.
SHORT_WAVES = 1.5
# Most halvings of a grid, and fewest points along an axis.
HALVINGS, FEWEST_POINTS = 2, 32


class Inverse(Protocol):
    """An inverse that acts on its buffer ``field`` in place."""

    field: np.ndarray

    def apply_and_sum(self) -> float:
        """Apply the inverse to :attr:`field`; returns the inner product of field and result."""


class HalvedInverse:
    """The inverse with long waves on half the resolution: finer buffer, largest stiffnesses there, and ω."""

    def __init__(
        self, field: np.ndarray, coarser: Inverse, largest: float | np.ndarray, short_waves: float = SHORT_WAVES
    ):
        self.field = field
        self._coarser = coarser
        self._components = field.reshape(-1, *field.shape[-2:])
        self._coarse_components = coarser.field.reshape(-1, *coarser.field.shape[-2:])
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
    """Tell whether a grid of a shape has a coarser one that saves work."""
    return shape[0] % 2 == 0 and shape[1] % 2 == 0 and min(shape) >= 2 * FEWEST_POINTS


@kernel
def restrict(fine, coarse):
    """Write Pᵀ fine / 4: at every second point the mean of its neighbourhood with weights 1, ½ and ¼."""
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


@kernel
def prolong(coarse, weight, fine):
    """Write weight·fine + P coarse, arrays (2·rows, 2·columns); return weight·Σ fine² of the old values."""
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
