"""The condensed block in overdamped motion: one implicit Euler step of :mod:`contact_study.numerics.gradient_flow`.

A step is a minimum of the energy with springs of the stiffness η/τ that tie every atom to where it was, found by the
Newton steps of the equilibrium solver. Under springs stiffer than the negative curvature there is one minimum only; a
direction of negative curvature says that the time step is too long for the motion to be followed.
"""

from dataclasses import dataclass, replace

import numpy as np

from md_reference.solution import Equilibrium, Outcome
from md_reference.statics.energy import Landscape, Load, MinimizerState
from md_reference.statics.newton import equilibrium_of, leave_saddle

_REDUCTION = 0.1  # of the residual in a linear solve
_LINEAR_ITERATIONS, _NEWTON_STEPS = 100, 8
_ACCURACY = 0.05  # of the allowed error of a time step: what a step's own minimum may be off


@dataclass(frozen=True)
class Moved:
    """A state of the layer in motion, see :class:`contact_study.numerics.gradient_flow.Advance`."""

    equilibrium: Equilibrium
    apart: bool
    at_rest: bool

    @property
    def state(self) -> np.ndarray:
        """Displacement (m)."""
        return self.equilibrium.displacement

    @property
    def residual(self) -> float:
        """Largest force out of balance, friction apart, over a² E*."""
        return self.equilibrium.residual


class OverdampedBlock:
    """The bottom layer of a block that moves against friction, see :mod:`contact_study.numerics.gradient_flow`.

    Drag is a stiffness over area (Pa/m), load a mean pressure (Pa).

    Parameters
    ----------
    landscape : Landscape
        Of a block under pressure control.
    tolerance : float
        Residual of a state at rest, in units of E*.
    allowed : float
        Local error of a time step (m).
    """

    def __init__(self, landscape: Landscape, tolerance: float, allowed: float):
        self._landscape = landscape
        self._tolerance = tolerance
        self._accuracy = _ACCURACY * allowed / landscape.force_scale
        self._last: MinimizerState | None = None  # where the landscape was last evaluated
        self._evaluations, self._pairs = 0.0, landscape.pairs  # of steps that were not found, and the pairs before them

    def advance(self, state: np.ndarray, load: float, drag: float) -> Moved | None:
        """The layer after a time step; see :class:`contact_study.numerics.gradient_flow.Overdamped`."""
        landscape = self._landscape
        drag *= landscape.area
        place, free = self._place(state), Load(load * landscape.area)
        acting = replace(free, drag=drag, anchor=state)
        self._last = None
        gradient = landscape.gradient(place, acting)
        force, excess = landscape.residual(gradient), landscape.excess(place, gradient, free, self._tolerance)
        balanced, light = excess.balanced, force <= self._tolerance  # unbalanced and yet light: the load is missing
        least = max(force * excess.to_balance, min(landscape.rounding(place, drag), self._tolerance))
        accuracy = max(least, self._accuracy * drag)
        step = 0
        while not balanced and step < _NEWTON_STEPS:
            landscape.set_curvature(place, gradient, 0.0, drag)
            total = _REDUCTION * abs(float(np.sum(gradient[2]))) if light else np.inf
            newton = landscape.newton.solve(gradient, _REDUCTION, _LINEAR_ITERATIONS, total)
            if newton.indefinite or not landscape.search(place, newton.step, acting):
                break
            step += 1
            gradient = landscape.gradient(place, acting)
            balanced = landscape.residual(gradient) <= accuracy
            if light:
                balanced &= landscape.excess(place, gradient, acting, self._tolerance).load <= 1
        if not balanced:
            self._evaluations += place.evaluations
            return None
        self._last = place
        return self._moved(place, load, step)

    def standing(self, state: np.ndarray, load: float) -> Moved:
        """A state as it is."""
        self._last = place = self._place(state)
        return self._moved(place, load, 0)

    def _moved(self, place: MinimizerState, load: float, steps: int) -> Moved:
        """The place where the landscape was evaluated last, with the work since the one before."""
        landscape = self._landscape
        place.evaluations += self._evaluations
        self._evaluations, pairs = 0.0, self._work()
        acting = Load(load * landscape.area)
        gradient = landscape.gradient(place, acting)
        residual = landscape.residual(gradient)
        at_rest = landscape.excess(place, gradient, acting, self._tolerance).balanced
        apart = load <= 0 and not landscape.force.any()
        outcome = Outcome.DETACHED if apart else Outcome.CONVERGED
        return Moved(equilibrium_of(landscape, place, residual, outcome, steps, pairs), apart, at_rest)

    def _work(self) -> float:
        """Transform pairs since it was asked for last."""
        before, self._pairs = self._pairs, self._landscape.pairs
        return self._pairs - before

    def beside_saddle(self, state: np.ndarray, load: float) -> np.ndarray | None:
        """A state of lower energy next to a saddle; see :class:`contact_study.numerics.gradient_flow.Overdamped`."""
        place = self._place(state)
        self._last = None
        return place.displacement if leave_saddle(self._landscape, place) else None

    def _place(self, state: np.ndarray) -> MinimizerState:
        """The landscape at a state, to the same bits whether the motion came there or begins there."""
        if self._last is None or self._last.displacement is not state:
            place = self._landscape.place(state)
        else:
            place, self._last = self._last, None
            self._landscape.refresh(place)
            place.gap, place.cosine = self._landscape.interaction.gap_and_cosine(state)
        place.vanishing = place.evaluations = 0
        return place
