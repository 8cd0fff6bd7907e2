"""Contact with a hard wall under a pressure that cannot exceed a bound, the hardness of the softer body.

The pressure minimises ½<p, C p> − <p, h> among those of the given mean with 0 <= p <= bound, C = 1/K(q) the compliance
of the solid: a convex problem with one solution. Its conditions are those of a rigid-perfectly plastic surface layer,

    gap = C p − h − offset >= 0 where p = 0,    gap = 0 between,    indentation = −gap >= 0 where p = bound.

The offset belongs to the whole step along the gradient that is cut off at the bounds and keeps the load: few points may
be between the bounds, and where nearly all yield it is the height above which they do. The free points (between the
bounds, or at one of them and pushed inwards) take a step of the same conjugate gradients as on a hard wall without a
bound. The step is cut off at the bounds, the load restored by a shift of the free points, and the step shortened, and
finally turned along the gradient, until the energy falls (D. P. Bertsekas, SIAM J. Control Optim. 20, 221 (1982)). The
energy of a convex problem falls from step to step: the iteration cannot cycle, and it ends only at the solution.
"""

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from bem_adhesion.hard_wall import kernels
from bem_adhesion.hard_wall.active_set import ContactLevel
from bem_adhesion.hard_wall.options import ActiveSetOptions
from bem_adhesion.operators.fourier import MakeOperator
from bem_adhesion.solution import Outcome
from contact_study.numerics.grid import Grid


