"""Adhesive contact of an elastic solid with a rough rigid one under any traction-separation law.

The gap d minimises ½<d, K d> + <φ(d)> + <load·d>: K is the elastic solid, φ the law, and the load K h + p the
pressure that flattens the heights h and the nominal one (:mod:`bem_adhesion.operators.load`). The energy is not convex;
the solver descends from the given state into the minimum next to it.

Newton's method with inexact linear solves in float32 (:mod:`bem_adhesion.linear.conjugate_gradients`); energy and
residual at a gap are those of :mod:`bem_adhesion.adhesive.energy`, in its units. Negative curvature of the law is faded
by a factor 1 − fading when a linear solve meets a descent of the whole quadratic model, and restored after successful
steps.
"""

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from bem_adhesion.adhesive.energy import ContactEnergy
from bem_adhesion.kernels.law import EnergyAndGradient
from bem_adhesion.kernels.springs import DraggedPasses
from bem_adhesion.linear.conjugate_gradients import LinearisedContact
from bem_adhesion.linear.contact_stiffness import mean_stiffness
from bem_adhesion.linear.preconditioner import preconditioner_for
from bem_adhesion.operators.fourier import MakeOperator
from bem_adhesion.operators.free_space import Window
from bem_adhesion.operators.load import Load
from bem_adhesion.solution import NewtonResult, Outcome
from contact_study.numerics.balance import Excess
from contact_study.numerics.grid import Grid
from contact_study.numerics.inner_product import inner_product
from contact_study.numerics.memory import Memory
from contact_study.numerics.multigrid import SHORT_WAVES
from contact_study.physics.laws.base import TractionLaw

if TYPE_CHECKING:
    from bem_adhesion.adhesive.local_newton import LocalNewton

# Reduction of the residual asked of a linear solve: with the full curvature, and while it is faded. Below the residual
# CLOSE (in units of the contact modulus) Newton's steps earn a better one, but none beyond the tolerance.
REDUCTION, FADED_REDUCTION = 0.1, 0.3
CLOSE, CLOSE_REDUCTION, BEYOND_TOLERANCE = 1e-3, 0.03, 0.5
LINEAR_ITERATIONS = 60
# Largest relative change of an attracted gap in one step.
STEP_LIMIT = 0.4
# Fading of negative curvature: first value, growth on failure, decay on success.
FADING_START, FADING_GROWTH, FADING_DECAY = 0.1, 3.0, 0.6
# Surfaces that come together from separation snap in everywhere at once. Above this residual (in units of the contact
# modulus) negative curvature is then faded out: the descent ends in the state of a slow gradient flow, for a quarter
# more work (first load of 82 contacts, ε0 … 8ε0: all in that state; without, 5 of 34 are not).
APPROACH_RESIDUAL = 0.2
# Below this residual (in units of the contact modulus) a state with negative curvature is left along that direction,
# by this step (in units of the law's length). Larger residuals are no saddles: there the step changed the branch.
SADDLE_RESIDUAL, SADDLE_STEP = 0.2, 0.1
# So many such steps in a row leave no saddle: points snap in one after the other, each by tens of steps, as on grids
# that do not resolve the process zone. Curvature is then faded. States of grids that do take 6 at most.
SADDLE_STEPS = 50
# Iterations of conjugate gradients that look for negative curvature at an equilibrium. With the softening raised beyond
# the fold by 10 % it shows within 5, by 5 % within 7, by 2 % within 10 (52 states, ε0 … 8ε0, 400² and 800² points).
CURVATURE_ITERATIONS = 8
# A residual above which places are relaxed by themselves (in units of the contact modulus). With 0.05 six paths of the
# paper's surface (400², 8 ε0) take 5 % more pairs.
FAR = 5e-3
# Outside a wall, where the points held are others after every step: the reduction asked of a linear solve, and ω of the
# preconditioner's short waves (:mod:`contact_study.numerics.multigrid`). With the smooth laws' 12 paths of 12 steps
# (256², exponential and Dugdale) take 8 % more pairs.
REDUCTION_AT_WALL, SHORT_WAVES_AT_WALL = 0.2, 2.5
BACKTRACKING, SHORTEST_STEP = 0.4, 1e-4
# A step of surfaces apart so many times as long as the largest gap is that of a mean which rounding alone holds.
LONGEST_FALL = 100
# Energies closer than this (relative) are equal to rounding; the residual decides then.
ENERGY_ROUNDING = 1e-9
# At the end the residual is formed anew where what was rounded off may be more than this share of the tolerance.
SHARE_OF_TOLERANCE = 0.01


