"""Contact with a hard wall without adhesion; gap and approach are found as the pressure that leads to them."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from threading import RLock

import numpy as np

from bem_adhesion.hard_wall.active_set import ContactLevel
from bem_adhesion.kernels.law import PINNED
from bem_adhesion.linear.conjugate_gradients import LinearisedContact, typical_wavenumber
from bem_adhesion.operators import Trace, Work, periodic
from bem_adhesion.solution import Outcome, Solution, approach_stiffness, check_arguments, require_solution
from contact_study.numerics.arguments import positive, step_arguments
from contact_study.numerics.grid import Grid
from contact_study.numerics.kernel import inner_product
from contact_study.numerics.memory import in_turn
from contact_study.physics.laws import HardWall
from contact_study.physics.solids import Elasticity, elasticity_of

SIMILAR_LOAD = 16  # relative change of the load, times points along the longer side, up to which a state is a start
SHARE_OF_PUNCH = 1e-3  # unit of errors of a nearly flat punch, over its displacement
# Search for a pressure: largest over the hardness (no point is open then), first over that of a closed approach, and
# step in the logarithm until the root is between two pressures.
LARGEST_SHARE, FIRST_SHARE, STRIDE = 1 - 1e-9, 1e-3, 2.0
AT_HARDNESS = 1e-8  # relative difference from the hardness of one of many points that yield


class HardWallContact:
    """One rough surface against an elastic solid, see :func:`rough_contact`; no surface at heights of minus infinity.

    Errors are over the rms height, or over ``unit`` (m), for a nearly flat punch over a thousandth of its displacement.
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
        machine_compliance: float = 0.0,
    ):
        self.elasticity = elasticity_of(elasticity)
        check_arguments(grid, control, tolerance, max_iterations, self.elasticity, machine_compliance)
        self._approach_stiffness = approach_stiffness(self.elasticity, grid, machine_compliance)
        self.turn = RLock()
        self.control, self.tolerance, self.max_iterations = control, tolerance, max_iterations
        self.grid, self.law, self.strength = grid, HardWall(), None
        self.machine_compliance = machine_compliance  # per area (m/Pa)
        self.hardness = np.inf if hardness is None else positive("hardness", hardness, "Pa")
        self.height = height
        finite = ~np.isneginf(height)
        self._bounded = bool(finite.all())
        present = height if self._bounded else height[finite]
        self._share, self._mean_height = present.size / height.size, float(present.mean())
        rms_height = float(present.std())
        self._unit = unit or rms_height
        self._rounding = float(np.finfo(float).eps * max(present.max(), -present.min()))
        self._flat = self._bounded and rms_height <= self._rounding
        self._period = max(grid.size)
        self._threads, self._work = threads, Work(grid.points, trace)
        self._unit_of_level = 0.0
        if not self._flat:
            self._scale_to(self._unit or self._period)

    def _scale_to(self, unit: float) -> None:
        """Make a level in this unit of heights (m)."""
        if unit == self._unit_of_level:
            return
        period, modulus = self._period, self.elasticity.contact_modulus
        self._unit_of_level, self._pressure_unit = unit, modulus * unit / period
        grid = Grid(self.grid.shape, (self.grid.size[0] / period, self.grid.size[1] / period))
        heights = self.height - self._mean_height
        heights /= unit
        make_operator = periodic(self.elasticity.scaled(period, modulus), threads=self._threads, work=self._work)
        self._level = ContactLevel(heights, grid, make_operator, self.hardness / self._pressure_unit)

    def _unit_at(self, displacement: float) -> float:
        """Return the unit of errors at a displacement of a punch (m)."""
        return self._unit if self._bounded else max(self._unit, SHARE_OF_PUNCH * displacement)

    def separated(self) -> np.ndarray:
        """Return the state without contact: zero pressure (Pa), read-only."""
        return np.broadcast_to(0.0, self.grid.shape)

    @in_turn
    def stiffness(self, solution: Solution) -> float:
        """Return −dp/dū of a state of this contact (Pa/m): zero without contact, infinite in full contact."""
        require_solution(solution)
        touching = solution.state > 0
        if self._flat or touching.all():
            return np.inf if touching.all() else 0.0
        single = self._level.single
        shift = typical_wavenumber(np.where(np.isfinite(self.height), self.height, self._mean_height), self.grid)
        shift *= 0.5 * self._period  # K of that wave in units of the modulus over the period
        curvature = np.where(touching, np.float32(PINNED * single.largest), np.float32(0))
        found = LinearisedContact(single, shift).mean_stiffness(curvature, touching)
        return found * self.elasticity.contact_modulus / self._period

    @in_turn
    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """Find the contact at a load, see :meth:`Contact.step`; the state, a pressure (Pa), only changes the work."""
        state, target = step_arguments(self.control, target, state, self.grid.shape)
        if target < 0 and self.control != "approach":
            raise ValueError(f"target = {target:g}: a hard wall without adhesion has no negative mean {self.control}")
        if self.control == "gap" and target == 0 and np.isfinite(self.hardness):
            raise ValueError("target = 0: with a hardness surfaces close at no one pressure; give a gap above zero")
        solve = {"pressure": self._at_pressure, "gap": self._at_gap, "approach": self._at_approach}[self.control]
        before = self._work.pairs
        return replace(solve(state, target), fft_pairs=self._work.pairs - before)

    def _at_pressure(self, state: np.ndarray, mean_pressure: float) -> Solution:
        if self._flat:
            return self._solution(np.full(self.grid.shape, mean_pressure), np.zeros(self.grid.shape))
        if mean_pressure == 0:
            return self._apart(float(self.height.max()))
        unit = self._unit_at(mean_pressure / self._share * self._period / self.elasticity.contact_modulus)
        self._scale_to(unit)
        level, load = self._level, mean_pressure / self._pressure_unit
        # An earlier state, without its tension, that carries nearly that load.
        carried = float(np.maximum(state, 0).mean())
        if carried > 0 and abs(carried / mean_pressure - 1) * max(state.shape) <= SIMILAR_LOAD:
            level.start_from(state, load)
        elif level.start(load, self.max_iterations) and not level.exceeds_bound():  # full contact
            return self._solution(level.pressure * self._pressure_unit, np.zeros(self.grid.shape))
        end = level.solve(load, self.tolerance, self.max_iterations)
        gap, indentation, surface = level.gap(), level.indentation(), None
        gap *= unit
        if indentation is not None:
            indentation *= unit
        if not self._bounded or indentation is not None:
            surface = level.surface() * unit + self._mean_height
        return self._solution(level.pressure * self._pressure_unit, gap, end, surface, indentation)

    def _at_gap(self, state: np.ndarray, mean_gap: float) -> Solution:
        """Find the pressure that leaves that gap."""
        if self._flat or mean_gap >= self.height.max() - self._mean_height:
            return self._apart(self._mean_height + mean_gap)
        least_full = self._level.least_full_contact_pressure() * self._pressure_unit
        if mean_gap == 0:
            return self._at_pressure(state, least_full * (1 + 1e-12))

        def excess(found: Solution) -> float:
            return float(found.gap.mean()) - mean_gap

        most = min(least_full, LARGEST_SHARE * self.hardness)
        # Contact falls about exponentially with the gap, on the scale of the rms height.
        first = most * np.exp(-mean_gap / self._unit)
        found = self._find_pressure(state, excess, self.tolerance * self._unit, first, most)
        # Points that have yielded have no gap.
        moving = float(np.mean(found.pressure <= 0.5 * self.hardness))
        return self._correct_position(found, excess(found), self._unit, moving)

    def _at_approach(self, state: np.ndarray, approach: float) -> Solution:
        """Find the pressure that leads to that approach."""
        highest = float(self.height.max())
        plane = highest - approach
        if approach <= self._rounding:
            return self._apart(plane)
        stiffness = self._approach_stiffness

        def excess(found: Solution) -> float:
            return float(found.displacement.mean()) - float(found.pressure.mean()) / stiffness - plane

        first = float(state.mean()) or FIRST_SHARE * stiffness * approach
        uniform = stiffness * (self._mean_height - plane)
        if self._flat or (self._bounded and uniform >= self._level.least_full_contact_pressure() * self._pressure_unit):
            first = uniform  # of full contact
        unit = self._unit_at(approach) or approach
        # A share of small approaches: near first touch the surface is known to rounding.
        tolerance = self.tolerance * min(unit, approach)
        found = self._find_pressure(state, excess, tolerance, first, LARGEST_SHARE * self._share * self.hardness)
        return self._correct_position(found, excess(found), unit)

    def _find_pressure(
        self, state: np.ndarray, excess: Callable[[Solution], float], tolerance: float, first: float, most: float
    ) -> Solution:
        """Find where an excess distance (m), falling with the pressure, vanishes; at most the largest pressure (Pa)."""
        latest: tuple[float, Solution] | None = None

        def at(log_pressure: float) -> Solution:
            nonlocal latest
            found = self._at_pressure(latest[1].state if latest else state, float(np.exp(log_pressure)))
            latest = log_pressure, found
            return found

        @cache
        def left(log_pressure: float) -> float:
            away = excess(at(log_pressure))
            return away if abs(away) > tolerance else 0.0

        top = float(np.log(most))
        low = high = min(float(np.log(first)), top)
        while left(low) < 0:
            low, high = low - STRIDE, low
        while left(high) > 0 and high < top:
            low, high = high, min(high + STRIDE, top)
        from scipy.optimize import brentq  # slow to import

        root = high if left(high) >= 0 else brentq(left, low, high, xtol=1e-15, rtol=1e-14)
        return latest[1] if latest and latest[0] == root else at(root)

    def _correct_position(self, found: Solution, excess: float, unit: float, moving: float = 1.0) -> Solution:
        """Return the solution, or, ``excess`` (m) off the target, the state between two of the same pressure."""
        # Two solves of one pressure differ by their tolerance each.
        if not found.converged or abs(excess) <= 3 * self.tolerance * unit:
            return found
        if np.isinf(self.hardness):
            return replace(found, outcome=Outcome.ITERATION_LIMIT)
        lift = -excess / moving
        near_hardness = (2 * LARGEST_SHARE - 1) * self._share * self.hardness
        if lift < 0 and float(found.pressure.mean()) > near_hardness:
            return self._all_yielded(found, lift)
        return self._moved(found, lift)

    def _moved(self, found: Solution, lift: float) -> Solution:
        """Move the solid as a whole, unchanged, at a pressure at which every touching point yields."""
        pressure = found.pressure
        yields = pressure > 0.5 * self.hardness
        away = np.where(yields, pressure - self.hardness, pressure)
        gap = np.where(yields, 0.0, found.gap + lift)
        indentation = np.zeros(self.grid.shape) if found.plastic_indentation is None else found.plastic_indentation
        indentation = np.where(yields, indentation - lift, 0.0)
        if np.abs(away).max() > AT_HARDNESS * self.hardness or gap.min() < 0 or indentation.min() < 0:
            return replace(found, outcome=Outcome.ITERATION_LIMIT)
        end = found.residual, found.iterations, Outcome.CONVERGED
        return self._solution(np.where(yields, self.hardness, 0.0), gap, end, found.displacement + lift, indentation)

    def _all_yielded(self, found: Solution, lift: float) -> Solution:
        """Move the solid where every point yields: flagged, as no load holds the surfaces there."""
        there = np.isfinite(self.height)
        surface = found.displacement + lift
        pressure, gap = np.where(there, self.hardness, 0.0), np.where(there, 0.0, np.inf)
        indentation = np.where(there, np.maximum(self.height - surface, 0.0), 0.0)
        end = found.residual, found.iterations, Outcome.YIELDED
        return self._solution(pressure, gap, end, surface, indentation)

    def _apart(self, plane: float) -> Solution:
        """Return the solution without contact, the solid's surface at a height (m)."""
        surface = np.full(self.grid.shape, plane)
        return self._solution(np.zeros(self.grid.shape), surface - self.height, surface=surface)

    def _solution(
        self,
        pressure: np.ndarray,
        gap: np.ndarray,
        end: tuple[float, int, Outcome] = (0.0, 0, Outcome.CONVERGED),
        surface: np.ndarray | None = None,
        indentation: np.ndarray | None = None,
    ) -> Solution:
        displacement = self.height + gap if surface is None else surface
        work = inner_product(pressure, displacement) / self.grid.points
        elastic_energy = 0.5 * float(work - pressure.mean() * displacement.mean())
        elastic_energy += self.elasticity.compression_energy(float(pressure.mean()))
        beyond = None
        if np.isfinite(self.hardness):
            beyond = max(0.0, -float(pressure.min()), float(pressure.max()) - self.hardness)
            beyond /= self.elasticity.contact_modulus
        residual, iterations, outcome = end
        return Solution(
            pressure,
            displacement,
            gap,
            pressure,
            elastic_energy,
            interaction_energy=0.0,
            residual=residual,
            iterations=iterations,
            fft_pairs=0.0,
            outcome=outcome,
            complementarity_residual=beyond,
            plastic_indentation=indentation,
            law=self.law,
        )
