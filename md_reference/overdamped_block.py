"""The condensed block in overdamped motion: one implicit Euler step of :mod:`contact_study.fields.gradient_flow`.

A step is a minimum of the energy with springs of the stiffness η/τ that tie every atom to where it was, found by the
Newton steps of the equilibrium solver. Under springs stiffer than the negative curvature there is one minimum only; a
direction of negative curvature says that the time step is too long for the motion to be followed.
"""

from dataclasses import dataclass

import numpy as np

from md_reference.equilibrium import equilibrium_of, leave_saddle
from md_reference.landscape import Landscape, Load, Place
from md_reference.solution import Equilibrium, Outcome

_REDUCTION = 0.1  # of the residual in a linear solve
_LINEAR_ITERATIONS, _NEWTON_STEPS = 100, 8
_ACCURACY = 0.05  # of the allowed error of a time step: what a step's own minimum may be off


@dataclass(frozen=True)
class Moved:
    """A state of the layer in motion, see :class:`contact_study.fields.gradient_flow.Advance`."""

    equilibrium: Equilibrium
    apart: bool

    @property
    def state(self) -> np.ndarray:
        """Displacement (m)."""
        return self.equilibrium.displacement

    @property
    def residual(self) -> float:
        """Largest force out of balance, friction apart, over a² E*."""
        return self.equilibrium.residual


class OverdampedBlock:
    """The bottom layer of a block that moves against friction, see :mod:`contact_study.fields.gradient_flow`.

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
        self._last: Place | None = None  # where the landscape was last evaluated
        self._evaluations, self._pairs = 0.0, landscape.pairs  # of steps that were not found, and the pairs before them

    def advance(self, state: np.ndarray, load: float, drag: float) -> Moved | None:
        """The layer after a time step; see :class:`contact_study.fields.gradient_flow.Overdamped`."""
        landscape = self._landscape
        drag *= landscape.area
        place, acting = self._place(state), Load(load * landscape.area, drag, state)
        self._last = None
        accuracy = max(self._tolerance, self._accuracy * drag)
        for step in range(_NEWTON_STEPS + 1):
            gradient = landscape.gradient(place, acting)
            if landscape.residual(gradient) <= (accuracy if step else self._tolerance):
                break
            landscape.set_curvature(place, gradient, 0.0, drag)
            newton = landscape.newton.solve(gradient, _REDUCTION, _LINEAR_ITERATIONS)
            if newton.indefinite or not landscape.search(place, newton.step, acting):
                self._evaluations += place.evaluations
                return None
        else:
            self._evaluations += place.evaluations
            return None
        self._last = place
        return self._moved(place, load, step)

    def standing(self, state: np.ndarray, load: float) -> Moved:
        """A state as it is."""
        self._last = place = self._place(state)
        return self._moved(place, load, 0)

    def _moved(self, place: Place, load: float, steps: int) -> Moved:
        """The place where the landscape was evaluated last, with the work since the one before."""
        landscape = self._landscape
        place.evaluations += self._evaluations
        self._evaluations, pairs = 0.0, self._work()
        residual = landscape.residual(landscape.gradient(place, Load(load * landscape.area)))
        apart = load <= 0 and not landscape.force.any()
        outcome = Outcome.DETACHED if apart else Outcome.CONVERGED
        return Moved(equilibrium_of(landscape, place, residual, outcome, steps, pairs), apart)

    def _work(self) -> float:
        """Transform pairs since it was asked for last."""
        before, self._pairs = self._pairs, self._landscape.pairs
        return self._pairs - before

    def beside_saddle(self, state: np.ndarray, load: float) -> np.ndarray | None:
        """A state of lower energy next to a saddle; see :class:`contact_study.fields.gradient_flow.Overdamped`."""
        place = self._place(state)
        self._last = None
        return place.displacement if leave_saddle(self._landscape, place) else None

    def _place(self, state: np.ndarray) -> Place:
        """The landscape at a state, to the same bits whether the motion came there or begins there."""
        if self._last is None or self._last.displacement is not state:
            place = self._landscape.place(state)
        else:
            place, self._last = self._last, None
            self._landscape.refresh(place)
            place.gap, place.cosine = self._landscape.interaction.gap_and_cosine(state)
        place.vanishing = place.evaluations = 0
        return place
