"""The continuum in overdamped motion: one implicit Euler step of :mod:`contact_study.numerics.gradient_flow`.

A step is a minimum of the energy with springs of the stiffness η/τ that tie every point to where it was, found by the
Newton steps of the equilibrium solver on the finest grid alone: predictions of coarser ones belong to equilibria.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.operators.load import HeightLoad
from bem_adhesion.solution import NewtonResult, Outcome, Solution
from contact_study.numerics.balance import excess

_NEWTON_STEPS = 8
# What a step's own minimum may be off: of the allowed error of a time step, and of the force that it begins with.
_ACCURACY, _REDUCTION = 0.05, 0.1


@dataclass(frozen=True)
class Moved:
    """A gap in motion, see :class:`contact_study.numerics.gradient_flow.Advance`."""

    state: np.ndarray
    solution: Solution
    residual: float
    at_rest: bool = True

    @property
    def apart(self) -> bool:
        """Whether the surfaces separate for ever."""
        return self.solution.detached


class OverdampedContact(AdhesiveContact):
    """A contact under pressure control that moves against friction.

    Its states in motion are gaps (m); drag is a stiffness (Pa/m), load the mean pressure (Pa).

    Parameters
    ----------
    *arguments, **options
        As of :class:`NewtonSolver`.
    allowed : float
        Local error of a time step (m).
    """

    def __init__(self, *arguments: Any, allowed: float, **options: Any):
        super().__init__(*arguments, **options)
        self._allowed = allowed / self._length
        self._pairs = self.levels.equivalent_pairs(self._grid)  # before the steps whose work is not told yet

    def separated(self) -> np.ndarray:
        """The gap of the flat block just out of reach of the law (m)."""
        return super().separated() - self.height

    def advance(self, state: np.ndarray, load: float, drag: float) -> Moved | None:
        """The gap after a time step; see :class:`contact_study.numerics.gradient_flow.Overdamped`."""
        modulus, finest = self.elasticity.contact_modulus, self.levels.finest
        gap, pressure = self._scaled(state, load)
        stiffness = drag * self._length / modulus
        finest.set_anchor_springs(0.0, gap)
        now, apart = finest.imbalance_at(gap, pressure)
        force = now.largest
        if apart:
            return Moved(state, self._apart(Outcome.DETACHED, 0, self._work()), force)
        least = force * finest.excess_of(now, gap, pressure, self.tolerance).to_balance
        least = (
            max(least, min(finest.rounding(gap), self.tolerance)) or self.tolerance
        )  # in full contact nothing is left
        accuracy = max(least, min(_ACCURACY * self._allowed * stiffness, _REDUCTION * force))
        finest.set_anchor_springs(stiffness, gap)
        result = finest.solve(gap, pressure, accuracy, _NEWTON_STEPS, carries=force <= self.tolerance)
        finest.set_anchor_springs(0.0, gap)
        if result.outcome is not Outcome.CONVERGED:
            return None
        # Friction apart no force is larger than what the solve left and friction itself.
        left = result.residual + stiffness * float(np.abs(result.gap - gap).max())
        found = self._in_motion(replace(result, residual=left))
        return Moved(found.gap, found, left, self._at_rest(found, load))

    def _scaled(self, state: np.ndarray, load: float) -> tuple[np.ndarray, HeightLoad]:
        """Gap and load in the units of the levels."""
        return state / self._length, self._load(load / self.elasticity.contact_modulus)

    def _work(self) -> float:
        """Transform pairs since it was asked for last."""
        before, self._pairs = self._pairs, self.levels.equivalent_pairs(self._grid)
        return self._pairs - before

    def _in_motion(self, result: NewtonResult) -> Solution:
        """A state whose law does not balance its flexure: ½<w, K w> takes a transform."""
        flexure = self.levels.finest.press(result.gap, self._heights)
        elastic = 0.5 * float(np.mean(flexure * (result.gap + self.height / self._length)))
        elastic *= self.elasticity.contact_modulus * self._length
        found = self._solution(result, self._work())
        elastic += self.elasticity.compression_energy(float(found.pressure.mean()))
        return replace(found, elastic_energy=elastic)

    def standing(self, state: np.ndarray, load: float) -> Moved:
        """A gap as it is; apart where it is out of reach and the load does not bring the surfaces together."""
        if load <= 0 and self._out_of_reach(state / self._length):
            return Moved(state, self._apart(Outcome.APART), 0.0)
        gap, pressure = self._scaled(state, load)
        result = self.levels.finest.solve(gap, pressure, self.tolerance, 0)
        found = self._in_motion(result)
        return Moved(state, found, result.residual, self._at_rest(found, load))

    def _at_rest(self, found: Solution, load: float) -> bool:
        """Whether a state is in balance without friction under a mean pressure (Pa)."""
        unit, finest = self.elasticity.contact_modulus, self.levels.finest
        missing, stress = load - float(found.pressure.mean()), float(np.abs(found.pressure).max())
        rounding = finest.rounding(found.gap / self._length)
        points = found.gap.size
        return excess(
            self.tolerance, found.residual, missing / unit, load / unit, stress / unit, rounding, points
        ).balanced

    def beside_saddle(self, state: np.ndarray, load: float) -> np.ndarray | None:
        """A gap of lower energy next to a saddle; see :class:`contact_study.numerics.gradient_flow.Overdamped`."""
        gap, pressure = self._scaled(state, load)
        self.levels.finest.imbalance_at(gap, pressure)
        lower = self.levels.leave_saddle(gap, pressure)
        return None if lower is None else lower * self._length