class NewtonSolver(ContactEnergy):
    """The discretised contact on one grid, with the work space of its solver.

    Parameters
    ----------
    grid, make_operator, law, window, memory
        As of :class:`ContactEnergy`. Between two calls the memory's arrays hold ``solid.field`` alone, see ``known``
        of :meth:`solve`.
    shift : float
        Stiffness of the preconditioner, see :class:`LinearisedContact`.

    Attributes
    ----------
    idle : numpy.ndarray of uint8
        Memory that it does not need between two of its linear solves, for what else is to be solved there.
    """

    def __init__(
        self,
        grid: Grid,
        make_operator: MakeOperator,
        law: TractionLaw,
        shift: float,
        window: Window | None = None,
        memory: Memory | None = None,
    ):
        memory = memory or Memory()
        super().__init__(grid, make_operator, law, window, memory)
        self._stalls = False
        self._saddle_steps = 0  # in a row
        self.relaxation: LocalNewton | None = None
        self._reduction = REDUCTION_AT_WALL if law.has_wall else REDUCTION
        short_waves = SHORT_WAVES_AT_WALL if law.has_wall else SHORT_WAVES
        self._bed = preconditioner_for(self._single, partial(make_operator, memory=memory), shift, short_waves)
        self._linearised = LinearisedContact(self._single, shift, self._bed, memory)
        self.idle = self._linearised.idle

    def equivalent_pairs(self, grid: Grid) -> float:
        """Transform pairs done so far, as float64 pairs on ``grid``."""
        single = self._single.equivalent_pairs(grid) + self._bed.equivalent_pairs(grid)
        local = self.relaxation.equivalent_pairs(grid) if self.relaxation else 0.0
        return self.solid.equivalent_pairs(grid) + single + local

    def tie(self, drag: float | np.ndarray, anchor: np.ndarray, stalls: bool = True) -> None:
        """Tie every point to a gap by springs of that stiffness; by none if it is zero.

        A solve then stalls where they leave negative curvature, or goes on if it is told not to.
        """
        tied = bool(np.any(drag))
        self._passes = DraggedPasses(self._free_passes, drag, anchor) if tied else self._free_passes
        self._stalls = tied and stalls

    def _newton_step(
        self, gap: np.ndarray, state: EnergyAndGradient, fading: float, excess: Excess
    ) -> tuple[float, bool] | None:
        """Leave a step in ``_linearised.solution``; returns the fading it took, and if that had to be raised.

        None where points are tied and yet there is negative curvature.
        """
        # While points snap in the mean pressure may wait.
        light = excess.load > excess.residual and state.largest < CLOSE
        taken = self._curved_step(state, fading, excess, light)
        step = self._linearised.solution
        if light or max(step.max(), -step.min()) > LONGEST_FALL * self.window.inside(gap).max():
            self._shorten_fall(gap, abs(state.total))
        return taken

    def _curved_step(
        self, state: EnergyAndGradient, fading: float, excess: Excess, light: bool
    ) -> tuple[float, bool] | None:
        """As :meth:`_newton_step`; where the load is light its mean is reduced as well as the residual."""
        raised, largest = False, state.largest
        while True:
            reduction = self._reduction_at(largest, max(excess)) if fading == 0 else FADED_REDUCTION
            total = reduction * abs(state.total) if light else np.inf
            result = self._linearised.solve(
                self._right_side, self.curvature, 1 - fading, reduction, LINEAR_ITERATIONS, total
            )
            self._passes.hold(self.curvature, self._linearised.solution)
            self._passes.hold(self.curvature, self._linearised.direction)
            if not result.negative_curvature:
                self._saddle_steps = self._saddle_steps if fading else 0
                return fading, raised
            if self._stalls:
                return None
            if fading == 1:
                # K + D⁺ has no negative curvature: it is zero to the rounding of single precision, as where next to
                # nothing acts on the mean gap. What was reached before is a descent.
                if result.iterations == 1:
                    self._linearised.solution[...] = self._along_direction(self.law.length)
                return fading, raised
            if fading == 0 and not raised and largest < SADDLE_RESIDUAL and self._saddle_steps < SADDLE_STEPS:
                self._saddle_steps += 1
                self._linearised.solution += self._along_direction(SADDLE_STEP * self.law.length)
                return fading, raised
            fading = _more(fading)
            raised = True

    def _shorten_fall(self, gap: np.ndarray, missing: float) -> None:
        """Let surfaces that do not touch come down as a whole, until a point touches or carries all that is missing.

        A limit at each point by itself would bend the solid.
        """
        step, gap = self.window.inside(self._linearised.solution), self.window.inside(gap)
        closest, lowest = float(gap.min()), float(self.law.repulsive_gap(np.array(-missing)))
        if closest < self.law.equilibrium_distance or closest <= lowest:
            return
        least = float(np.finfo(np.float32).tiny)
        room = float(np.min((gap - lowest) / np.maximum(-step, least)))
        limit = STEP_LIMIT * (closest + self._passes.margin) / max(float(np.abs(step).max()), least)
        # A wall stops what would pass it by a rounding.
        self._linearised.solution *= np.float32(min(1.0, limit, (1 + 1e-6) * room))

    def _reduction_at(self, largest: float, excess: float) -> float:
        """Reduction of the residual to ask of a linear solve with the full curvature."""
        if largest > CLOSE:
            return self._reduction
        return min(max(BEYOND_TOLERANCE / excess, CLOSE_REDUCTION), FADED_REDUCTION)

    def _along_direction(self, length: float) -> np.ndarray:
        """A step of that largest component along the last search direction, downhill."""
        direction = self._linearised.direction
        downhill = 1.0 if inner_product(self._right_side, direction) >= 0 else -1.0
        return np.float32(downhill * length / np.abs(direction).max()) * direction

    def find_negative_curvature(self, curvature: np.ndarray, softening: float = 1.0) -> bool:
        """Whether conjugate gradients meet a direction of negative curvature of K + D⁺ + softening·D⁻.

        The direction is kept for :meth:`beside_saddle`. The right side is random (the same each time) and lies where
        the law softens, as every unstable mode does.

        Parameters
        ----------
        curvature : numpy.ndarray of float32, shape grid.shape
            D = φ''.
        softening : float, optional
            Factor on the negative part of D.
        """
        random = np.random.default_rng(0).standard_normal(curvature.shape, dtype=np.float32)
        np.multiply(1 + random, np.maximum(-curvature, 0), out=self._right_side)
        largest = np.abs(self._right_side).max()
        if largest == 0:
            return False
        # At unit size: of a tail of next to nothing single precision knows no squares, and zero is no direction.
        self._right_side /= largest
        result = self._linearised.solve(self._right_side, curvature, softening, 0.0, CURVATURE_ITERATIONS)
        return result.negative_curvature

    def beside_saddle(self, gap: np.ndarray, load: Load) -> np.ndarray | None:
        """A gap of lower energy along the last search direction; None if rounding leaves none to be found."""
        energy = self._evaluate(gap, load).energy
        direction = self._linearised.direction
        self._passes.hold(self.curvature, direction)
        direction /= np.abs(direction).max()
        beside = np.empty_like(gap)
        length = SADDLE_STEP * self.law.length
        while length > SHORTEST_STEP * self.law.length:
            for step in (length, -length):
                self._passes.advance(gap, np.float32(step) * direction, STEP_LIMIT, beside)
                if self._evaluate(beside, load).energy < energy:
                    return beside
            length *= BACKTRACKING
        return None

    def mean_stiffness(self, gap: np.ndarray) -> float:
        """By how much more pressure the mean gap gives way at an equilibrium, see :func:`tangent.mean_stiffness`."""
        self._passes.evaluate(gap, np.empty_like(gap), self.curvature)
        return mean_stiffness(self._linearised, self.curvature, self._passes.pin(self.curvature, gap))

    def on_tangent(
        self, gap: np.ndarray, load: Load, limit: float, steps: int = 1, known: np.ndarray | None = None
    ) -> np.ndarray:
        """The gap after Newton steps, as far as no gap changes by more than the fraction ``limit`` in all.

        ``known`` as of :meth:`solve`.
        """
        start = gap
        for _ in range(steps):
            self._evaluate_from(known, gap, load)
            result = self._linearised.solve(self._right_side, self.curvature, 1.0, REDUCTION, LINEAR_ITERATIONS)
            step = self._linearised.solution
            self._passes.hold(self.curvature, step)
            inside = self.window.inside
            change = np.abs(inside(gap - start + step) / (inside(start) + self._passes.margin))
            if result.negative_curvature or change.max() > limit:
                break
            moved = np.empty_like(gap)
            self._passes.advance(gap, step, STEP_LIMIT, moved)
            known, gap = gap, moved
        return gap

    def solve(
        self,
        gap: np.ndarray,
        load: Load,
        tolerance: float,
        max_iterations: int,
        approach: bool = False,
        known: np.ndarray | None = None,
        overwrite: bool = False,
        carries: bool = False,
    ) -> NewtonResult:
        """Descend from ``gap`` to the next equilibrium.

        Parameters
        ----------
        gap : numpy.ndarray, shape grid.shape
            Initial gap, > 0.
        load : Load
            On the block.
        tolerance : float
            Largest max|gradient| of a solution.
        max_iterations : int
            Largest number of Newton iterations.
        approach : bool, optional
            Whether the surfaces come together from separation, see :data:`APPROACH_RESIDUAL`.
        known : numpy.ndarray, optional
            A gap, this or another, that was evaluated last under this load's field: by :meth:`press`, or as a result.
        overwrite : bool, optional
            Whether ``gap`` and ``known`` are given away: one array less, or two.
        carries : bool, optional
            Whether a solution has to carry its load however light, see :mod:`contact_study.numerics.balance`; a
            prediction need not.
        """
        state = self._evaluate_from(known, gap, load)
        trial = known if overwrite and known is not None and known is not gap else np.empty_like(gap)
        gap = gap if overwrite else gap.copy()
        fading, iteration, stepped = 0.0, 0, True
        self._saddle_steps = 0

        def excess_of(state: EnergyAndGradient) -> Excess:
            return self.excess_of(state, gap, load, tolerance) if carries else Excess(state.largest / tolerance, 0.0)

        while True:
            excess = excess_of(state)
            if excess.balanced and self._rounded * excess.residual > SHARE_OF_TOLERANCE * state.largest:
                state = self._evaluate(gap, load)
                excess = excess_of(state)
            self.solid.mark("iteration", state.largest)
            if excess.balanced:
                outcome = Outcome.CONVERGED
                break
            if self._runs_away(gap, state):
                outcome = Outcome.DETACHED
                break
            if iteration == max_iterations:
                outcome = Outcome.ITERATION_LIMIT
                break
            if stepped and self._relax(gap, load, state, trial):
                stepped = False
                relaxed = self._evaluate_change(gap, trial, load)
                if relaxed.energy < state.energy:
                    gap, trial, state, fading = trial, gap, relaxed, 0.0
                else:
                    self._take_back()
                    state = self._state(gap, load)
                continue
            stepped = True
            iteration += 1
            approaching = approach and state.largest > APPROACH_RESIDUAL
            taken = self._newton_step(gap, state, 1.0 if approaching else fading, excess)
            if taken is None:
                outcome = Outcome.STALLED
                break
            faded, raised = taken
            new_state, fraction = self._line_search(gap, load, state, trial)
            if new_state is None:
                if faded == 1:
                    outcome = Outcome.STALLED
                    break
                fading = 1.0
                state = self._state(gap, load)  # the trials have overwritten curvature and right side
                continue
            if not approaching:
                fading = _fading_after(faded, raised, fraction)
            gap, trial = trial, gap
            state = new_state
        # The solver has evaluated this gap last.
        reaction = self._passes.reaction(self.solid.field, gap, load.pressure)
        return NewtonResult(gap, reaction, state.largest, iteration, outcome)

    def _relax(self, gap: np.ndarray, load: Load, state: EnergyAndGradient, out: np.ndarray) -> bool:
        """Leave in ``out`` a gap closer to balance in the few places far from it; whether there is anything to it."""
        tied = self._passes is not self._free_passes
        if self.relaxation is None or state.largest <= FAR or tied:
            return False
        return self.relaxation.relax(gap, self.solid.field, load, self._right_side, out)

    def _line_search(
        self, gap: np.ndarray, load: Load, state: EnergyAndGradient, trial: np.ndarray
    ) -> tuple[EnergyAndGradient | None, float]:
        """Shorten the step until the energy falls, leaving the new gap in ``trial``; None if it never does."""
        step, fraction = self._linearised.solution, 1.0
        while fraction > SHORTEST_STEP:
            self._passes.advance(gap, step, STEP_LIMIT, trial)
            new = self._evaluate_change(gap, trial, load)
            equal = new.energy <= state.energy + ENERGY_ROUNDING * abs(state.energy)
            if new.energy <= state.energy or (equal and new.square < state.square):
                return self._unless_rounded(new, trial, load), fraction
            self._take_back()
            step *= np.float32(BACKTRACKING)
            fraction *= BACKTRACKING
        return None, fraction


def _fading_after(faded: float, raised: bool, fraction: float) -> float:
    """Fading after a step that was taken with one, that had to be raised or not, and taken in part or whole."""
    if fraction < 1:
        return _more(faded)
    if raised:
        return faded
    return faded * FADING_DECAY if faded > 0.9 * FADING_START else 0.0


def _more(fading: float) -> float:
    return min(1.0, max(FADING_GROWTH * fading, FADING_START))
