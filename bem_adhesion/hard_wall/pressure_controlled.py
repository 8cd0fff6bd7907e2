"""A hard wall under a mean pressure, elastic or with a hardness: units, starting states, and the solution's fields."""

from threading import RLock

import numpy as np

from bem_adhesion.arguments import require_solution
from bem_adhesion.hard_wall.active_set import ContactLevel
from bem_adhesion.hard_wall.options import HardWallOptions
from bem_adhesion.hard_wall.plastic_active_set import BoundedLevel
from bem_adhesion.kernels.wall import PINNED
from bem_adhesion.linear.conjugate_gradients import LinearisedContact
from bem_adhesion.linear.contact_stiffness import mean_stiffness
from bem_adhesion.linear.preconditioner import typical_wavenumber
from bem_adhesion.operators.fourier import periodic
from bem_adhesion.operators.trace import Trace
from bem_adhesion.solution import Outcome, Solution
from contact_study.numerics.arguments import positive
from contact_study.numerics.exclusive import in_turn
from contact_study.numerics.grid import Grid
from contact_study.numerics.inner_product import inner_product
from contact_study.physics.laws import HardWall
from contact_study.physics.solids import Elasticity


class PressureControlledWall:
    """One rough surface against an elastic solid, for any number of mean pressures.

    Parameters as for :class:`~bem_adhesion.hard_wall.contact.HardWallContact`, which also prescribes other quantities.
    """

    def __init__(
        self,
        height: np.ndarray,
        grid: Grid,
        elasticity: Elasticity,
        tolerance: float,
        max_iterations: int,
        threads: int,
        hardness: float | None,
        unit: float | None,
        trace: Trace | None,
        options: HardWallOptions | None,
    ):
        self.turn = RLock()
        self.elasticity = elasticity
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self.grid = grid
        self.options = options or HardWallOptions()
        self.hardness = np.inf if hardness is None else positive("hardness", hardness, "Pa")
        self._height = height
        finite = np.isfinite(height)
        self._bounded = bool(finite.all())
        present = height if self._bounded else height[finite]
        self._share = present.size / height.size
        self._mean_height = float(present.mean())
        rms_height = float(present.std())
        self._unit = unit or rms_height
        self._rounding = float(np.finfo(float).eps * max(present.max(), -present.min()))
        self._flat = self._bounded and rms_height <= self._rounding
        self._threads, self._trace = threads, trace
        self._unit_of_level = self._pairs_of_levels = 0.0
        if not self._flat:
            self._scale_to(self._unit or max(grid.size))

    def _scale_to(self, unit: float) -> None:
        """Make a level in this unit of heights (m)."""
        if unit == self._unit_of_level:
            return
        self._pairs_of_levels = self._pairs()
        period, modulus = max(self.grid.size), self.elasticity.contact_modulus
        self._unit_of_level, self._pressure_unit = unit, modulus * unit / period
        grid = Grid(self.grid.shape, (self.grid.size[0] / period, self.grid.size[1] / period))
        heights = self._height - self._mean_height
        heights /= unit
        make_operator = periodic(self.elasticity.scaled(period, modulus), threads=self._threads, trace=self._trace)
        self._level = (
            ContactLevel(heights, grid, make_operator, self.options.active_set)
            if np.isinf(self.hardness)
            else BoundedLevel(
                self.hardness / self._pressure_unit, heights, grid, make_operator, self.options.active_set
            )
        )

    def _unit_at(self, displacement: float) -> float:
        """Return the unit of errors at a displacement of a punch (m)."""
        return self._unit if self._bounded else max(self._unit, self.options.share_of_punch * displacement)

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
        shift = typical_wavenumber(np.where(np.isfinite(self._height), self._height, self._mean_height), self.grid)
        shift *= 0.5 * max(self.grid.size)  # K of that wave in units of the modulus over the period
        curvature = np.where(touching, np.float32(PINNED * single.largest), np.float32(0))
        found = mean_stiffness(LinearisedContact(single, shift), curvature, touching)
        return found * self.elasticity.contact_modulus / max(self.grid.size)

    def _at_pressure(self, state: np.ndarray, mean_pressure: float) -> Solution:
        if self._flat:
            return self._solution(np.full(self.grid.shape, mean_pressure), np.zeros(self.grid.shape))
        if mean_pressure == 0:
            return self._apart(float(self._height.max()))
        unit = self._unit_at(mean_pressure / self._share * max(self.grid.size) / self.elasticity.contact_modulus)
        self._scale_to(unit)
        level, load = self._level, mean_pressure / self._pressure_unit
        full_contact, surface, indentation = False, None, None
        if self._is_similar(state, mean_pressure):
            level.start_from(state, load)
        else:
            full_contact = level.start(load, self.max_iterations)
        if full_contact and not level.exceeds_bound():
            gap = np.zeros(self.grid.shape)
            residual, iterations, outcome = 0.0, 0, Outcome.CONVERGED
        else:
            residual, iterations, outcome = level.solve(load, self.tolerance, self.max_iterations)
            gap = level.gap()
            gap *= unit
            indentation = level.indentation()
            if indentation is not None:
                indentation *= unit
            if not self._bounded or indentation is not None:
                surface = level.surface() * unit + self._mean_height
        pressure = level.pressure * self._pressure_unit
        return self._solution(pressure, gap, residual, iterations, outcome, surface, indentation)

    def _is_similar(self, pressure: np.ndarray, mean_pressure: float) -> bool:
        """Return whether a state, without its tension, carries nearly that load (Pa)."""
        carried = float(np.maximum(pressure, 0).mean())
        return carried > 0 and abs(carried / mean_pressure - 1) * max(pressure.shape) <= self.options.similar_load

    def _pairs(self) -> float:
        """Return the transform pairs so far, as float64 pairs on the grid."""
        if not self._unit_of_level:
            return 0.0
        return self._pairs_of_levels + self._level.equivalent_pairs(self._level.grid)

    def _least_full_contact_pressure(self) -> float:
        return self._level.least_full_contact_pressure() * self._pressure_unit

    def _apart(self, plane: float) -> Solution:
        """Return the solution without contact, the solid's surface at a height (m)."""
        surface = np.full(self.grid.shape, plane)
        return self._solution(np.zeros(self.grid.shape), surface - self._height, surface=surface)

    def _solution(
        self,
        pressure: np.ndarray,
        gap: np.ndarray,
        residual: float = 0.0,
        iterations: int = 0,
        outcome: Outcome = Outcome.CONVERGED,
        surface: np.ndarray | None = None,
        indentation: np.ndarray | None = None,
    ) -> Solution:
        displacement = self._height + gap if surface is None else surface
        work = inner_product(pressure, displacement) / self.grid.points
        elastic_energy = 0.5 * float(work - pressure.mean() * displacement.mean())
        elastic_energy += self.elasticity.compression_energy(float(pressure.mean()))
        beyond = None
        if np.isfinite(self.hardness):
            beyond = max(0.0, -float(pressure.min()), float(pressure.max()) - self.hardness)
            beyond /= self.elasticity.contact_modulus
        return Solution(
            pressure,
            displacement,
            gap,
            pressure,
            elastic_energy,
            0.0,
            residual,
            iterations,
            0.0,
            outcome,
            complementarity_residual=beyond,
            plastic_indentation=indentation,
            law=HardWall(),
        )
