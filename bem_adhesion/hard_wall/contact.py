"""Contact of an elastic solid with a rigid rough surface without adhesion.

Pressure and gap satisfy the Signorini conditions, gap >= 0, pressure >= 0, gap × pressure = 0, at every point of the
grid, for a given mean pressure, mean gap or approach. The algorithm is in :mod:`bem_adhesion.hard_wall.active_set`; gap
and approach are found as the pressure that leads to them.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from bem_adhesion.arguments import check_arguments
from bem_adhesion.hard_wall.options import HardWallOptions
from bem_adhesion.hard_wall.pressure_controlled import PressureControlledWall
from bem_adhesion.operators.trace import Trace
from bem_adhesion.solution import Outcome, Solution
from contact_study.numerics.arguments import step_arguments
from contact_study.numerics.exclusive import in_turn
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import Elasticity, elasticity_of


def find_pressure(
    press: Callable[[np.ndarray, float], Solution],
    state: np.ndarray,
    excess: Callable[[Solution], float],
    tolerance: float,
    first: float,
    most: float,
    stride: float = 2.0,
) -> Solution:
    """Find the state at the pressure at which an excess distance, which falls with the pressure, vanishes.

    Within ``tolerance`` (m) it is zero. Where it is positive even at the largest pressure (Pa) the state is that one.
    """
    start = state
    latest: tuple[float, Solution] | None = None

    def at(log_pressure: float) -> Solution:
        nonlocal start, latest
        found = press(start, float(np.exp(log_pressure)))
        start, latest = found.state, (log_pressure, found)
        return found

    @cache
    def left(log_pressure: float) -> float:
        away = excess(at(log_pressure))
        return away if abs(away) > tolerance else 0.0

    top = float(np.log(most))
    low = high = min(float(np.log(first)), top)
    while left(low) < 0:
        low, high = low - stride, low
    while left(high) > 0 and high < top:
        low, high = high, min(high + stride, top)
    from scipy.optimize import brentq  # slow to import

    root = high if left(high) >= 0 else brentq(left, low, high, xtol=1e-15, rtol=1e-14)
    return latest[1] if latest and latest[0] == root else at(root)


class HardWallContact(PressureControlledWall):
    """One rough surface against an elastic solid, for any number of loads.

    Parameters as for :func:`rough_contact`; heights of minus infinity are points without a surface, see
    :class:`~bem_adhesion.contacts.free_boundary.FreeBoundaryContact`. Shapes that can be halved converge in half the
    time. ``tolerance`` is the largest gap inside the contact and penetration outside in units of the rms height, or of
    ``unit`` (m); for a nearly flat punch with free boundaries of a thousandth of its displacement; under control of
    the gap or the approach also its largest error. ``hardness`` is the largest pressure (Pa), at which points yield;
    :class:`~bem_adhesion.contacts.plastic.PlasticContact` keeps the indentation.
    """

    def __init__(
        self,
        height: np.ndarray,
        grid: Grid,
        elasticity: Elasticity | float,
        control: str = "pressure",
        tolerance: float = 1e-10,
        max_iterations: int = 200,
        threads: int = 1,
        hardness: float | None = None,
        unit: float | None = None,
        trace: Trace | None = None,
        options: HardWallOptions | None = None,
    ):
        solid = elasticity_of(elasticity)
        heights = np.where(np.isneginf(height), 0.0, height)
        check_arguments(heights, grid, control, tolerance, max_iterations, solid)
        super().__init__(height, grid, solid, tolerance, max_iterations, threads, hardness, unit, trace, options)
        self.control = control

    @in_turn
    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """Find the contact at a load, see :meth:`Contact.step`. It is unique: the state only changes the work.

        The state is a pressure (Pa); it replaces the coarser grids as the start where its mean is near the target.
        Mean pressures and gaps are not negative. Above the gap of first touch, or at an approach up to zero, there is
        no contact; at a gap of zero the pressure is the least of full contact.
        """
        state, target = step_arguments(self.control, target, state, self.grid.shape)
        self._check_target(target)
        solve = {"pressure": self._at_pressure, "gap": self._at_gap, "approach": self._at_approach}[self.control]
        before = self._pairs()
        return replace(solve(state, target), fft_pairs=self._pairs() - before)

    def _check_target(self, target: float) -> None:
        if self.control == "approach":
            return
        if target < 0:
            raise ValueError(f"target = {target:g}: a hard wall without adhesion has no negative mean {self.control}")
        if self.control == "pressure" and target >= self._share * self.hardness:
            asked = target / self._share  # with free boundaries on the surface alone
            raise ValueError(f"target = {asked:g}: no state carries the hardness, {self.hardness:g} Pa, or more")
        if self.control == "gap" and target == 0 and np.isfinite(self.hardness):
            raise ValueError("target = 0: with a hardness surfaces close at no one pressure; give a gap above zero")

    def _at_gap(self, state: np.ndarray, mean_gap: float) -> Solution:
        """Find the pressure that leaves that gap."""
        if self._flat or mean_gap >= self._height.max() - self._mean_height:
            return self._apart(self._mean_height + mean_gap)
        least_full = self._least_full_contact_pressure()
        if mean_gap == 0:
            return self._at_pressure(state, least_full * (1 + 1e-12))

        def excess(found: Solution) -> float:
            return float(found.gap.mean()) - mean_gap

        most = min(least_full, self.options.largest_share * self.hardness)
        # Contact falls about exponentially with the gap, on the scale of the rms height.
        first = most * np.exp(-mean_gap / self._unit)
        found = self._search(state, excess, self.tolerance * self._unit, first, most)
        # Points that have yielded have no gap.
        moving = float(np.mean(found.pressure <= 0.5 * self.hardness))
        return self._correct_position(found, excess(found), self._unit, moving)

    def _at_approach(self, state: np.ndarray, approach: float) -> Solution:
        """Find the pressure that leads to that approach."""
        highest = float(self._height.max())
        plane = highest - approach
        if approach <= self._rounding:
            return self._apart(plane)
        stiffness = self.elasticity.mean_stiffness_on(self.grid)

        def excess(found: Solution) -> float:
            return float(found.displacement.mean()) - float(found.pressure.mean()) / stiffness - plane

        first = float(state.mean()) or self.options.first_share * stiffness * approach
        uniform = stiffness * (self._mean_height - plane)
        if self._flat or (self._bounded and uniform >= self._least_full_contact_pressure()):
            first = uniform  # of full contact
        unit = self._unit_at(approach) or approach
        # A share of small approaches: near first touch the surface is known to rounding.
        tolerance = self.tolerance * min(unit, approach)
        most = self.options.largest_share * self._share * self.hardness
        found = self._search(state, excess, tolerance, first, most)
        return self._correct_position(found, excess(found), unit)

    def _search(
        self, state: np.ndarray, excess: Callable[[Solution], float], tolerance: float, first: float, most: float
    ) -> Solution:
        return find_pressure(self._at_pressure, state, excess, tolerance, first, most, self.options.stride)

    def _correct_position(self, found: Solution, excess: float, unit: float, moving: float = 1.0) -> Solution:
        """Return the solution, or the state between two where surfaces approach at the same pressure.

        ``excess`` is their distance beyond the target (m), ``moving`` its change per movement of the solid.
        """
        # Two solves of one pressure differ by their tolerance each.
        if not found.converged or abs(excess) <= 3 * self.tolerance * unit:
            return found
        if np.isinf(self.hardness):
            return replace(found, outcome=Outcome.ITERATION_LIMIT)
        lift = -excess / moving
        near_hardness = (2 * self.options.largest_share - 1) * self._share * self.hardness
        if lift < 0 and float(found.pressure.mean()) > near_hardness:
            return self._all_yielded(found, lift)
        return self._moved(found, lift)

    def _moved(self, found: Solution, lift: float) -> Solution:
        """Move the solid as a whole at a pressure at which every touching point yields.

        Under a whole number of points times the hardness surfaces approach at the same pressure, the solid unchanged.
        """
        pressure = found.pressure
        yields = pressure > 0.5 * self.hardness
        away = np.where(yields, pressure - self.hardness, pressure)
        gap = np.where(yields, 0.0, found.gap + lift)
        indentation = np.zeros(self.grid.shape) if found.plastic_indentation is None else found.plastic_indentation
        indentation = np.where(yields, indentation - lift, 0.0)
        if np.abs(away).max() > self.options.at_hardness * self.hardness or gap.min() < 0 or indentation.min() < 0:
            return replace(found, outcome=Outcome.ITERATION_LIMIT)
        return self._solution(
            np.where(yields, self.hardness, 0.0),
            gap,
            found.residual,
            found.iterations,
            surface=found.displacement + lift,
            indentation=indentation,
        )

    def _all_yielded(self, found: Solution, lift: float) -> Solution:
        """Move the solid where every point yields: flagged, as no load holds the surfaces there."""
        there = np.isfinite(self._height)
        surface = found.displacement + lift
        return self._solution(
            np.where(there, self.hardness, 0.0),
            np.where(there, 0.0, np.inf),
            found.residual,
            found.iterations,
            Outcome.YIELDED,
            surface,
            np.where(there, np.maximum(self._height - surface, 0.0), 0.0),
        )
