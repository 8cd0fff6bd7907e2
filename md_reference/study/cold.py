"""Paths at zero temperature: the minimum reached from the state before, or steepest descent against friction.

A step of the descent, see :mod:`contact_study.results.overdamped_path`, is a minimum of the energy with springs of the
stiffness η/τ that tie every atom to its former position.
"""

import warnings
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from contact_study.physics.surfaces.surface import Surface
from contact_study.results import overdamped_path
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case
from md_reference.solution import Outcome, Solution
from md_reference.statics.contact import AtomisticContact
from md_reference.statics.energy import Load, MinimizerState
from md_reference.study.system import Predictor, Restart, States, build_contact, interface_state

# Within a time step: reduction of a linear solve, its iterations, Newton steps, error over that of the time step.
_REDUCTION, _LINEAR_ITERATIONS, _NEWTON_STEPS, _ACCURACY = 0.1, 100, 8, 0.05


def quasi_static(case: Case, surface: Surface, restart: Restart, start: int, predictor: Predictor) -> States:
    """Yield equilibria along the loading path."""
    return equilibria(case, build_contact(case, surface), restart, start, predictor)


def equilibria(
    case: Case, contact: AtomisticContact, restart: Restart, start: int, predictor: Predictor
) -> Iterator[InterfaceState]:
    """Yield the equilibria of a contact along the path, each from the state before or at a predictor's gap field."""
    state = contact.separated() if restart is None else restart["state"]
    for number in range(start, len(case.path)):
        value, branch = case.path[number]
        gap = None
        # Tension does not bring separated blocks together.
        if predictor is not None and not (contact.is_separated(state) and contact.control == "pressure" and value <= 0):
            gap = predictor(number)
            if gap is None:
                unit = "Pa" if contact.control == "pressure" else "m"
                warnings.warn(
                    f"the predictor holds no state in contact for point {number + 1} of the path, {value:g} {unit} "
                    f"({branch}): the atoms start from where they were",
                    stacklevel=2,
                )
        found = contact.step(state if gap is None else contact.predicted(gap), value)
        state = found.state
        yield interface_state(case, found)


class Moved(NamedTuple):
    """A state of the layer in motion, see :class:`contact_study.results.overdamped_path.Moving`."""

    state: np.ndarray
    residual: float
    solution: Solution
    apart: bool
    at_rest: bool


class OverdampedAtoms:
    """The atoms of a case in overdamped motion, with a local error ``allowed`` of a time step (m)."""

    def __init__(self, case: Case, contact: AtomisticContact, allowed: float):
        self.separated = contact.separated
        self._case = case
        self._energy = contact.energy
        self._tolerance = case.solver.tolerance
        self._accuracy = _ACCURACY * allowed / self._energy.force_scale
        self._last: MinimizerState | None = None  # last evaluated state
        self._evaluations, self._pairs = 0.0, self._energy.pairs  # of failed steps, and the pairs before them

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

    def described(self, found: Moved) -> InterfaceState:
        """Return a state of the atoms as one of the interface."""
        # Work done since then belongs to this state: a run that resumes from it repeats none of it.
        pairs = found.solution.fft_pairs + self._work()
        return interface_state(self._case, replace(found.solution, fft_pairs=pairs))

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
        return Moved(at.displacement, residual, found, apart, at_rest)

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


def overdamped(case: Case, surface: Surface, restart: Restart, start: int, predictor: Predictor) -> States:
    """Yield the states of each point, the last of them at rest."""
    pace = overdamped_path.pace_of(case, surface.size)
    moving = OverdampedAtoms(case, build_contact(case, surface), pace.allowed)
    return overdamped_path.solve_path(case, moving, pace, restart, start)
