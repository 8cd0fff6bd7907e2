"""Newton descent of an adhesive contact on one grid, under any traction-separation law.

The gap d minimises ½<d, K d> + <φ(d)> + <load·d>: K is the elastic solid, φ the law, and the load K h + p the pressure
that flattens the heights h and the nominal one (:mod:`bem_adhesion.operators.load`). The energy is not convex; the
solver descends from the given state into the minimum next to it.

Linear problems are solved inexactly in float32 (:mod:`bem_adhesion.linear.conjugate_gradients`). Negative curvature of
the law is multiplied by 1 − damping when a linear solve finds a descent of the whole quadratic model, and restored
after successful steps.
"""

from functools import partial
from typing import NamedTuple, Protocol

import numpy as np

from bem_adhesion.adhesive.energy import ContactEnergy
from bem_adhesion.adhesive.options import NewtonOptions
from bem_adhesion.kernels.local_energy import EnergyAndGradient
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
from contact_study.physics.laws.base import TractionLaw


class Corrector(Protocol):
    """A cheaper correction of a state that is far from balance in parts of the grid."""

    def correct(
        self, gap: np.ndarray, pressing: np.ndarray, load: Load, right_side: np.ndarray, out: np.ndarray
    ) -> bool:
        """Write a gap closer to balance into ``out``; return whether there is one."""

    def equivalent_pairs(self, grid: Grid) -> float:
        """Return the transform pairs so far, as float64 pairs on ``grid``."""


class _Step(NamedTuple):
    """Damping that a Newton step used, and whether it had to be raised for it."""

    damping: float
    raised: bool


