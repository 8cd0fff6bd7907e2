"""A half-space whose surface extends beyond the rigid one, along both axes or along one.

The displacement of cells of uniform pressure is their convolution with that of one, C, in closed form (A. E. H. Love,
Phil. Trans. R. Soc. A 228, 377 (1929)). On a periodic grid of twice the extent, with C by the shorter way around, it is
the free one inside the surface, exactly (R. W. Hockney, Methods Comput. Phys. 9, 135 (1970)): the inverse of C is the
stiffness of one more periodic solid, whose undeformed surface is at <displacement> − <p> / K(q=0).

Along a periodic axis the cells are rows, and C is summed over their period L. A row's displacement falls as the
logarithm of the distance x, so that it counts from a distance: zero is where a line load has no displacement in the far
field, at the extent of the surface along the free axis.
"""

from dataclasses import dataclass

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.physics.solids import HalfSpace

PADDING = {"free": (2, 2), "free_x": (1, 2), "free_y": (2, 1)}  # factors on the extent along y and x
NEAR_PERIODS = 16  # on either side that are summed; the rest is an integral, to 1e-7 of C


@dataclass(frozen=True)
class FreeHalfSpace(HalfSpace):
    """A half-space under the first part of a padded grid; its K on that grid is the inverse of Love's C."""

    boundary: str = "free"

    def stiffness_on(self, grid: Grid) -> np.ndarray:
        stiffness_q = 1 / np.fft.rfft2(self._compliance(grid)).real
        stiffness_q[0, 0] = 0.0
        return stiffness_q

    def mean_stiffness_on(self, grid: Grid) -> float:
        return float(1 / np.sum(self._compliance(grid)))

    def _compliance(self, grid: Grid) -> np.ndarray:
        """Return the displacement under a unit pressure on the first cell, by the shorter way around (m/Pa)."""
        (rows, columns), (dy, dx) = grid.shape, grid.spacing
        y, x = np.arange(rows // 2 + 1) * dy, np.arange(columns // 2 + 1) * dx
        if self.boundary == "free_x":
            quarter = _row_displacement(y, x, dy, dx, grid.size[0], 0.5 * grid.size[1])
        elif self.boundary == "free_y":
            quarter = _row_displacement(x, y, dx, dy, grid.size[1], 0.5 * grid.size[0]).T
        else:
            quarter = _cell_displacement(y, x, dy, dx)
        down, across = (np.minimum(np.arange(n), n - np.arange(n)) for n in (rows, columns))
        return quarter[np.ix_(down, across)] / (np.pi * self.contact_modulus)


def _cell_displacement(y: np.ndarray, x: np.ndarray, dy: float, dx: float) -> np.ndarray:
    """Return ∫∫ dξ dη / r over a cell of sides dy and dx around the origin, at (y, x) (m)."""
    below, above = (y - dy / 2)[:, None], (y + dy / 2)[:, None]
    left, right = (x - dx / 2)[None, :], (x + dx / 2)[None, :]

    def corner(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return u * np.arcsinh(v / np.abs(u)) + v * np.arcsinh(u / np.abs(v))

    return corner(above, right) + corner(below, left) - corner(above, left) - corner(below, right)


def _row_displacement(
    y: np.ndarray, x: np.ndarray, dy: float, dx: float, period: float, reference: float
) -> np.ndarray:
    """Return the sum of that over cells along y, a ``period`` apart, with 2 dy dx/period ln(reference/x) far away (m).

    Far cells are points, and their sum is the integral from midway between two, with a first correction
    (Euler and Maclaurin).
    """
    total = np.zeros((y.size, x.size))
    for m in range(-NEAR_PERIODS, NEAR_PERIODS + 1):
        total += _cell_displacement(y + m * period, x, dy, dx)
    for end in ((NEAR_PERIODS + 0.5) * period + y, (NEAR_PERIODS + 0.5) * period - y):
        along = end[:, None]
        distance = np.hypot(along, x[None, :])
        total -= dy * dx / period * np.log((along + distance) / reference)
        total -= dy * dx / period * along * (period / distance) ** 2 / distance / 24
    return total
