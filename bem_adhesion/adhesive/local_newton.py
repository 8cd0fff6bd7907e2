"""What is out of balance in a few places only, brought closer to it there: the contact on parts of the grid.

Where a patch of the contact snaps in or tears off, its edge runs for tens of Newton steps while all else stands still.
:class:`LocalNewton` lets it take three of four on a periodic square of a quarter of the grid's points along each
axis, at a sixteenth of the work. Its load is what balances the whole contact's residual at the start,

    K' (d − d₀) + φ'(d) + (K d₀ + load) = 0,

K' the solid on the square, so that only the *change* of the gap is elastic there. Springs hold the rim where it was. A
change of compact support V = ∫ (d − d₀) acts at a distance r by E* V / 2π r³: what K' lacks of it, and what the rim
keeps from giving way, is left to the next Newton step of the whole.
"""

import numpy as np
from numba import njit
from numpy.lib.stride_tricks import sliding_window_view

from bem_adhesion.adhesive.newton import CLOSE, NewtonSolver
from bem_adhesion.operators.fourier import MakeOperator
from bem_adhesion.operators.load import Load
from contact_study.numerics.grid import Grid
from contact_study.numerics.memory import Memory
from contact_study.physics.laws.base import TractionLaw

# The grid has so many tiles along an axis, a square so many, of which one at each rim is held.
TILES, TILES_OF_SQUARE = 32, 8
# Points along a square's axis below which little is left to save: on 160² points, squares of 40, one pair in a hundred.
FEWEST_POINTS = 64
# A point is out of balance by this fraction of the largest residual. With 0.1 and 0.05 three paths of the paper's
# surface (512², 4 ε0 and twice 8 ε0) take 5 % and 10 % more pairs, in the same states.
SHARE = 0.2
# More squares than this are no few places: with a share of 0.1 the same paths take as many pairs with 2, 19 % more
# with 8.
MOST_SQUARES = 4
# Newton steps of one square before the whole takes one. A place that runs further ahead of the rest may end in another
# state: of 160 steps on the paper's surface (400², 8 ε0, ten seeds, loading, unloading, tension) none does with 3, two
# with 5, and with 60 also the step from 1 to 2 GPa of the first seed.
STEPS = 3


class LocalNewton:
    """Squares of a grid and the contact on one of them.

    Parameters
    ----------
    grid : Grid
        The grid of the whole contact.
    make_operator, law, shift, memory
        As of :class:`NewtonSolver`.
    """

    def __init__(
        self, grid: Grid, make_operator: MakeOperator, law: TractionLaw, shift: float, memory: Memory | None = None
    ):
        self._tile = grid.shape[0] // TILES, grid.shape[1] // TILES
        shape = TILES_OF_SQUARE * self._tile[0], TILES_OF_SQUARE * self._tile[1]
        dy, dx = grid.spacing
        square = Grid(shape, (shape[0] * dy, shape[1] * dx))
        self._contact = NewtonSolver(square, make_operator, law, shift, memory=memory)
        rim = np.maximum(_ramp(shape[0])[:, None], _ramp(shape[1])[None, :])
        self._springs = self._contact.solid.largest * rim**2

    @staticmethod
    def fits(grid: Grid) -> bool:
        """Whether a grid has enough points."""
        return min(grid.shape) * TILES_OF_SQUARE >= FEWEST_POINTS * TILES

    def equivalent_pairs(self, grid: Grid) -> float:
        """Transform pairs done so far, as float64 pairs on ``grid``."""
        return self._contact.equivalent_pairs(grid)

    def relax(
        self,
        gap: np.ndarray,
        pressing: np.ndarray,
        load: Load,
        right_side: np.ndarray,
        out: np.ndarray,
    ) -> bool:
        """Write into ``out`` a gap closer to balance where it is far from it; whether these places are few.

        Parameters
        ----------
        gap, pressing : numpy.ndarray
            The state of the whole, and K d with the load's field.
        load : Load
            On the whole.
        right_side : numpy.ndarray
            What it is out of balance by.
        out : numpy.ndarray
            The new gap.
        """
        corners = _squares(_largest_of_tiles(right_side, self._tile))
        if corners is None:
            return False
        out[...] = gap
        square = self._contact
        for row, column in corners:
            rows = (row * self._tile[0] + np.arange(square.grid.shape[0])) % gap.shape[0]
            columns = (column * self._tile[1] + np.arange(square.grid.shape[1])) % gap.shape[1]
            here = np.ix_(rows, columns)
            local_load = square.load_that_presses(pressing[here], gap[here], load.pressure)
            # Where squares overlap, the next goes on from what the last one left.
            start = out[here]
            square.tie(self._springs, start, stalls=False)
            out[here] = square.solve(start, local_load, CLOSE, STEPS).gap
        return True


def _ramp(points: int) -> np.ndarray:
    """One at both ends, falling to zero over a tile."""
    tile = points // TILES_OF_SQUARE
    from_end = np.minimum(np.arange(points), np.arange(points)[::-1])
    return np.maximum(1 - from_end / tile, 0)


def _largest_of_tiles(field: np.ndarray, tile: tuple[int, int]) -> np.ndarray:
    """Largest magnitude in every tile; the last of an axis may be smaller."""
    largest = np.zeros([-(-points // along) for points, along in zip(field.shape, tile, strict=True)], field.dtype)
    _raise_to_largest(field, *tile, largest)
    return largest


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _raise_to_largest(field, rows, columns, largest):
    for i in range(field.shape[0]):
        of_row = largest[i // rows]
        for tile in range(of_row.size):
            found = of_row[tile]
            for j in range(tile * columns, min((tile + 1) * columns, field.shape[1])):
                found = max(found, abs(field[i, j]))
            of_row[tile] = found


def _squares(largest: np.ndarray) -> list[tuple[int, int]] | None:
    """First tiles of the squares within whose rims everything out of balance lies; None if those are not few.

    The worst tile gets the square that has most others in it, or the one that it is in the middle of.
    """
    inside = np.arange(1, TILES_OF_SQUARE - 1)
    from_middle = np.abs(inside - inside.mean())
    active = largest > max(SHARE * largest.max(), CLOSE)
    corners: list[tuple[int, int]] = []
    magnitude = np.where(active, largest, 0.0)
    while magnitude.any():
        if len(corners) == MOST_SQUARES:
            return None
        worst = np.unravel_index(magnitude.argmax(), magnitude.shape)
        around = np.pad(active, (0, inside.size), mode="wrap")[1:, 1:]
        found = sliding_window_view(around, (inside.size, inside.size)).sum(axis=(2, 3))
        rows, columns = (worst[0] - inside) % active.shape[0], (worst[1] - inside) % active.shape[1]
        merit = found[np.ix_(rows, columns)] - 1e-2 * (from_middle[:, None] + from_middle[None, :])
        best = np.unravel_index(merit.argmax(), merit.shape)
        row, column = int(rows[best[0]]), int(columns[best[1]])
        corners.append((row, column))
        covered = np.ix_((row + inside) % active.shape[0], (column + inside) % active.shape[1])
        magnitude[covered], active[covered] = 0.0, False
    return corners or None
