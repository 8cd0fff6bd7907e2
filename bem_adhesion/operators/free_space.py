"""A half-space under a surface of finite extent: free boundaries by padded convolution.

The displacement of cells of uniform pressure is their convolution with that of one, C, in closed form (A. E. H. Love,
Phil. Trans. R. Soc. A 228, 377 (1929)). On a periodic grid of twice the extent, with C by the shorter way around, it is
the free one inside the surface, exactly (R. W. Hockney, Methods Comput. Phys. 9, 135 (1970)): the inverse of C is the
stiffness of one more periodic solid, whose undeformed surface is at <displacement> − <p> / K(q=0).
"""

from dataclasses import dataclass

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.physics.solids import HalfSpace


@dataclass(frozen=True)
class Window:
    """The part of a padded grid with a surface: its first rows and columns."""

    shape: tuple[int, int]

    @property
    def slices(self) -> tuple[slice, slice]:
        """Index of the surface's points."""
        return slice(0, self.shape[0]), slice(0, self.shape[1])

    @property
    def halved(self) -> "Window":
        """The window on every second point of the grid."""
        return Window(((self.shape[0] + 1) // 2, (self.shape[1] + 1) // 2))

    def inside(self, field: np.ndarray) -> np.ndarray:
        """Return the surface's part of a field on the padded grid, a view."""
        return field[self.slices]

    def padded(self, field: np.ndarray, grid: Grid, filling: float) -> np.ndarray:
        """Return a field on the padded grid, with one value outside the surface."""
        result = np.full(grid.shape, filling)
        result[self.slices] = field
        return result


def padded_grid(grid: Grid) -> Grid:
    """Return the grid of twice as many points and twice the size along both axes."""
    return Grid((2 * grid.shape[0], 2 * grid.shape[1]), (2 * grid.size[0], 2 * grid.size[1]))


@dataclass(frozen=True)
class FreeHalfSpace(HalfSpace):
    """A half-space under the first quarter of a padded grid; its K on that grid is the inverse of Love's C."""

    def stiffness_on(self, grid: Grid) -> np.ndarray:
        stiffness_q = 1 / np.fft.rfft2(self._compliance(grid)).real
        stiffness_q[0, 0] = 0.0
        return stiffness_q

    def mean_stiffness_on(self, grid: Grid) -> float:
        return float(1 / np.sum(self._compliance(grid)))

    def _compliance(self, grid: Grid) -> np.ndarray:
        """Return the displacement under a unit pressure on the first cell, by the shorter way around (m/Pa)."""
        (rows, columns), (dy, dx) = grid.shape, grid.spacing
        quarter = _cell_displacement(np.arange(rows // 2 + 1) * dy, np.arange(columns // 2 + 1) * dx, dy, dx)
        down, across = (np.minimum(np.arange(n), n - np.arange(n)) for n in (rows, columns))
        return quarter[np.ix_(down, across)] / (np.pi * self.contact_modulus)


def _cell_displacement(y: np.ndarray, x: np.ndarray, dy: float, dx: float) -> np.ndarray:
    """Return ∫∫ dξ dη / r over a cell of sides dy and dx around the origin, at (y, x) (m)."""
    below, above = (y - dy / 2)[:, None], (y + dy / 2)[:, None]
    left, right = (x - dx / 2)[None, :], (x + dx / 2)[None, :]

    def corner(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return u * np.arcsinh(v / np.abs(u)) + v * np.arcsinh(u / np.abs(v))

    return corner(above, right) + corner(below, left) - corner(above, left) - corner(below, right)
