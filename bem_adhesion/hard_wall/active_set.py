"""Active sets for the contact of an elastic solid with a hard wall, nested over grids.

On a trial contact set A solve C_AA p = h + offset, C = 1/K(q), for a correction of p; points of A that pull leave it
and points outside that penetrate enter at once (M. Hintermüller, K. Ito & K. Kunisch, SIAM J. Optim. 13, 865 (2002)).
With a bound, the hardness, p minimises ½<p, C p> − <p, h> at 0 <= p <= bound, indentation = −gap >= 0 where p = bound:
a step is cut off at the bounds, the load restored by a shift, and the step shortened, and finally turned along the
gradient, until the energy falls (D. P. Bertsekas, SIAM J. Control Optim. 20, 221 (1982)).
"""

from collections.abc import Iterator

import numpy as np

from bem_adhesion.hard_wall import kernels
from bem_adhesion.hard_wall.preconditioner import Extension
from bem_adhesion.operators import MakeOperator
from bem_adhesion.solution import Outcome
from contact_study.numerics.grid import Grid

# Points along the shorter side down to which grids are halved, and tolerance on all grids but the finest.
COARSEST, COARSE_TOLERANCE = 32, 1e-2
ENERGY_ROUNDING, FRACTIONS = 1e-13, (1.0, 0.5, 0.25)  # of equal energies; of a step that are tried
REDUCTION, INNER_ITERATIONS = 0.03, 15  # of conjugate gradients on one contact set