class BoundedLevel(ContactLevel):
    """A :class:`ContactLevel` with an upper bound to the pressure; without a point at the bound it is the same."""

    def __init__(
        self,
        bound: float,
        heights: np.ndarray,
        grid: Grid,
        make_operator: MakeOperator,
        options: ActiveSetOptions | None = None,
    ):
        super().__init__(heights, grid, make_operator, options)
        self._bound = bound
        self._offset: float | None = None  # of surface and heights, once points are at the bound

    def _coarser(self, heights: np.ndarray) -> "BoundedLevel":
        grid = self.grid.with_shape((heights.shape[0], heights.shape[1]))
        return BoundedLevel(self._bound, heights, grid, self._make_operator, self.options)

    def start_from(self, pressure: np.ndarray, mean_pressure: float) -> None:
        super().start_from(pressure, mean_pressure)
        if pressure.max() >= self._bound:
            np.maximum(pressure, 0, out=self.pressure)
            self._bring_within(mean_pressure)

    def solve(self, mean_pressure: float, tolerance: float, max_iterations: int) -> tuple[float, int, Outcome]:
        self._offset = None
        iterations = 0
        if self.pressure.max() < self._bound:
            residual, iterations, outcome = super().solve(mean_pressure, tolerance, max_iterations)
            if self.pressure.max() <= self._bound:
                return residual, iterations, outcome
        residual, more, outcome = self._solve_bounded(mean_pressure, tolerance, max_iterations)
        return residual, iterations + more, outcome

    def exceeds_bound(self) -> bool:
        return bool(self.pressure.max() > self._bound)

    def _solve_bounded(self, mean_pressure: float, tolerance: float, max_iterations: int) -> tuple[float, int, Outcome]:
        """Solve from the present pressure with the bound; return residual, iterations and outcome."""
        heights, contact, pressure = self.heights.reshape(-1), self.contact.reshape(-1), self.pressure.reshape(-1)
        floor = max(0.3 * tolerance, 4 * np.finfo(float).eps * self._largest_height)
        bound, total = self._bound, mean_pressure * self.grid.points
        self._bring_within(mean_pressure)
        displacement = self._displaced()
        energy = kernels.energy(displacement, heights, pressure)
        iteration = 0
        while True:
            self._offset = self._multiplier(displacement, total)
            error = kernels.judge(displacement, heights, self._offset, pressure, bound, contact)
            self._double.mark("iteration", error)
            if error <= tolerance:
                return error, iteration, Outcome.CONVERGED
            if iteration == max_iterations:
                return error, iteration, Outcome.ITERATION_LIMIT
            iteration += 1
            before = pressure.copy()
            # A punch sinks in by more than its heights: its energy is the scale there.
            scale = max(total * self._largest_height, abs(energy))
            allowed = energy + self.options.energy_rounding * scale
            for trial in self._trials(displacement, floor):
                pressure[...] = trial
                kernels.carry(pressure, contact, bound, total)
                displacement = self._displaced()
                energy = kernels.energy(displacement, heights, pressure)
                if energy <= allowed:
                    break
            else:
                pressure[...] = before
                self._displaced()
                return error, iteration, Outcome.STALLED

    def _multiplier(self, displacement: np.ndarray, total: float) -> float:
        """Return the offset at which a step along the gradient, brought within the bounds, keeps the load.

        At the solution it is that of the points between the bounds; where there are few, those at the bounds decide.
        """
        stiffness = self._single.largest
        moved = np.empty(displacement.size)
        heights, pressure = self.heights.reshape(-1), self.pressure.reshape(-1)
        present = kernels.descended(displacement, heights, pressure, stiffness, moved)
        return kernels.balancing_shift(moved, present, self._bound, total)[0] / stiffness

    def _trials(self, displacement: np.ndarray, floor: float) -> Iterator[np.ndarray]:
        """Yield pressures to try, flat, before they are brought within the bounds.

        Steps of conjugate gradients first. They may fail where almost no point is between its bounds; along the
        projected gradient the energy falls once the step is as short as the solid's longest wave is soft.
        """
        pressure, heights, contact = self.pressure.reshape(-1), self.heights.reshape(-1), self.contact.reshape(-1)
        residual = self._residual.reshape(-1)
        mean = kernels.offset(displacement, heights, contact)
        largest = kernels.residual(displacement, heights, mean, contact, residual)
        before, downhill = pressure.copy(), residual.copy()
        self._correct(largest, floor)
        change = pressure - before
        for fraction in self.options.fractions:
            yield before + fraction * change
        length = self._single.largest
        while length > self._softest:
            yield before + length * downhill
            length *= 0.5

    @cached_property
    def _softest(self) -> float:
        """Half the smallest stiffness of a wave."""
        stiffness_q = self._double.stiffness * self.grid.points
        return 0.5 * float(stiffness_q[stiffness_q > 0].min())

    def _displaced(self) -> np.ndarray:
        """Return the displacement under the present pressure, flat."""
        self._double.field[...] = self.pressure
        return self._double.apply(self._double.compliance).reshape(-1)

    def _bring_within(self, mean_pressure: float) -> None:
        """Bring the pressure within the bounds: on its own contact set if that can carry the load, else everywhere."""
        total = mean_pressure * self.grid.points
        np.greater(self.pressure, 0, out=self.contact)
        if self._bound * np.count_nonzero(self.contact) <= total:
            np.isfinite(self.heights, out=self.contact)
        kernels.carry(self.pressure.reshape(-1), self.contact.reshape(-1), self._bound, total)

    def surface(self) -> np.ndarray:
        return super().surface() if self._offset is None else self._double.field - self._offset

    def gap(self) -> np.ndarray:
        if self._offset is None:
            return super().gap()
        return np.where(self.pressure > 0, 0.0, np.maximum(self.surface() - self.heights, 0))

    def indentation(self) -> np.ndarray | None:
        if self._offset is None:
            return None
        return np.where(self.pressure >= self._bound, np.maximum(self.heights - self.surface(), 0), 0.0)

    def refine(self) -> np.ndarray:
        """Refine as without a bound; beyond the bound with the pressure that would have made the indentation.

        The edge of yielding is then between the points, too.
        """
        if self._offset is None:
            return super().refine()
        # A wave of two spacings along an axis is √2 less stiff than the one along the diagonal.
        stiffness = self._single.largest / np.sqrt(2)
        refined = np.empty((2 * self.grid.shape[0], 2 * self.grid.shape[1]))
        kernels.refine(self.pressure + stiffness * (self.indentation() - self.gap()), refined)
        return refined
