"""A load step over grids: predicted on coarser ones, solved on the finest, and held against saddles.

Full approximation: the coarse grid solves for the *change* of the gap, with the fine grid's residual on its right
side, so that the prediction is exact in everything the coarse grid resolves (A. Brandt, Math. Comp. 31, 333 (1977)).
One prediction a load step: repeated cycles end in another minimum of the non-convex energy, or in none.

Where a patch of the contact snaps in or tears off, each grid lets it go at a load of its own, the coarse one as a rule
too early, and the energy does not tell: the state behind the jump is the lower one. A prediction must not decide such
a jump. So it stays behind the load by more than the loads of two grids differ, and the rest of the way is one step
along the tangent there; what happens on it the fine grid decides by itself. A prediction that does not converge, or
that finds no contact, is dropped.
"""

from dataclasses import replace

import numpy as np
from numba import njit

from bem_adhesion.adhesive.local_newton import LocalNewton
from bem_adhesion.adhesive.newton import NewtonSolver
from bem_adhesion.operators.fourier import MakeOperator
from bem_adhesion.operators.free_space import Window
from bem_adhesion.operators.load import Load
from bem_adhesion.process_zone import process_zone
from bem_adhesion.solution import NewtonResult, Outcome
from contact_study.numerics.grid import Grid
from contact_study.numerics.memory import Memory
from contact_study.physics.laws.base import TractionLaw

# A coarser grid still predicts: down to this many points it saves more work than it costs.
POINTS_FOR_PREDICTION = 1.25
# Tolerance on the coarse grids: their solutions are predictions. With 1e-4 three paths (1024², 4 ε0) take 4 % more
# pairs, with 1e-3 the first load at 8 ε0 two fifths more. At the edges of contact with a wall interpolation leaves a
# residual of 0.3, and what is solved to less than the second number is wasted.
COARSE_TOLERANCE, COARSE_TOLERANCE_AT_WALL = 3e-4, 1e-2
# A prediction takes no gap below this fraction of the equilibrium distance, or further below than it was.
CLOSEST_PREDICTION = 0.85
# How far a prediction stays behind the load, in units of the law's peak stress: so much for a coarse grid of one point
# to the process zone, less with the fourth power of the points (the sampled law converges fast), but never less than
# the second number. With 0.02 in place of the first two of 2160 steps at 8 ε0 (160² points) end in another state than
# on one grid, with 0.05 none; with 0.2 and 1e-3 paths at 1024² and 4 ε0 take two fifths more pairs.
LAG, LEAST_LAG = 0.05, 1e-4
# Largest relative change of a gap on the rest of the way; where the tangent asks for more a fold is near. With 0.3
# three paths at 1024² and 8 ε0 take 6 % fewer pairs, and one of 609 steps at ε0 (160² points) pulls off too early.
TANGENT_LIMIT = 0.1
# Steps on the rest of the way. One leaves a residual of 3e-4; with so many points to a process zone of the coarse grid
# that is more than interpolation leaves on the finer one (2e-5; with half as many points 2e-3), and two more pay: at ε0
# and 2048² points 28 pairs a load step in place of 41.
TANGENT_STEPS, POINTS_FOR_STEPS = 3, 32
# The coarsest grid to look for negative curvature on, in points to the process zone, and what raises the softening
# there. From 4 points on a coarse grid reaches a fold at the finest grid's softening or at less: by 0.2 % at 4 ε0, up
# to a third at ε0 (28 states): what is none there is none on the finest. States beside strong adhesion's jumps lie 2 to
# 10 % from a fold; a larger margin sends them all to the finest.
POINTS_FOR_CURVATURE, CURVATURE_MARGIN = 4, 1.05
# Points along an axis below which a grid is not halved: nothing is left to save.
FEWEST_POINTS = 8


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _correct(gap, change, closest, out):
    """Write the changed gap, but let none fall below the smaller of itself and ``closest``."""
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            d = gap[i, j]
            out[i, j] = max(d + change[i, j], min(d, closest))


def _touch(touching: np.ndarray, fine: np.ndarray) -> None:
    """Let points touch the wall where all next to them on the coarse grid do; interpolation rounds them off it."""
    beside = touching & np.roll(touching, -1, axis=1)
    fine[::2, ::2][touching] = 0
    fine[::2, 1::2][beside] = 0
    fine[1::2, ::2][touching & np.roll(touching, -1, axis=0)] = 0
    fine[1::2, 1::2][beside & np.roll(beside, -1, axis=0)] = 0


