"""Contact of a half-space with a rigid surface of finite extent, by the periodic solvers on a padded grid."""

from dataclasses import replace
from typing import Any

import numpy as np

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.hard_wall.contact import HardWallContact
from bem_adhesion.operators.free_space import FreeHalfSpace, Window, padded_grid
from bem_adhesion.solution import Solution, require_solution
from contact_study.numerics.arguments import step_arguments
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import TractionLaw
from contact_study.physics.solids import Elasticity, HalfSpace, elasticity_of


class FreeBoundaryContact:
    """One rough surface of finite extent against a half-space, for any number of loads.

    Parameters as for :func:`rough_contact`; the points of the grid are the centres of cells. Control is that of the
    pressure, a force over the area of the grid (Pa), or of the approach.
    """

    def __init__(
        self,
        height: np.ndarray,
        grid: Grid,
        elasticity: Elasticity | float,
        law: TractionLaw,
        control: str = "pressure",
        **options: Any,
    ):
        solid = elasticity_of(elasticity)
        if type(solid) is not HalfSpace:
            raise ValueError(f"elasticity = {solid!r}: free boundaries are those of a half-space")
        if control not in ("pressure", "approach"):
            raise ValueError(f"control = {control!r}: with free boundaries 'pressure' or 'approach'")
        self.height = height
        self.law = law
        self.control = control
        self._window = Window(grid.shape)
        self._grid = padded_grid(grid)
        free = FreeHalfSpace(solid.contact_modulus)
        self._mean_stiffness = free.mean_stiffness_on(self._grid)
        self._share = grid.points / self._grid.points
        self._padded: HardWallContact | AdhesiveContact
        if law.has_wall and not law.attracts:
            heights = self._window.padded(height, self._grid, -np.inf)
            self._padded = HardWallContact(heights, self._grid, free, control, **options)
        else:
            heights = self._window.padded(height, self._grid, float(height.min()))
            self._padded = AdhesiveContact(heights, self._grid, free, law, control, window=self._window, **options)

    def separated(self) -> np.ndarray:
        """Return the state of separated surfaces, on the padded grid."""
        return self._padded.separated()

    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """Find the state under a new load, see :meth:`Contact.step`.

        Fields of the solution are on the grid of the surface, its state on the padded grid, shape (2 ny, 2 nx).
        """
        state, target = step_arguments(self.control, target, state, self._grid.shape)
        return self._cropped(self._padded.step(state, target * self._share if self.control == "pressure" else target))

    def stiffness(self, solution: Solution) -> float:
        """Return −dp/d(position of the undeformed surface), p the force over the area of the grid (Pa/m)."""
        require_solution(solution)
        inner = self._padded.stiffness(solution)
        if inner == 0:
            return 0.0
        # In series: the mean of the padded surface, and the undeformed surface beyond it.
        return 1 / (self._share * (1 / inner + 1 / self._mean_stiffness))

    def _cropped(self, found: Solution) -> Solution:
        inside = self._window.inside
        gap, pressure, displacement = (
            np.ascontiguousarray(inside(field)) for field in (found.gap, found.pressure, found.displacement)
        )
        yielded = found.plastic_indentation
        mean_pressure = float(pressure.mean())
        plane = float(found.displacement.mean()) - mean_pressure * self._share / self._mean_stiffness
        # Half the work of the pressures, at each point from the undeformed surface to the displacement.
        elastic = 0.5 * float(np.mean(pressure * (displacement - plane)))
        return replace(
            found,
            displacement=displacement,
            gap=gap,
            pressure=pressure,
            plastic_indentation=None if yielded is None else np.ascontiguousarray(inside(yielded)),
            elastic_energy=elastic,
            interaction_energy=found.interaction_energy / self._share,
            plane=plane,
        )
