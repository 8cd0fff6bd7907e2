"""Relaxation in periodic subdomains, K' (d − d₀) + φ'(d) + (K d₀ + load) = 0, K' the solid there, rims anchored.

Where a patch jumps, its edge moves for tens of Newton steps while all else rests. Only the change from the gap before,
d₀, is elastic with K'; the next Newton step of the whole grid corrects that.
"""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bem_adhesion.adhesive.newton import MakeSolver
from bem_adhesion.operators import Load
from contact_study.numerics.grid import Grid
from contact_study.numerics.memory import Memory

# Tiles along an axis of the grid and of a subdomain; one tile at each rim is held.
TILES, TILES_OF_SUBDOMAIN = 32, 8
FEWEST_POINTS = 256  # along an axis of a grid, of a subdomain 64, below which little work can be saved
SHARE = 0.2  # fraction of the largest residual above which a point is out of balance
MOST = 4  # subdomains
STEPS = 3  # Newton steps in one subdomain before the whole takes one; more may end in another state


class LocalNewton:
    """A corrector of :class:`NewtonSolver` that relaxes subdomains of its grid."""

    def __init__(self, grid: Grid, make: MakeSolver, memory: Memory | None = None):
        self._tile = grid.shape[0] // TILES, grid.shape[1] // TILES
        rows, columns = (TILES_OF_SUBDOMAIN * tile for tile in self._tile)
        dy, dx = grid.spacing
        subdomain = Grid((rows, columns), (rows * dy, columns * dx))
        self.solver = make(subdomain, memory=memory)
        down, across = _ramp(rows), _ramp(columns)
        self._springs = self.solver.solid.largest * np.maximum(down[:, None], across[None, :]) ** 2

    def correct(
        self, gap: np.ndarray, pressing: np.ndarray, load: Load, right_side: np.ndarray, out: np.ndarray
    ) -> bool:
        """Write a gap that is relaxed where it is far from balance into ``out``; return whether there is one."""
        solver, close = self.solver, self.solver.options.close
        corners = find_subdomains(_largest_of_tiles(right_side, self._tile), close)
        if corners is None:
            return False
        out[...] = gap
        for row, column in corners:
            rows = (row * self._tile[0] + np.arange(solver.grid.shape[0])) % gap.shape[0]
            columns = (column * self._tile[1] + np.arange(solver.grid.shape[1])) % gap.shape[1]
            here = np.ix_(rows, columns)
            local_load = solver.load_for(pressing[here], gap[here], load.pressure)
            # Where subdomains overlap, the next starts from the result of the last.
            start = out[here]
            solver.set_anchor_springs(self._springs, start, stalls=False)
            out[here] = solver.solve(start.copy(), local_load, close, STEPS).gap
        return True


def _ramp(points: int) -> np.ndarray:
    """Return one at both ends, falling to zero over a tile."""
    from_end = np.minimum(np.arange(points), np.arange(points)[::-1])
    return np.maximum(1 - from_end / (points // TILES_OF_SUBDOMAIN), 0)


def _largest_of_tiles(field: np.ndarray, tile: tuple[int, int]) -> np.ndarray:
    """Return the largest magnitude in every tile; the last of an axis may be smaller."""
    rows, columns = (np.arange(0, points, along) for points, along in zip(field.shape, tile, strict=True))

    def over(ufunc: np.ufunc) -> np.ndarray:
        return ufunc.reduceat(ufunc.reduceat(field, rows, axis=0), columns, axis=1)

    return np.maximum(over(np.maximum), -over(np.minimum))


def find_subdomains(largest: np.ndarray, close: float) -> list[tuple[int, int]] | None:
    """Find the first tiles of subdomains that cover all with a residual above ``close``; None without, or too many."""
    inside = np.arange(1, TILES_OF_SUBDOMAIN - 1)
    from_middle = np.abs(inside - inside.mean())
    active = largest > max(SHARE * largest.max(), close)
    corners: list[tuple[int, int]] = []
    magnitude = np.where(active, largest, 0.0)
    while magnitude.any():
        if len(corners) == MOST:
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
