"""Overdamped motion of an adhesive contact: implicit Euler steps of :mod:`contact_study.numerics.gradient_flow`.

A step is a minimum of the energy with anchor springs of the stiffness η/τ at every point, found by the Newton steps of
the equilibrium solver on the finest grid alone: predictions on coarser grids are for equilibria.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.operators.load import HeightLoad
from bem_adhesion.solution import NewtonResult, Outcome, Solution
from contact_study.numerics.balance import excess


@dataclass(frozen=True)
class OverdampedOptions:
    """Constants of a time step."""

    newton_steps: int = 8
    # Allowed residual over the allowed error times the springs' stiffness, and over the force at the beginning.
    accuracy: float = 0.05
    reduction: float = 0.1


@dataclass(frozen=True)
class Moved:
    """A gap in motion, see :class:`contact_study.numerics.gradient_flow.Advance`."""

    state: np.ndarray
    solution: Solution
    residual: float
    at_rest: bool = True

    @property
    def apart(self) -> bool:
        """Whether the surfaces have detached."""
        return self.solution.detached


class OverdampedContact(AdhesiveContact):
    """A contact under pressure control in overdamped motion.

    Its states in motion are gaps (m); drag is a stiffness (Pa/m), load the mean pressure (Pa), ``allowed`` the local
    error of a time step (m). Other arguments as for :class:`AdhesiveContact`.
    """

    def __init__(self, *arguments: Any, allowed: float, motion: OverdampedOptions | None = None, **options: Any):
        super().__init__(*arguments, **options)
        self._allowed = allowed / self._length
        self._motion = motion or OverdampedOptions()
        self._pairs = self.levels.equivalent_pairs(self._grid)  # at the last count of the work

    def separated(self) -> np.ndarray:
        """Return the gap of the undeformed solid just out of reach of the law (m)."""
        return super().separated() - self.height

    def advance(self, state: np.ndarray, load: float, drag: float) -> Moved | None:
        """Return the gap after a time step; see :class:`contact_study.numerics.gradient_flow.Overdamped`."""
        modulus, finest, motion = self.elasticity.contact_modulus, self.levels.finest, self._motion
        gap, pressure = self._scaled(state, load)
        stiffness = drag * self._length / modulus
        finest.set_anchor_springs(0.0, gap)
        now, apart = finest.imbalance_at(gap, pressure)
        force = now.largest
        if apart:
            return Moved(state, self._apart(Outcome.DETACHED, 0, self._count_work()), force)
        least = force * finest.excess_of(now, gap, pressure, self.tolerance).to_balance
        # In full contact nothing remains: the tolerance then.
        least = max(least, min(finest.rounding(gap), self.tolerance)) or self.tolerance
        accuracy = max(least, min(motion.accuracy * self._allowed * stiffness, motion.reduction * force))
        finest.set_anchor_springs(stiffness, gap)
        result = finest.solve(gap, pressure, accuracy, motion.newton_steps, carries=force <= self.tolerance)
        finest.set_anchor_springs(0.0, gap)
        if result.outcome is not Outcome.CONVERGED:
            return None
        # Without friction no force is larger than the residual of the solve and friction itself.
        left = result.residual + stiffness * float(np.abs(result.gap - gap).max())
        found = self._in_motion(replace(result, residual=left))
        return Moved(found.gap, found, left, self._is_at_rest(found, load))

    def standing(self, state: np.ndarray, load: float) -> Moved:
        """Return a gap without motion; apart if it is out of reach and the load does not close it."""
        if load <= 0 and self._out_of_reach(state / self._length):
            return Moved(state, self._apart(Outcome.APART), 0.0)
        gap, pressure = self._scaled(state, load)
        result = self.levels.finest.solve(gap, pressure, self.tolerance, 0)
        found = self._in_motion(result)
        return Moved(state, found, result.residual, self._is_at_rest(found, load))

    def beside_saddle(self, state: np.ndarray, load: float) -> np.ndarray | None:
        """Return a gap of lower energy next to a saddle; None at a minimum."""
        gap, pressure = self._scaled(state, load)
        self.levels.finest.imbalance_at(gap, pressure)
        lower = self.levels.leave_saddle(gap, pressure)
        return None if lower is None else lower * self._length

    def _scaled(self, state: np.ndarray, load: float) -> tuple[np.ndarray, HeightLoad]:
        """Return gap and load in the units of the levels."""
        return state / self._length, self._load(load / self.elasticity.contact_modulus)

    def _count_work(self) -> float:
        """Return the transform pairs since the last call."""
        before, self._pairs = self._pairs, self.levels.equivalent_pairs(self._grid)
        return self._pairs - before

    def _in_motion(self, result: NewtonResult) -> Solution:
        """Return a state whose law does not balance its flexure: ½<w, K w> needs a transform."""
        flexure = self.levels.finest.press(result.gap, self._heights)
        elastic = 0.5 * float(np.mean(flexure * (result.gap + self.height / self._length)))
        elastic *= self.elasticity.contact_modulus * self._length
        found = self._solution(result, self._count_work())
        elastic += self.elasticity.compression_energy(float(found.pressure.mean()))
        return replace(found, elastic_energy=elastic)

    def _is_at_rest(self, found: Solution, load: float) -> bool:
        """Return whether a state is in balance without friction under a mean pressure (Pa)."""
        unit = self.elasticity.contact_modulus
        missing, stress = load - float(found.pressure.mean()), float(np.abs(found.pressure).max())
        rounding = self.levels.finest.rounding(found.gap / self._length)
        loads = missing / unit, load / unit, stress / unit
        return excess(self.tolerance, found.residual, *loads, rounding, found.gap.size).balanced