class ContactLevel:
    """The contact problem on one grid and, below it, on every second point of that grid.

    Units: rms height for heights and gaps, longest period along the surface, E* rms height / period for pressures.
    Heights of minus infinity are points without a surface.
    """

    def __init__(self, heights: np.ndarray, grid: Grid, make_operator: MakeOperator, bound: float = np.inf):
        self.heights, self.grid = heights, grid
        self._make_operator = make_operator
        self._double, self.single = make_operator(grid, np.float64), make_operator(grid, np.float32)
        self.contact, self.pressure = np.ones(grid.shape, bool), np.empty(grid.shape)
        self._extension = Extension(self.contact)
        self._residual, self._direction = np.empty((2, *grid.shape), np.float32)
        # Views over all points of heights, contact set, pressure and residual, for the kernels.
        self._flat = [field.reshape(-1) for field in (heights, self.contact, self.pressure, self._residual)]
        self._bound = bound
        self._offset: float | None = None  # of surface and heights, once points are at the bound
        present = np.isfinite(heights)
        self._absent = None if present.all() else ~present  # a periodic surface needs no memory for it
        self._largest_height = max(float(heights.max()), -float(heights.min(where=present, initial=0.0)))

    def start(self, mean_pressure: float, max_iterations: int) -> bool:
        """Compute a first pressure on coarser levels; return whether it is full contact, hence the solution."""
        rows, columns = self.grid.shape
        if rows % 2 or columns % 2 or min(rows, columns) < 2 * COARSEST:
            return self.start_from_full_contact(mean_pressure)
        heights = np.ascontiguousarray(self.heights[::2, ::2])
        coarser = ContactLevel(heights, self.grid.halved, self._make_operator, self._bound)
        full_contact = coarser.start(mean_pressure, max_iterations)
        if not full_contact:
            coarser.solve(mean_pressure, COARSE_TOLERANCE, max_iterations)
            self.start_from(coarser.refine(), mean_pressure)
        return full_contact and self.start_from_full_contact(mean_pressure)

    def start_from_full_contact(self, mean_pressure: float) -> bool:
        """Start from the pressure of full contact cut off at zero; return whether this is already the solution."""
        np.maximum(self.heights, -self._largest_height, out=self._double.field)
        np.add(self._double.apply(self._double.stiffness), mean_pressure, out=self.pressure)
        if self._absent is not None:
            self.pressure[self._absent] = 0
        elif self.pressure.min() >= 0:
            return True
        self.start_from(self.pressure, mean_pressure)
        return False

    def least_full_contact_pressure(self) -> float:
        """Return the smallest mean pressure of full contact."""
        self._double.field[...] = self.heights
        return -float(self._double.apply(self._double.stiffness).min())

    def start_from(self, pressure: np.ndarray, mean_pressure: float) -> None:
        """Start from the positive part of a pressure field, scaled to the mean pressure."""
        np.maximum(pressure, 0, out=self.pressure)
        np.greater(self.pressure, 0, out=self.contact)
        self.pressure *= mean_pressure / self.pressure.mean()
        if pressure.max() >= self._bound:
            np.maximum(pressure, 0, out=self.pressure)
            self._bring_within(mean_pressure)

    def solve(self, mean_pressure: float, tolerance: float, max_iterations: int) -> tuple[float, int, Outcome]:
        """Solve from the present pressure; return residual, iterations and outcome."""
        self._offset, before = None, 0
        if not self.pressure.max() >= self._bound:
            residual, before, outcome = self._solve_unbounded(mean_pressure, tolerance, max_iterations)
            if not self.exceeds_bound():
                return residual, before, outcome
        residual, iterations, outcome = self._solve_bounded(mean_pressure, tolerance, max_iterations)
        return residual, before + iterations, outcome

    def _solve_unbounded(
        self, mean_pressure: float, tolerance: float, max_iterations: int
    ) -> tuple[float, int, Outcome]:
        heights, contact, _, residual = self._flat
        threshold = self._threshold(tolerance)
        # A guess is solved on its own contact set first: the gap of a pressure that was interpolated and cut off at
        # zero does not show which points should enter.
        iteration, entered, deepest, previous = 0, 1, 0.0, np.inf
        while True:
            iteration += 1
            displacement = self._displaced()
            if iteration > 1:
                offset = kernels.offset(displacement, heights, contact)
                entered, deepest = kernels.enter(displacement, heights, offset, threshold, contact)
            left = self._drop_tension(mean_pressure)
            offset = kernels.offset(displacement, heights, contact)
            largest = kernels.residual(displacement, heights, offset, contact, residual)
            error = max(largest, deepest)
            self._double.mark("iteration", error)
            if not entered and not left and error <= tolerance:
                return error, iteration, Outcome.CONVERGED
            if not entered and not left and not largest < 0.5 * previous:
                return error, iteration, Outcome.STALLED
            if iteration == max_iterations:
                return error, iteration, Outcome.ITERATION_LIMIT
            previous = largest
            self._correct(largest, threshold)

    def _drop_tension(self, mean_pressure: float) -> int:
        """Remove points that pull from the contact set, keep the load, update the displacement; return their number."""
        (_, contact, pressure, _), change = self._flat, self.single.field.reshape(-1)
        left, total = kernels.leave(pressure, contact, change)
        factor = mean_pressure * self.grid.points / total
        if left:
            kernels.rescale(pressure, factor, change)
            self._double.field += self.single.apply(self.single.compliance)
        else:  # single precision lets the load drift in its last digits
            self.pressure *= factor
            self._double.field *= factor
        return left

    def _correct(self, largest: float, floor: float) -> None:
        """Close the gap of the contact set at the same load by conjugate gradients for the pressure."""
        buffer = self.single.field
        (_, contact, pressure, residual), flat = self._flat, buffer.reshape(-1)
        direction = self._direction.reshape(-1)
        self.single.mark("extension")
        self._extension.update()
        self.single.mark("points")
        direction[...] = 0
        target, previous = max(REDUCTION * largest, floor), np.inf
        for _ in range(INNER_ITERATIONS):
            if largest <= target:
                return
            self.single.mark("extension")
            self._extension.extend(self._residual, buffer)
            self.single.apply(self.single.stiffness)
            self.single.mark("extension")
            self._extension.transpose(buffer)
            self.single.mark("points")
            mean, product = kernels.products(flat, residual, contact)
            kernels.turn(flat, mean, product / previous, contact, direction)
            previous = product
            response = self.single.apply(self.single.compliance).reshape(-1)
            largest = kernels.advance(pressure, residual, direction, response, contact, product)

    def exceeds_bound(self) -> bool:
        """Return whether the present pressure exceeds the bound somewhere."""
        return bool(self.pressure.max() > self._bound)

    def _solve_bounded(self, mean_pressure: float, tolerance: float, max_iterations: int) -> tuple[float, int, Outcome]:
        """Solve from the present pressure with the bound; return residual, iterations and outcome."""
        heights, contact, pressure, _ = self._flat
        bound, total = self._bound, mean_pressure * self.grid.points
        stiffness, moved = self.single.largest, np.empty(pressure.size)
        self._bring_within(mean_pressure)
        displacement = self._displaced()
        energy, iteration = kernels.energy(displacement, heights, pressure), 0
        while True:
            # At the solution it is that of the points between the bounds; where there are few, those at them decide.
            present = kernels.descended(displacement, heights, pressure, stiffness, moved)
            self._offset = kernels.balancing_shift(moved, present, bound, total)[0] / stiffness
            error = kernels.judge(displacement, heights, self._offset, pressure, bound, contact)
            self._double.mark("iteration", error)
            if error <= tolerance:
                return error, iteration, Outcome.CONVERGED
            if iteration == max_iterations:
                return error, iteration, Outcome.ITERATION_LIMIT
            iteration += 1
            before = pressure.copy()
            # A punch sinks in by more than its heights: its energy is the scale there.
            allowed = energy + ENERGY_ROUNDING * max(total * self._largest_height, abs(energy))
            for trial in self._trials(displacement, self._threshold(tolerance)):
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

    def _threshold(self, tolerance: float) -> float:
        """Return the depth from which points enter a contact set, and to which its gap is closed."""
        return max(0.3 * tolerance, 4 * np.finfo(float).eps * self._largest_height)

    def _trials(self, displacement: np.ndarray, floor: float) -> Iterator[np.ndarray]:
        """Yield flat pressures to try: along conjugate gradients, then the gradient, on which a short step falls."""
        heights, contact, pressure, residual = self._flat
        mean = kernels.offset(displacement, heights, contact)
        largest = kernels.residual(displacement, heights, mean, contact, residual)
        before, downhill = pressure.copy(), residual.copy()
        self._correct(largest, floor)
        change = pressure - before
        for fraction in FRACTIONS:
            yield before + fraction * change
        length, stiffness_q = self.single.largest, self._double.stiffness * self.grid.points
        while length > 0.5 * float(stiffness_q[stiffness_q > 0].min()):
            yield before + length * downhill
            length *= 0.5

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
        _, contact, pressure, _ = self._flat
        kernels.carry(pressure, contact, self._bound, total)

    def indentation(self) -> np.ndarray | None:
        """Return the plastic indentation of each point; None without any."""
        if self._offset is None:
            return None
        return np.where(self.pressure >= self._bound, np.maximum(self.heights - self.surface(), 0), 0.0)

    def surface(self) -> np.ndarray:
        """Return the position of the solid's surface at the end of :meth:`solve`."""
        displacement = self._double.field
        if self._offset is not None:
            return displacement - self._offset
        return displacement - np.mean((displacement - self.heights)[self.contact])

    def gap(self) -> np.ndarray:
        """Return the gap at the end of :meth:`solve`: zero in contact, infinite without a surface."""
        if self._offset is not None:
            return np.where(self.pressure > 0, 0.0, np.maximum(self.surface() - self.heights, 0))
        gap = self._double.field - self.heights
        gap -= gap[self.contact].mean()
        gap[self.contact] = 0
        return np.maximum(gap, 0, out=gap)

    def refine(self) -> np.ndarray:
        """Return the pressure for the grid of twice as many points along each side, negative out of contact."""
        # A gap enters as the tension, an indentation as the pressure that makes it: edges are between the points.
        # A wave of two spacings along an axis is √2 less stiff than the one along the diagonal.
        stiffness, indentation, gap = self.single.largest / np.sqrt(2), self.indentation(), self.gap()
        if indentation is None:
            signed = np.where(self.contact, self.pressure, -stiffness * gap)
        else:
            signed = self.pressure + stiffness * (indentation - gap)
        refined = np.empty((2 * self.grid.shape[0], 2 * self.grid.shape[1]))
        kernels.refine(signed, refined)
        return refined
