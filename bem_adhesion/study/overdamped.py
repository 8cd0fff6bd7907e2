"""A loading path in overdamped motion: implicit Euler steps of :mod:`contact_study.results.overdamped_path`.

A step is a minimum of the energy with springs of the stiffness η/τ at every point, by Newton steps on the finest grid.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.operators import Load
from bem_adhesion.solution import NewtonResult, Outcome, Solution
from bem_adhesion.study.interface import interface_state, solver_options
from contact_study.numerics.balance import excess
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case

NEWTON_STEPS = 8
# Allowed residual over the allowed error times the springs' stiffness, and over the force at the beginning.
ACCURACY, REDUCTION = 0.05, 0.1


class Moved(NamedTuple):
    """A gap in motion, see :class:`contact_study.results.overdamped_path.Moving`."""

    state: np.ndarray
    solution: Solution
    residual: float
    at_rest: bool = True

    @property
    def apart(self) -> bool:
        return self.solution.detached


class OverdampedContact(AdhesiveContact):
    """The contact of a case in overdamped motion: states are gaps (m), drag is a stiffness (Pa/m), loads are in Pa."""

    def __init__(self, case: Case, surface: Surface, allowed: float):
        kind = surface.sampled, surface.grid, case.solid, case.law
        super().__init__(*kind, **solver_options(case, surface.grid))
        self._case, self._surface = case, surface
        self._allowed = allowed / self._length
        self._pairs = self._work.pairs  # at the last count of the work

    def separated(self) -> np.ndarray:
        """Return the gap of the undeformed solid just out of reach of the law (m)."""
        return super().separated() - self.height

    def advance(self, state: np.ndarray, load: float, drag: float) -> Moved | None:
        """Return the gap after a time step; see :class:`contact_study.results.overdamped_path.Moving`."""
        modulus, finest = self.elasticity.contact_modulus, self.levels.finest
        gap, pressure = self._scaled(state, load)
        stiffness = drag * self._length / modulus
        finest.set_anchor_springs(0.0, gap)
        now = finest.evaluate(gap, pressure)
        force = now.largest
        if finest.is_detaching(gap, now):
            return Moved(state, self._apart(Outcome.DETACHED, 0, self._count_work()), force)
        least = force * finest.excess_of(now, gap, pressure, self.tolerance).to_balance
        # In full contact nothing remains: the tolerance then.
        least = max(least, min(finest.rounding(gap), self.tolerance)) or self.tolerance
        accuracy = max(least, min(ACCURACY * self._allowed * stiffness, REDUCTION * force))
        finest.set_anchor_springs(stiffness, gap)
        result = finest.solve(gap.copy(), pressure, accuracy, NEWTON_STEPS, carries=force <= self.tolerance)
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
        self.levels.finest.evaluate(gap, pressure)
        lower = self.levels.leave_saddle(gap, pressure)
        return None if lower is None else lower * self._length

    def described(self, found: Moved) -> InterfaceState:
        """Return a state of the contact as one of the interface."""
        stiffness = None
        if self._case.output.stiffness:
            stiffness = self.stiffness(found.solution) if found.at_rest else np.nan
        # Work since then belongs to this state, too: a run that resumes from it does not repeat it.
        solution = replace(found.solution, fft_pairs=found.solution.fft_pairs + self._count_work())
        return interface_state(self._case, solution, self._surface, stiffness)

    def _scaled(self, state: np.ndarray, load: float) -> tuple[np.ndarray, Load]:
        """Return gap and load in the units of the levels."""
        return state / self._length, self._load(load / self.elasticity.contact_modulus)

    def _count_work(self) -> float:
        """Return the transform pairs since the last call."""
        before, self._pairs = self._pairs, self._work.pairs
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