class MultigridSolver:
    """An :class:`NewtonSolver` whose load steps are predicted on coarser grids where these resolve the law.

    Parameters as for :class:`NewtonSolver`, and whether the solid is known on squares of the grid. The coarser grids
    lie in memory that the finest does without meanwhile.
    """

    def __init__(
        self,
        grid: Grid,
        make_operator: MakeOperator,
        law: TractionLaw,
        shift: float,
        window: Window | None = None,
        memory: Memory | None = None,
        squares: bool = True,
    ):
        self.finest = NewtonSolver(grid, make_operator, law, shift, window, memory)
        idle = self.finest.idle
        # A square is periodic and held by its rim alone: not under free boundaries, nor with a spring on its mean.
        squares = squares and window is None and self.finest.solid.mean_stiffness == 0
        if squares and LocalNewton.fits(grid):
            self.finest.relaxation = LocalNewton(grid, make_operator, law, shift, Memory(idle))
        self.points_per_process_zone = process_zone(1.0, law) / max(grid.spacing)
        self.coarser: MultigridSolver | None = None
        half = grid.with_shape((grid.shape[0] // 2, grid.shape[1] // 2))
        even = grid.shape[0] % 2 == 0 and grid.shape[1] % 2 == 0
        if even and min(half.shape) >= FEWEST_POINTS and self.points_per_process_zone >= 2 * POINTS_FOR_PREDICTION:
            coarse_window = None if window is None else window.halved
            self.coarser = MultigridSolver(half, make_operator, law, shift, coarse_window, Memory(idle), squares)

    def equivalent_pairs(self, grid: Grid) -> float:
        """Transform pairs done so far on all grids, as float64 pairs on ``grid``."""
        coarser = self.coarser.equivalent_pairs(grid) if self.coarser else 0.0
        return self.finest.equivalent_pairs(grid) + coarser

    def solve(
        self, gap: np.ndarray, load: Load, tolerance: float, max_iterations: int, approach: bool = False
    ) -> NewtonResult:
        """The minimum of the energy that the gap, which is overwritten, falls into.

        Parameters as :meth:`NewtonSolver.solve`. An equilibrium with a direction of negative curvature is left along
        it.
        """
        result = self._descend(gap, load, tolerance, max_iterations, approach, carries=True)
        while result.outcome is Outcome.CONVERGED:
            lower = self.beside_saddle(result.gap, load)
            if lower is None:
                break
            used = result.iterations + 1  # leaving a saddle counts: there may be one after the other
            rest = self.finest.solve(
                lower, load, tolerance, max(max_iterations - used, 0), overwrite=True, carries=True
            )
            outcome = rest.outcome if used <= max_iterations else Outcome.ITERATION_LIMIT
            result = replace(rest, iterations=used + rest.iterations, outcome=outcome)
        return result

    def beside_saddle(self, gap: np.ndarray, load: Load) -> np.ndarray | None:
        """A gap of lower energy next to an equilibrium that :attr:`finest` has evaluated last; None at a minimum."""
        return self.finest.beside_saddle(gap, load) if self._has_negative_curvature() else None

    def _descend(
        self,
        gap: np.ndarray,
        load: Load,
        tolerance: float,
        max_iterations: int,
        approach: bool,
        known: np.ndarray | None = None,
        carries: bool = False,
    ) -> NewtonResult:
        """``known`` is None, or the gap itself if :attr:`finest` has evaluated it last under this load's field."""
        start = gap
        # The spring of gap control overshoots on its way to the gap: it takes no predictions but the first.
        if self.coarser and (approach or self.finest.solid.mean_stiffness == 0):
            if known is None:
                self.finest.press(gap, load)
            start, known = self._predict(self.coarser, gap, load, max_iterations, approach), gap
        return self.finest.solve(
            start, load, tolerance, max_iterations, approach, known, overwrite=True, carries=carries
        )

    def _predict(
        self, coarser: "MultigridSolver", gap: np.ndarray, load: Load, max_iterations: int, approach: bool
    ) -> np.ndarray:
        """The gap that the coarser grids foresee, of one that was pressed last; the start where they foresee none."""
        law = self.finest.law
        change_of_load = self.finest.imbalance(gap, load)
        # Surfaces that come together snap in at any load.
        lag = 0.0 if approach else max(LAG / coarser.points_per_process_zone**4, LEAST_LAG) * law.peak_tensile_stress
        if abs(change_of_load) <= lag:
            return gap
        behind = float(np.copysign(lag, change_of_load))
        start = np.ascontiguousarray(gap[::2, ::2])
        coarse_load = coarser.finest.load_that_presses(self.finest.solid.field[::2, ::2], start, load.pressure)
        tolerance = COARSE_TOLERANCE_AT_WALL if law.has_wall else COARSE_TOLERANCE
        result = coarser._descend(start, coarse_load - behind, tolerance, max_iterations, approach, start)
        if result.outcome is not Outcome.CONVERGED:
            return gap
        reached = result.gap
        if lag:
            steps = TANGENT_STEPS if coarser.points_per_process_zone >= POINTS_FOR_STEPS else 1
            reached = coarser.finest.on_tangent(reached, coarse_load, TANGENT_LIMIT, steps, reached)
        change = self.finest.interpolated(coarser.finest, reached - gap[::2, ::2])
        predicted, inside = gap + change, self.finest.window.inside
        _correct(inside(gap), inside(change), CLOSEST_PREDICTION * law.equilibrium_distance, inside(predicted))
        if law.has_wall:
            touching = np.zeros(reached.shape, bool)
            coarser.finest.window.inside(touching)[...] = coarser.finest.window.inside(reached) == 0
            _touch(touching, predicted)
        return predicted

    def _has_negative_curvature(self) -> bool:
        """Whether the state that :attr:`finest` has just solved for is no minimum.

        Unstable modes are as wide as the process zone: a coarse grid that resolves it finds them for less. Where it
        finds one, the finest has the last word.
        """
        curvature, level = self.finest.curvature, self
        while level.coarser and level.coarser.points_per_process_zone >= POINTS_FOR_CURVATURE:
            curvature, level = np.ascontiguousarray(curvature[::2, ::2]), level.coarser
        if level is not self and not level.finest.find_negative_curvature(curvature, CURVATURE_MARGIN):
            return False
        return self.finest.find_negative_curvature(self.finest.curvature)
