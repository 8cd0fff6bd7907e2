"""Newton descent of an adhesive contact on one grid into the minimum of ½<d, K d> + <φ(d)> + <load·d> next to it.

Negative curvature that stops a linear solve is multiplied by 1 − damping until steps succeed. Residuals are in float64;
between two full evaluations K d follows the changes of d by transforms in float32.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bem_adhesion.adhesive.options import NewtonOptions
from bem_adhesion.kernels.local_energy import EnergyAndGradient, LocalEnergy
from bem_adhesion.kernels.local_law import LocalLaw
from bem_adhesion.linear.conjugate_gradients import LinearisedContact, preconditioner_for
from bem_adhesion.operators import Load, MakeOperator, Window
from bem_adhesion.solution import NewtonResult, Outcome
from contact_study.numerics.balance import ROUNDING, Excess, excess
from contact_study.numerics.grid import Grid
from contact_study.numerics.kernel import inner_product
from contact_study.numerics.memory import Memory
from contact_study.physics.laws import TractionLaw

# Upper bound of the rounding of K times a change in float32, as a fraction of the largest change times the largest K;
# K d is formed again where the rounding since the last time may exceed this share of the residual.
CHANGE_ROUNDING, SHARE_OF_RESIDUAL = 3e-7, 0.1


class NewtonSolver:
    """The contact on one grid: ``solid`` holds K d with the load's field at the last gap, ``curvature`` φ''.

    Solves overwrite the field of ``single``, the solid in float32; ``idle`` is memory that others may use between them.
    """

    def __init__(
        self,
        make_operator: MakeOperator,
        law: TractionLaw,
        shift: float,
        grid: Grid,
        window: Window | None = None,
        memory: Memory | None = None,
        pointwise: LocalLaw | None = None,
    ):
        memory = memory or Memory()
        make = partial(make_operator, memory=memory)
        self.grid, self.law = grid, law
        self.inside: Any = window or ...
        self.solid = make(grid, np.float64)
        self.single = make(grid, np.float32)
        self.local = LocalEnergy(law, self.solid.largest, window, pointwise)
        self.curvature, self._right_side = (memory.array(grid.shape, np.float32) for _ in range(2))
        self.corrector: Any = None  # a LocalNewton, which is made of solvers as this one
        self._rounded, self._stalls, self._saddle_steps = 0.0, False, 0  # saddle steps in a row
        self.options = NewtonOptions.of(law)
        inverse = preconditioner_for(self.single, make, shift, self.options.short_waves)
        self._linearised = LinearisedContact(self.single, shift, inverse, memory)
        self.idle = self._linearised.idle

    def set_anchor_springs(self, stiffness: float | np.ndarray, anchor: np.ndarray, stalls: bool = True) -> None:
        """Hold every point to a gap by springs, or none; where negative curvature remains a solve may stall."""
        self.local.springs = (stiffness, anchor) if np.any(stiffness) else None
        self._stalls = self.local.springs is not None and stalls

    def press(self, gap: np.ndarray, load: Load) -> np.ndarray:
        """Write K d and the load's field into the field of the solid, from which a solve may continue."""
        self._rounded = 0.0
        return load.press(gap, self.solid)

    def load_for(self, pressing: np.ndarray, gap: np.ndarray, pressure: float) -> Load:
        """Make the load whose field and K d of a gap add up to ``pressing``; a solve may continue from them."""
        self._rounded = 0.0
        self.solid.field[...] = gap
        load = Load(pressing - self.solid.apply(self.solid.stiffness), pressure=pressure)
        self.solid.field[...] = pressing
        return load

    def excess_of(self, state: EnergyAndGradient, gap: np.ndarray, load: Load, tolerance: float) -> Excess:
        """Compare the residual at a gap that was evaluated last with what is allowed, see :func:`excess`."""
        pressure = 0.0 if self.solid.mean_stiffness else load.pressure  # a spring on the mean carries the rest
        missing = state.total / gap.size
        if state.largest > tolerance:  # whatever the stress
            return excess(tolerance, state.largest, missing, pressure)
        field = self.solid.field
        stress = max(float(field.max()) + load.pressure, -float(field.min()) - load.pressure)
        return excess(tolerance, state.largest, missing, pressure, stress, self.rounding(gap), gap.size)

    def rounding(self, gap: np.ndarray) -> float:
        """Return the residual that the rounding of a gap leaves."""
        return ROUNDING * self.solid.largest * float(gap.max())

    def evaluate(self, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """Evaluate energy and gradient; fill curvature, right side, and the field of the solid as :meth:`press`."""
        self.press(gap, load)
        return self._pressed(gap, load)

    def _evaluate_change(self, gap: np.ndarray, new: np.ndarray, load: Load) -> EnergyAndGradient:
        """Evaluate as :meth:`evaluate` at a new gap, by the change from the one that was evaluated last."""
        change = self.single.field
        np.subtract(new, gap, out=change, casting="same_kind")
        largest = max(float(change.max()), -float(change.min()))
        self.solid.field += self.single.apply(self.single.stiffness)
        self._rounded += CHANGE_ROUNDING * largest * self.solid.largest
        return self._pressed(new, load)

    def _evaluate_from(self, known: np.ndarray | None, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """Evaluate as :meth:`evaluate`, from the gap that was pressed last, if there is one."""
        if known is None:
            return self.evaluate(gap, load)
        if known is gap:
            return self._pressed(gap, load)
        return self._unless_rounded(self._evaluate_change(known, gap, load), gap, load)

    def _unless_rounded(self, state: EnergyAndGradient, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """Return the state, evaluated again where rounding may show in its residual."""
        return self.evaluate(gap, load) if self._rounded > SHARE_OF_RESIDUAL * state.largest else state

    def _pressed(self, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """Evaluate energy and gradient at a gap whose K d is in the solid's field."""
        return self.local.energy_and_gradient(self.solid.field, gap, load, self._right_side, self.curvature)

    def _balancing(self, load: Load, gap: np.ndarray) -> Load:
        """Return the load with the pressure under which a gap that was pressed is in balance in the mean."""
        if not gap.any():  # all points touch a wall: the pressure at which a first one is pulled off
            strength, peak = self.local.pointwise.strength, self.law.peak_tensile_stress
            pulled = self.solid.field if strength is None else self.solid.field + (strength - 1) * peak
            return replace(load, pressure=-float(pulled.min()) - peak)
        return replace(load, pressure=-self.local.imbalance(self.solid.field, gap, 0.0))

    def is_detaching(self, gap: np.ndarray, state: EnergyAndGradient) -> bool:
        """Return whether a tension separates the surfaces with every point beyond the peak: then for ever."""
        tension = self.solid.mean_stiffness == 0 and state.total < 0 and self.local.springs is None
        return tension and bool(gap[self.inside].min() > self.law.peak_distance)

    def solve(
        self,
        gap: np.ndarray,
        load: Load,
        tolerance: float,
        max_iterations: int,
        first_contact: bool = False,
        known: np.ndarray | None = None,
        carries: bool = False,
    ) -> NewtonResult:
        """Descend from a gap, which is overwritten, to max|gradient| <= ``tolerance``, or balance if it ``carries``.

        A ``known`` gap, this or another, was evaluated last under this load's field; it is overwritten as well. A mean
        gap that the load prescribes is met to the tolerance.
        """
        state = self._evaluate_from(known, gap, load)
        if load.mean_gap is not None:
            load = self._balancing(load, gap)
            state = self._pressed(gap, load)
        trial = np.empty_like(gap) if known is None or known is gap else known
        damping, iteration, stepped = 0.0, 0, True
        least = np.inf if self.corrector is None or self.local.springs else self.options.subdomain_residual
        self._saddle_steps = 0

        def excess_of(state: EnergyAndGradient) -> Excess:
            missing = load.missing(gap)
            if missing is not None:
                return Excess(state.largest / tolerance, abs(missing) / tolerance)
            return self.excess_of(state, gap, load, tolerance) if carries else Excess(state.largest / tolerance, 0.0)

        outcome = None
        while outcome is None:
            excess = excess_of(state)
            if excess.balanced and self._rounded * excess.residual > self.options.share_of_tolerance * state.largest:
                state = self.evaluate(gap, load)
                excess = excess_of(state)
            self.solid.mark("iteration", state.largest)
            if excess.balanced:
                outcome = Outcome.CONVERGED
            elif self.is_detaching(gap, state):
                outcome = Outcome.DETACHED
            elif iteration == max_iterations:
                outcome = Outcome.ITERATION_LIMIT
            elif (
                stepped
                and state.largest > least
                and self.corrector.correct(gap, self.solid.field, load, self._right_side, trial)
            ):
                stepped = False
                corrected = self._evaluate_change(gap, trial, load)
                if corrected.energy < state.energy:
                    gap, trial, state, damping = trial, gap, corrected, 0.0
                else:
                    self.solid.field -= self.single.field  # as before the change
                    state = self._pressed(gap, load)
            else:
                stepped = True
                iteration += 1
                removed = first_contact and state.largest > self.options.first_contact_residual
                # While points jump in, the mean pressure may wait.
                light = excess.load > excess.residual and state.largest < self.options.close and load.mean_gap is None
                missing = load.missing(gap)
                if missing is not None and abs(missing) < self.options.settled_mean * tolerance:
                    missing = 0.0  # to move the mean takes a transform
                taken = self._newton_step(state, 1.0 if removed else damping, excess, light, missing)
                if taken is None:
                    outcome = Outcome.STALLED
                    break
                used, raised, stress = taken
                if missing is not None:
                    # The step leads to balance under another pressure, at which the energy falls along it.
                    load = replace(load, pressure=load.pressure + stress)
                    state = state._replace(energy=state.energy + stress * float(gap.sum()))
                self._shorten_fall(gap, abs(state.total), light)
                new_state, fraction = self._line_search(gap, load, state, trial)
                if new_state is not None:
                    damping = damping if removed else self._next_damping(used, raised, fraction)
                    gap, trial, state = trial, gap, new_state
                elif used == 1:
                    outcome = Outcome.STALLED
                else:
                    damping = 1.0
                    state = self._pressed(gap, load)  # the trials have overwritten curvature and right side
        # The solver has evaluated this gap last.
        reaction = self.local.reaction(self.solid.field, gap, load.pressure)
        return NewtonResult(gap, reaction, state.largest, iteration, outcome, load.pressure)

    def _newton_step(
        self, state: EnergyAndGradient, damping: float, excess: Excess, light: bool, mean: float | None
    ) -> tuple[float, bool, float] | None:
        """Compute a step, of a light load or a given ``mean`` its mean, too; None if stalled.

        Returns its damping, whether it was raised, and the change of pressure that holds the mean.
        """
        options, raised = self.options, False
        above = max(excess) if mean is None else excess.residual  # zero where a wall carries all points
        while True:
            reduction = options.damped_reduction if damping else options.reduction
            if damping == 0 and state.largest <= options.close and above > 0:
                reduction = max(options.beyond_tolerance / above, options.close_reduction)
                reduction = min(reduction, options.damped_reduction)
            total = reduction * abs(state.total) if light else np.inf
            result = self._linearised.solve(
                self._right_side, self.curvature, 1 - damping, reduction, options.linear_iterations, total, mean
            )
            self.local.hold(self.curvature, self._linearised.solution)
            self.local.hold(self.curvature, self._linearised.direction)
            if not result.negative_curvature:
                self._saddle_steps = self._saddle_steps if damping else 0
                return damping, raised, result.stress
            if self._stalls:
                return None
            if damping == 1:
                # K + D⁺ is zero to the rounding of single precision: what was reached before is a descent.
                if result.iterations == 1:
                    self._linearised.solution[...] = self._along_direction(self.law.length)
                return damping, raised, result.stress
            near_saddle = state.largest < options.saddle_residual and self._saddle_steps < options.saddle_steps
            if damping == 0 and not raised and near_saddle:
                self._saddle_steps += 1
                self._linearised.solution += self._along_direction(options.saddle_step * self.law.length)
                return damping, raised, result.stress
            damping = self._more_damping(damping)
            raised = True

    def _next_damping(self, damping: float, raised: bool, fraction: float) -> float:
        """Choose the damping after a step of which the line search took a fraction."""
        if fraction < 1:
            return self._more_damping(damping)
        if raised:
            return damping
        return damping * self.options.damping_decay if damping > 0.9 * self.options.damping_start else 0.0

    def _more_damping(self, damping: float) -> float:
        return min(1.0, max(self.options.damping_growth * damping, self.options.damping_start))

    def _shorten_fall(self, gap: np.ndarray, missing: float, light: bool) -> None:
        """Shorten a long step of separated surfaces until a point touches or carries the whole missing pressure."""
        step, gap = self._linearised.solution, gap[self.inside]
        if not light and max(step.max(), -step.min()) <= self.options.longest_fall * gap.max():
            return
        step = step[self.inside]
        closest, lowest = float(gap.min()), float(self.law.repulsive_gap(np.array(-missing)))
        if closest < self.law.equilibrium_distance or closest <= lowest:
            return
        least = float(np.finfo(np.float32).tiny)
        room = float(np.min((gap - lowest) / np.maximum(-step, least)))
        limit = self.options.step_limit * (closest + self.local.margin) / max(float(np.abs(step).max()), least)
        # A wall stops a point that would pass it by a rounding.
        self._linearised.solution *= np.float32(min(1.0, limit, (1 + 1e-6) * room))

    def _along_direction(self, length: float) -> np.ndarray:
        """Return a step of that largest component along the last search direction, downhill."""
        direction = self._linearised.direction
        downhill = 1.0 if inner_product(self._right_side, direction) >= 0 else -1.0
        return np.float32(downhill * length / np.abs(direction).max()) * direction

    def _line_search(
        self, gap: np.ndarray, load: Load, state: EnergyAndGradient, trial: np.ndarray
    ) -> tuple[EnergyAndGradient | None, float]:
        """Shorten the step until the energy falls, writing the new gap into ``trial``; None if it never falls."""
        step, fraction = self._linearised.solution, 1.0
        while fraction > self.options.shortest_step:
            self.local.advance(gap, step, self.options.step_limit, trial)
            new = self._evaluate_change(gap, trial, load)
            equal = new.energy <= state.energy + self.options.energy_rounding * abs(state.energy)
            if new.energy <= state.energy or (equal and new.square < state.square):
                return self._unless_rounded(new, trial, load), fraction
            self.solid.field -= self.single.field  # as before the change
            step *= np.float32(self.options.backtracking)
            fraction *= self.options.backtracking
        return None, fraction

    def find_negative_curvature(self, curvature: np.ndarray, softening: float = 1.0) -> bool:
        """Return whether conjugate gradients find a direction of negative curvature of K + D⁺ + softening·D⁻."""
        # A right side that is random, the same each time, where the law softens, as every unstable mode does.
        random = np.random.default_rng(0).standard_normal(curvature.shape, dtype=np.float32)
        np.multiply(1 + random, np.maximum(-curvature, 0), out=self._right_side)
        largest = np.abs(self._right_side).max()
        if largest == 0:
            return False
        # At unit size: squares of a very small tail underflow in single precision.
        self._right_side /= largest
        found = self._linearised.solve(self._right_side, curvature, softening, 0.0, self.options.curvature_iterations)
        return found.negative_curvature

    def leave_saddle(self, gap: np.ndarray, load: Load) -> np.ndarray | None:
        """Return a gap of lower energy along the last search direction; None if rounding hides it."""
        energy, direction = self.evaluate(gap, load).energy, self._linearised.direction
        self.local.hold(self.curvature, direction)
        direction /= np.abs(direction).max()
        beside = np.empty_like(gap)
        length = self.options.saddle_step * self.law.length
        while length > self.options.shortest_step * self.law.length:
            for step in (length, -length):
                self.local.advance(gap, np.float32(step) * direction, self.options.step_limit, beside)
                if self.evaluate(beside, load).energy < energy:
                    return beside
            length *= self.options.backtracking
        return None

    def mean_stiffness(self, gap: np.ndarray) -> float:
        """Return −dp/dū at an equilibrium, see :meth:`LinearisedContact.mean_stiffness`."""
        self.local.evaluate(gap, np.empty_like(gap), self.curvature)
        return self._linearised.mean_stiffness(self.curvature, self.local.pin(self.curvature, gap))

    def follow_tangent(
        self, gap: np.ndarray, load: Load, limit: float, steps: int = 1, known: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the gap after Newton steps, as far as no gap changes by more than the fraction ``limit`` in total."""
        start, inside = gap, self.inside
        for _ in range(steps):
            self._evaluate_from(known, gap, load)
            limits = self.options.tangent_reduction, self.options.linear_iterations
            result = self._linearised.solve(self._right_side, self.curvature, 1.0, *limits, mean=load.missing(gap))
            step = self._linearised.solution
            self.local.hold(self.curvature, step)
            change = np.abs((gap - start + step)[inside] / (start[inside] + self.local.margin))
            if result.negative_curvature or change.max() > limit:
                break
            moved = np.empty_like(gap)
            self.local.advance(gap, step, self.options.step_limit, moved)
            known, gap = gap, moved
        return gap


MakeSolver = Callable[..., NewtonSolver]  # of a grid, a window, memory and a local law
