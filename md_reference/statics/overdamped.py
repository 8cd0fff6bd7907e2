"""The condensed block in overdamped motion: one implicit Euler step of :mod:`contact_study.numerics.gradient_flow`.

A step is a minimum of the energy with springs of the stiffness η/τ that tie every atom to its former position; a
direction of negative curvature shows that it is too long.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from md_reference.solution import Equilibrium, Outcome
from md_reference.statics.energy import BlockEnergy, Load, MinimizerState

# Newton's method within a time step: reduction of the residual in a linear solve, iterations of one, Newton steps, and
# error of the step's minimum over the allowed error of the time step.
_REDUCTION, _LINEAR_ITERATIONS, _NEWTON_STEPS, _ACCURACY = 0.1, 100, 8, 0.05


class Moved(NamedTuple):
    """A state of the layer in motion, see :class:`contact_study.numerics.gradient_flow.Advance`."""

    state: np.ndarray
    residual: float
    equilibrium: Equilibrium
    apart: bool
    at_rest: bool


class OverdampedBlock:
    """The bottom layer of a block in overdamped motion, see :class:`contact_study.numerics.gradient_flow.Overdamped`.

    Drag is a stiffness over area (Pa/m), load a mean pressure (Pa). ``energy`` is that of a block under pressure
    control, ``tolerance`` the residual of a state at rest (E*), ``allowed`` the local error of a time step (m).
    """

    def __init__(self, energy: BlockEnergy, tolerance: float, allowed: float):
        self._energy = energy
        self._tolerance = tolerance
        self._accuracy = _ACCURACY * allowed / energy.force_scale
        self._last: MinimizerState | None = None  # last evaluated state
        self._evaluations, self._pairs = 0.0, energy.pairs  # of failed steps, and the pairs before them

    def advance(self, state: np.ndarray, load: float, drag: float) -> Moved | None:
        """Return the layer after a time step, None if the step is too long."""
        energy = self._energy
        drag *= energy.area
        at, free = self._state(state), Load(load * energy.area)
        acting = replace(free, stiffness=drag, anchor=state)
        self._last = None
        gradient = energy.gradient(at, acting)
        force, excess = energy.residual(gradient), energy.excess(at, gradient, free, self._tolerance)
        balanced, light = excess.balanced, force <= self._tolerance  # unbalanced and yet light: the load is missing
        least = max(force * excess.to_balance, min(energy.rounding(at, drag), self._tolerance))
        accuracy = max(least, self._accuracy * drag)
        step = 0
        while not balanced and step < _NEWTON_STEPS:
            energy.set_curvature(at, gradient, 0.0, drag)
            total = _REDUCTION * abs(float(np.sum(gradient[2]))) if light else np.inf
            newton = energy.newton.solve(gradient, _REDUCTION, _LINEAR_ITERATIONS, total)
            if newton.indefinite or not energy.search(at, newton.step, acting):
                break
            step += 1
            gradient = energy.gradient(at, acting)
            balanced = energy.residual(gradient) <= accuracy
            if light:
                balanced &= energy.excess(at, gradient, acting, self._tolerance).load <= 1
        if not balanced:
            self._evaluations += at.evaluations
            return None
        self._last = at
        return self._moved(at, load, step)

    def standing(self, state: np.ndarray, load: float) -> Moved:
        """Return a state without motion."""
        self._last = at = self._state(state)
        return self._moved(at, load, 0)

    def beside_saddle(self, state: np.ndarray, load: float) -> np.ndarray | None:
        """Return a state of lower energy next to a saddle, None at a minimum."""
        at = self._state(state)
        self._last = None
        return at.displacement if self._energy.leave_saddle(at) else None

    def _moved(self, at: MinimizerState, load: float, steps: int) -> Moved:
        """Return the last evaluated state, with the work since the one before."""
        energy = self._energy
        at.evaluations += self._evaluations
        self._evaluations, pairs = 0.0, self._work()
        acting = Load(load * energy.area)
        gradient = energy.gradient(at, acting)
        residual = energy.residual(gradient)
        at_rest = energy.excess(at, gradient, acting, self._tolerance).balanced
        apart = load <= 0 and not energy.force.any()
        outcome = Outcome.DETACHED if apart else Outcome.CONVERGED
        found = energy.equilibrium(at, residual, outcome, steps, pairs)
        return Moved(found.displacement, residual, found, apart, at_rest)

    def _work(self) -> float:
        """Return the transform pairs since the last call."""
        before, self._pairs = self._pairs, self._energy.pairs
        return self._pairs - before

    def _state(self, state: np.ndarray) -> MinimizerState:
        """Evaluate a state, to the same bits whether the motion came from it or begins there."""
        if self._last is None or self._last.displacement is not state:
            at = self._energy.evaluate(state)
        else:
            at, self._last = self._last, None
            self._energy.refresh(at)
            at.gap, at.cosine = self._energy.interaction.gap_and_cosine(state)
        at.vanishing = at.evaluations = 0
        return at
