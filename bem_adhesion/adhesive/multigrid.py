"""A load step over grids: predicted on coarser grids, solved on the finest, and checked for saddles.

Full approximation (A. Brandt, Math. Comp. 31, 333 (1977)). Coarse grids jump too early: predictions stay behind.
"""

from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bem_adhesion.adhesive.newton import MakeSolver
from bem_adhesion.adhesive.options import MultigridOptions
from bem_adhesion.kernels.local_law import LocalLaw
from bem_adhesion.operators import Load, Window
from bem_adhesion.solution import NewtonResult, Outcome
from contact_study.numerics.grid import Grid
from contact_study.numerics.memory import Memory
from contact_study.physics.process_zone import process_zone

# Tiles along an axis of the grid and of a subdomain; one tile at each rim is held.
TILES, TILES_OF_SUBDOMAIN = 32, 8
FEWEST_POINTS = 256  # along an axis of a grid, of a subdomain 64, below which little work can be saved
SHARE = 0.2  # fraction of the largest residual above which a point is out of balance
MOST = 4  # subdomains
STEPS = 3  # Newton steps in one subdomain before the whole takes one; more may end in another state


class MultigridSolver:
    """A :class:`NewtonSolver` whose load steps are predicted on coarser grids that resolve the law."""

    def __init__(
        self,
        grid: Grid,
        make: MakeSolver,
        window: Window | None = None,
        memory: Memory | None = None,
        pointwise: LocalLaw | None = None,
    ):
        self.finest = make(grid, window, memory, pointwise)
        self.options = MultigridOptions.of(self.finest.law)
        idle = self.finest.idle
        # A subdomain is periodic and held by its rim alone: not under free boundaries, nor with a spring on its mean.
        solid = self.finest.solid
        alike = solid.elasticity.on_any_grid and window is None and solid.mean_stiffness == 0
        if alike and min(grid.shape) >= FEWEST_POINTS:
            self.finest.corrector = LocalNewton(grid, make, Memory(idle), pointwise)
        pointwise = pointwise or LocalLaw()
        self.points_per_process_zone = process_zone(1.0, self.finest.law) / max(grid.spacing) / pointwise.strongest
        self.coarser: MultigridSolver | None = None
        half = grid.halved
        even = grid.shape[0] % 2 == 0 and grid.shape[1] % 2 == 0
        resolved = self.points_per_process_zone >= 2 * self.options.points_for_prediction
        if even and min(half.shape) >= self.options.fewest_points and resolved:
            own = window and tuple(slice((axis.stop + 1) // 2) for axis in window)
            every_other = pointwise.on((slice(None, None, 2), slice(None, None, 2)))
            self.coarser = MultigridSolver(half, make, own, Memory(idle), every_other)

    def solve(
        self, gap: np.ndarray, load: Load, tolerance: float, max_iterations: int, first_contact: bool = False
    ) -> NewtonResult:
        """Find the minimum that the gap, which is overwritten, descends to; parameters as for :class:`NewtonSolver`."""
        result = self._descend(gap, load, tolerance, max_iterations, first_contact, carries=True)
        while result.outcome is Outcome.CONVERGED:
            load = replace(load, pressure=result.pressure)
            lower = self.leave_saddle(result.gap, load)
            if lower is None:
                break
            used = result.iterations + 1  # leaving a saddle counts: there may be many
            rest = self.finest.solve(lower, load, tolerance, max(max_iterations - used, 0), carries=True)
            outcome = rest.outcome if used <= max_iterations else Outcome.ITERATION_LIMIT
            result = replace(rest, iterations=used + rest.iterations, outcome=outcome)
        return result

    def leave_saddle(self, gap: np.ndarray, load: Load) -> np.ndarray | None:
        """Return a gap of lower energy next to an equilibrium that :attr:`finest` evaluated last; None at a minimum."""
        curvature, level = self.finest.curvature, self
        while level.coarser and level.coarser.points_per_process_zone >= self.options.points_for_curvature:
            curvature, level = np.ascontiguousarray(curvature[::2, ::2]), level.coarser
        if level is not self and not level.finest.find_negative_curvature(curvature, self.options.curvature_margin):
            return None
        unstable = self.finest.find_negative_curvature(self.finest.curvature)
        return self.finest.leave_saddle(gap, load) if unstable else None

    def _descend(
        self,
        gap: np.ndarray,
        load: Load,
        tolerance: float,
        max_iterations: int,
        first_contact: bool,
        known: np.ndarray | None = None,
        carries: bool = False,
    ) -> NewtonResult:
        """Predict and solve; ``known`` is the gap if :attr:`finest` evaluated it last under this load's field."""
        start = gap
        if self.coarser:
            if known is None:
                self.finest.press(gap, load)
            start, known = self._predict(self.coarser, gap, load, max_iterations, first_contact), gap
        return self.finest.solve(start, load, tolerance, max_iterations, first_contact, known, carries=carries)

    def _predict(
        self, coarser: "MultigridSolver", gap: np.ndarray, load: Load, max_iterations: int, first_contact: bool
    ) -> np.ndarray:
        """Predict the solution from a gap that was pressed last; return the gap where the prediction fails."""
        finest, law, options = self.finest, self.finest.law, self.options
        missing = load.missing(gap)
        longest = float(finest.solid.elasticity.stiffness(2 * np.pi / max(finest.grid.size)))
        if missing is None:
            change_of_load = finest.local.imbalance(finest.solid.field, gap, load.pressure)
        else:  # as if the longest wave carried it
            change_of_load = -longest * missing
        # Surfaces that come together jump in at any load.
        lag = max(options.lag / coarser.points_per_process_zone**4, options.least_lag) * law.peak_tensile_stress
        lag = 0.0 if first_contact else lag
        if abs(change_of_load) <= lag:
            return gap
        behind = float(np.copysign(lag, change_of_load))
        start = np.ascontiguousarray(gap[::2, ::2])
        coarse_load = coarser.finest.load_for(finest.solid.field[::2, ::2], start, load.pressure)
        if missing is not None:
            coarse_load = replace(coarse_load, mean_gap=float(start.mean()) + missing)
        lagging = coarse_load.less(behind, longest)
        result = coarser._descend(start, lagging, options.coarse_tolerance, max_iterations, first_contact, start)
        if result.outcome is not Outcome.CONVERGED:
            return gap
        reached = result.gap
        if missing is not None:
            coarse_load = replace(coarse_load, pressure=result.pressure)
        if lag:
            steps = options.tangent_steps if coarser.points_per_process_zone >= options.points_for_steps else 1
            reached = coarser.finest.follow_tangent(reached, coarse_load, options.tangent_limit, steps, reached)
        coarser.finest.single.field[...] = reached - gap[::2, ::2]
        predicted, inside = gap + finest.single.interpolate(coarser.finest.single), finest.inside
        closest = options.closest_prediction * law.equilibrium_distance
        # No gap falls below the smaller of itself and the closest, but where points yield.
        lowest = np.minimum(gap[inside], closest)
        yield_gap = coarser.finest.local.pointwise.yield_gap
        if yield_gap is not None:
            deepened = reached[coarser.finest.inside] < yield_gap
            rows, columns = lowest.shape
            lowest[np.repeat(np.repeat(deepened, 2, axis=0), 2, axis=1)[:rows, :columns]] = -np.inf
        np.maximum(predicted[inside], lowest, out=predicted[inside])
        if law.has_wall:
            touching = np.zeros(reached.shape, bool)
            touching[coarser.finest.inside] = reached[coarser.finest.inside] == 0
            for row, column in np.ndindex(2, 2):  # interpolation leaves a rounding where all neighbours touch
                beside = touching & np.roll(touching, -row, axis=0)
                predicted[row::2, column::2][beside & np.roll(beside, -column, axis=1)] = 0
        return predicted


class LocalNewton:
    """A corrector of :class:`NewtonSolver` that relaxes periodic subdomains of its grid, with their rims anchored.

    It solves K' (d − d₀) + φ'(d) + (K d₀ + load) = 0, K' the solid there. Where a patch jumps, its edge moves for tens
    of Newton steps while all else rests. The next one of all corrects K'.
    """

    def __init__(self, grid: Grid, make: MakeSolver, memory: Memory | None = None, pointwise: LocalLaw | None = None):
        self._pointwise = pointwise or LocalLaw()
        self._tile = grid.shape[0] // TILES, grid.shape[1] // TILES
        rows, columns = (TILES_OF_SUBDOMAIN * tile for tile in self._tile)
        dy, dx = grid.spacing
        subdomain = Grid((rows, columns), (rows * dy, columns * dx))
        self.solver = make(subdomain, memory=memory, pointwise=self._pointwise.on((slice(rows), slice(columns))))
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
            solver.local.pointwise = self._pointwise.on(here)
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