class NewtonSolver(ContactEnergy):
    """A :class:`ContactEnergy` with its Newton descent; ``shift`` is that of :class:`LinearisedContact`.

    Its ``idle`` memory is free for another solver between two linear solves.
    """

    def __init__(
        self,
        grid: Grid,
        make_operator: MakeOperator,
        law: TractionLaw,
        shift: float,
        window: Window | None = None,
        memory: Memory | None = None,
        options: NewtonOptions | None = None,
    ):
        memory = memory or Memory()
        super().__init__(grid, make_operator, law, window, memory)
        self.options = options or NewtonOptions.of(law)
        self.corrector: Corrector | None = None
        self._stalls = False
        self._saddle_steps = 0  # in a row
        make = partial(make_operator, memory=memory)
        self._preconditioner = preconditioner_for(self._single, make, shift, self.options.short_waves)
        self._linearised = LinearisedContact(self._single, shift, self._preconditioner, memory)
        self.idle = self._linearised.idle

    def equivalent_pairs(self, grid: Grid) -> float:
        """Return the transform pairs so far, as float64 pairs on ``grid``."""
        single = self._single.equivalent_pairs(grid) + self._preconditioner.equivalent_pairs(grid)
        local = self.corrector.equivalent_pairs(grid) if self.corrector else 0.0
        return self.solid.equivalent_pairs(grid) + single + local

    def set_anchor_springs(self, stiffness: float | np.ndarray, anchor: np.ndarray, stalls: bool = True) -> None:
        """Hold every point to a gap by springs; remove the springs where all stiffnesses are zero.

        Where negative curvature remains, a solve then stalls, or continues without ``stalls``.
        """
        self.local.set_anchor_springs(stiffness, anchor)
        self._stalls = self.local.anchored and stalls

    def solve(
        self,
        gap: np.ndarray,
        load: Load,
        tolerance: float,
        max_iterations: int,
        first_contact: bool = False,
        known: np.ndarray | None = None,
        overwrite: bool = False,
        carries: bool = False,
    ) -> NewtonResult:
        """Descend from a gap, > 0, to the next equilibrium, at which max|gradient| is at most ``tolerance``.

        At first contact, from separation, negative curvature may be removed, see the options. A ``known`` gap, this or
        another, was evaluated last under this load's field: by :meth:`press`, or as a result. The solver may
        ``overwrite`` both gaps. A solution that ``carries`` its load does so however light the load is, see
        :mod:`contact_study.numerics.balance`; a prediction need not.
        """
        state = self._evaluate_from(known, gap, load)
        trial = known if overwrite and known is not None and known is not gap else np.empty_like(gap)
        gap = gap if overwrite else gap.copy()
        damping, iteration, stepped = 0.0, 0, True
        self._saddle_steps = 0

        def excess_of(state: EnergyAndGradient) -> Excess:
            return self.excess_of(state, gap, load, tolerance) if carries else Excess(state.largest / tolerance, 0.0)

        while True:
            excess = excess_of(state)
            rounded = self._rounded * excess.residual > self.options.share_of_tolerance * state.largest
            if excess.balanced and rounded:
                state = self._evaluate(gap, load)
                excess = excess_of(state)
            self.solid.mark("iteration", state.largest)
            if excess.balanced:
                outcome = Outcome.CONVERGED
                break
            if self._is_detaching(gap, state):
                outcome = Outcome.DETACHED
                break
            if iteration == max_iterations:
                outcome = Outcome.ITERATION_LIMIT
                break
            if stepped and self._correct(gap, load, state, trial):
                stepped = False
                corrected = self._evaluate_change(gap, trial, load)
                if corrected.energy < state.energy:
                    gap, trial, state, damping = trial, gap, corrected, 0.0
                else:
                    self._undo_change()
                    state = self._pressed(gap, load)
                continue
            stepped = True
            iteration += 1
            removed = first_contact and state.largest > self.options.first_contact_residual
            taken = self._newton_step(gap, state, 1.0 if removed else damping, excess)
            if taken is None:
                outcome = Outcome.STALLED
                break
            new_state, fraction = self._line_search(gap, load, state, trial)
            if new_state is None:
                if taken.damping == 1:
                    outcome = Outcome.STALLED
                    break
                damping = 1.0
                state = self._pressed(gap, load)  # the trials have overwritten curvature and right side
                continue
            if not removed:
                damping = self._next_damping(taken, fraction)
            gap, trial = trial, gap
            state = new_state
        # The solver has evaluated this gap last.
        reaction = self.local.reaction(self.solid.field, gap, load.pressure)
        return NewtonResult(gap, reaction, state.largest, iteration, outcome)

    def _correct(self, gap: np.ndarray, load: Load, state: EnergyAndGradient, out: np.ndarray) -> bool:
        """Let the corrector write a gap closer to balance into ``out``; return whether it did."""
        if self.corrector is None or state.largest <= self.options.subdomain_residual or self.local.anchored:
            return False
        return self.corrector.correct(gap, self.solid.field, load, self._right_side, out)

    def _newton_step(self, gap: np.ndarray, state: EnergyAndGradient, damping: float, excess: Excess) -> _Step | None:
        """Compute a step in ``_linearised.solution``; None where springs leave negative curvature."""
        # While points jump in, the mean pressure may wait.
        light = excess.load > excess.residual and state.largest < self.options.close
        taken = self._curved_step(state, damping, excess, light)
        step = self._linearised.solution
        if light or max(step.max(), -step.min()) > self.options.longest_fall * self.window.inside(gap).max():
            self._shorten_fall(gap, abs(state.total))
        return taken

    def _curved_step(self, state: EnergyAndGradient, damping: float, excess: Excess, light: bool) -> _Step | None:
        """Compute a step as :meth:`_newton_step`; under a light load reduce its mean as well as the residual."""
        options, raised = self.options, False
        while True:
            reduction = self._reduction_at(state.largest, max(excess)) if damping == 0 else options.damped_reduction
            total = reduction * abs(state.total) if light else np.inf
            result = self._linearised.solve(
                self._right_side, self.curvature, 1 - damping, reduction, options.linear_iterations, total
            )
            self.local.hold(self.curvature, self._linearised.solution)
            self.local.hold(self.curvature, self._linearised.direction)
            if not result.negative_curvature:
                self._saddle_steps = self._saddle_steps if damping else 0
                return _Step(damping, raised)
            if self._stalls:
                return None
            if damping == 1:
                # K + D⁺ has no negative curvature: it is zero to the rounding of single precision, as where next to
                # nothing acts on the mean gap. What was reached before is a descent.
                if result.iterations == 1:
                    self._linearised.solution[...] = self._along_direction(self.law.length)
                return _Step(damping, raised)
            near_saddle = state.largest < options.saddle_residual and self._saddle_steps < options.saddle_steps
            if damping == 0 and not raised and near_saddle:
                self._saddle_steps += 1
                self._linearised.solution += self._along_direction(options.saddle_step * self.law.length)
                return _Step(damping, raised)
            damping = self._more_damping(damping)
            raised = True

    def _next_damping(self, taken: _Step, fraction: float) -> float:
        """Choose the damping after a step of which the line search took a fraction."""
        if fraction < 1:
            return self._more_damping(taken.damping)
        if taken.raised:
            return taken.damping
        strong = taken.damping > 0.9 * self.options.damping_start
        return taken.damping * self.options.damping_decay if strong else 0.0

    def _more_damping(self, damping: float) -> float:
        return min(1.0, max(self.options.damping_growth * damping, self.options.damping_start))

    def _shorten_fall(self, gap: np.ndarray, missing: float) -> None:
        """Shorten the step of separated surfaces until a point touches or carries the whole missing pressure.

        A limit at each point separately would bend the solid.
        """
        step, gap = self.window.inside(self._linearised.solution), self.window.inside(gap)
        closest, lowest = float(gap.min()), float(self.law.repulsive_gap(np.array(-missing)))
        if closest < self.law.equilibrium_distance or closest <= lowest:
            return
        least = float(np.finfo(np.float32).tiny)
        room = float(np.min((gap - lowest) / np.maximum(-step, least)))
        limit = self.options.step_limit * (closest + self.local.margin) / max(float(np.abs(step).max()), least)
        # A wall stops a point that would pass it by a rounding.
        self._linearised.solution *= np.float32(min(1.0, limit, (1 + 1e-6) * room))

    def _reduction_at(self, largest: float, excess: float) -> float:
        """Choose the reduction of a linear solve with the full curvature."""
        options = self.options
        if largest > options.close:
            return options.reduction
        return min(max(options.beyond_tolerance / excess, options.close_reduction), options.damped_reduction)

    def _along_direction(self, length: float) -> np.ndarray:
        """Return a step of that largest component along the last search direction, downhill."""
        direction = self._linearised.direction
        downhill = 1.0 if inner_product(self._right_side, direction) >= 0 else -1.0
        return np.float32(downhill * length / np.abs(direction).max()) * direction

    def _line_search(
        self, gap: np.ndarray, load: Load, state: EnergyAndGradient, trial: np.ndarray
    ) -> tuple[EnergyAndGradient | None, float]:
        """Shorten the step until the energy falls, writing the new gap into ``trial``; None if it never falls."""
        options, step, fraction = self.options, self._linearised.solution, 1.0
        while fraction > options.shortest_step:
            self.local.advance(gap, step, options.step_limit, trial)
            new = self._evaluate_change(gap, trial, load)
            equal = new.energy <= state.energy + options.energy_rounding * abs(state.energy)
            if new.energy <= state.energy or (equal and new.square < state.square):
                return self._unless_rounded(new, trial, load), fraction
            self._undo_change()
            step *= np.float32(options.backtracking)
            fraction *= options.backtracking
        return None, fraction

    def find_negative_curvature(self, curvature: np.ndarray, softening: float = 1.0) -> bool:
        """Return whether conjugate gradients find a direction of negative curvature of K + D⁺ + softening·D⁻.

        The direction is kept for :meth:`leave_saddle`. The right side is random (the same each time) and lies where the
        law softens, as every unstable mode does. ``softening`` is a factor on the negative part of D = φ''.
        """
        random = np.random.default_rng(0).standard_normal(curvature.shape, dtype=np.float32)
        np.multiply(1 + random, np.maximum(-curvature, 0), out=self._right_side)
        largest = np.abs(self._right_side).max()
        if largest == 0:
            return False
        # At unit size: squares of a very small tail underflow in single precision.
        self._right_side /= largest
        iterations = self.options.curvature_iterations
        return self._linearised.solve(self._right_side, curvature, softening, 0.0, iterations).negative_curvature

    def leave_saddle(self, gap: np.ndarray, load: Load) -> np.ndarray | None:
        """Return a gap of lower energy along the last search direction; None if rounding hides it."""
        options, energy = self.options, self._evaluate(gap, load).energy
        direction = self._linearised.direction
        self.local.hold(self.curvature, direction)
        direction /= np.abs(direction).max()
        beside = np.empty_like(gap)
        length = options.saddle_step * self.law.length
        while length > options.shortest_step * self.law.length:
            for step in (length, -length):
                self.local.advance(gap, np.float32(step) * direction, options.step_limit, beside)
                if self._evaluate(beside, load).energy < energy:
                    return beside
            length *= options.backtracking
        return None

    def mean_stiffness(self, gap: np.ndarray) -> float:
        """Return −dp/dū at an equilibrium, see :func:`~bem_adhesion.linear.contact_stiffness.mean_stiffness`."""
        self.local.evaluate(gap, np.empty_like(gap), self.curvature)
        return mean_stiffness(self._linearised, self.curvature, self.local.pin(self.curvature, gap))

    def follow_tangent(
        self, gap: np.ndarray, load: Load, limit: float, steps: int = 1, known: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the gap after Newton steps, as far as no gap changes by more than the fraction ``limit`` in total.

        ``known`` as for :meth:`solve`.
        """
        start, options = gap, self.options
        for _ in range(steps):
            self._evaluate_from(known, gap, load)
            result = self._linearised.solve(
                self._right_side, self.curvature, 1.0, options.tangent_reduction, options.linear_iterations
            )
            step = self._linearised.solution
            self.local.hold(self.curvature, step)
            inside = self.window.inside
            change = np.abs(inside(gap - start + step) / (inside(start) + self.local.margin))
            if result.negative_curvature or change.max() > limit:
                break
            moved = np.empty_like(gap)
            self.local.advance(gap, step, options.step_limit, moved)
            known, gap = gap, moved
        return gap
