"""Primal-dual active set for the contact of an elastic solid with a hard wall, nested over grids.

Find the pressure p with

    gap = C p − h − offset >= 0,    p >= 0,    gap p = 0,    <p> = mean pressure,

C = 1/K(q) the compliance of the solid. On a trial contact set A solve C_AA p = h + offset at the given mean;
points of A that pull leave it, points outside that penetrate enter, both judged on the same solved state
(M. Hintermüller, K. Ito & K. Kunisch, SIAM J. Optim. 13, 865 (2002)). K = C⁻¹ is nearly an M-matrix, for which that
iteration is monotone; judging one change after the other can cycle on surfaces rough at the scale of a point.

Each linear solve is a few iterations of conjugate gradients in single precision for a *correction* of p; the residual
is computed in double precision every time, so that rounding does not accumulate. The preconditioner is K between a
smooth extension from the contact set and its transpose (:mod:`bem_adhesion.hard_wall.preconditioner`).
"""

import numpy as np

from bem_adhesion.hard_wall import kernels
from bem_adhesion.hard_wall.options import ActiveSetOptions
from bem_adhesion.hard_wall.preconditioner import Extension
from bem_adhesion.operators.fourier import MakeOperator, Operator
from bem_adhesion.solution import Outcome
from contact_study.numerics.grid import Grid


class ContactLevel:
    """The contact problem on one grid and, below it, on every second point of that grid.

    Units: rms height for heights and gaps, longest period along the surface, E* rms height / period for pressures.
    Heights of minus infinity are points without a surface.
    """

    def __init__(
        self, heights: np.ndarray, grid: Grid, make_operator: MakeOperator, options: ActiveSetOptions | None = None
    ):
        self.heights = heights
        self.grid = grid
        self.options = options or ActiveSetOptions()
        self._make_operator = make_operator
        self._double = make_operator(grid, np.float64)
        self._single = make_operator(grid, np.float32)
        self.contact = np.ones(grid.shape, bool)
        self.pressure = np.empty(grid.shape)
        self._extension = Extension(self.contact)
        self._residual = np.empty(grid.shape, np.float32)
        self._direction = np.empty(grid.shape, np.float32)
        self._pairs_below = 0.0
        present = np.isfinite(heights)
        self._absent = None if present.all() else ~present  # a periodic surface needs no memory for it
        self._largest_height = max(float(heights.max()), -float(heights.min(where=present, initial=0.0)))

    @property
    def single(self) -> Operator:
        """The solid in single precision."""
        return self._single

    def equivalent_pairs(self, grid: Grid) -> float:
        """Return the transform pairs so far on this level and below, as float64 pairs on ``grid``."""
        here = self._double.equivalent_pairs(grid) + self._single.equivalent_pairs(grid)
        return here + self._pairs_below * self.grid.points / grid.points

    def start(self, mean_pressure: float, max_iterations: int) -> bool:
        """Compute a first pressure on coarser levels; return whether it is full contact, hence the solution.

        The coarser levels are made again each time: keeping them would cost a third more memory.
        """
        rows, columns = self.grid.shape
        if rows % 2 or columns % 2 or min(rows, columns) < 2 * self.options.coarsest:
            return self.start_from_full_contact(mean_pressure)
        coarser = self._coarser(np.ascontiguousarray(self.heights[::2, ::2]))
        full_contact = coarser.start(mean_pressure, max_iterations)
        if not full_contact:
            coarser.solve(mean_pressure, self.options.coarse_tolerance, max_iterations)
            self.start_from(coarser.refine(), mean_pressure)
        self._pairs_below += coarser.equivalent_pairs(self.grid)
        return full_contact and self.start_from_full_contact(mean_pressure)

    def _coarser(self, heights: np.ndarray) -> "ContactLevel":
        """Return the same problem on a coarser grid."""
        grid = self.grid.with_shape((heights.shape[0], heights.shape[1]))
        return ContactLevel(heights, grid, self._make_operator, self.options)

    def start_from_full_contact(self, mean_pressure: float) -> bool:
        """Start from the pressure of full contact cut off at zero; return whether this is already the solution."""
        whole = self._absent is None
        self._double.field[...] = self.heights if whole else np.maximum(self.heights, -self._largest_height)
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

    def solve(self, mean_pressure: float, tolerance: float, max_iterations: int) -> tuple[float, int, Outcome]:
        """Solve from the present pressure; return residual, iterations and outcome."""
        heights, contact = self.heights.reshape(-1), self.contact.reshape(-1)
        residual = self._residual.reshape(-1)
        rounding = 4 * np.finfo(float).eps * self._largest_height
        threshold = max(0.3 * tolerance, rounding)
        # A guess is solved on its own contact set first: the gap of a pressure that was interpolated and cut off at
        # zero does not show which points should enter.
        entered, deepest = 1, 0.0
        previous = np.inf
        iteration = 0
        while True:
            iteration += 1
            self._double.field[...] = self.pressure
            displacement = self._double.apply(self._double.compliance).reshape(-1)
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
        change = self._single.field
        pressure = self.pressure.reshape(-1)
        left, total = kernels.leave(pressure, self.contact.reshape(-1), change.reshape(-1))
        factor = mean_pressure * self.grid.points / total
        if left:
            kernels.rescale(pressure, factor, change.reshape(-1))
            self._double.field += self._single.apply(self._single.compliance)
        else:  # single precision lets the load drift in its last digits
            self.pressure *= factor
            self._double.field *= factor
        return left

    def _correct(self, largest: float, floor: float) -> None:
        """Close the gap of the contact set at the same load by conjugate gradients for the pressure."""
        buffer = self._single.field
        flat = buffer.reshape(-1)
        contact, pressure = self.contact.reshape(-1), self.pressure.reshape(-1)
        residual, direction = self._residual.reshape(-1), self._direction.reshape(-1)
        target = max(self.options.reduction * largest, floor)
        self._single.mark("extension")
        self._extension.update()
        self._single.mark("points")
        direction[...] = 0
        previous = np.inf
        for _ in range(self.options.inner_iterations):
            if largest <= target:
                return
            self._single.mark("extension")
            self._extension.extend(self._residual, buffer)
            self._single.apply(self._single.stiffness)
            self._single.mark("extension")
            self._extension.transpose(buffer)
            self._single.mark("points")
            mean, product = kernels.products(flat, residual, contact)
            kernels.turn(flat, mean, product / previous, contact, direction)
            previous = product
            response = self._single.apply(self._single.compliance).reshape(-1)
            largest = kernels.advance(pressure, residual, direction, response, contact, product)

    def exceeds_bound(self) -> bool:
        """Return whether the present pressure exceeds a bound somewhere; never, without a bound."""
        return False

    def indentation(self) -> np.ndarray | None:
        """Return the plastic indentation of each point; None without any."""
        return None

    def surface(self) -> np.ndarray:
        """Return the position of the solid's surface at the end of :meth:`solve`."""
        displacement = self._double.field
        return displacement - np.mean((displacement - self.heights)[self.contact])

    def gap(self) -> np.ndarray:
        """Return the gap at the end of :meth:`solve`: zero in contact, infinite without a surface."""
        gap = self._double.field - self.heights
        gap -= gap[self.contact].mean()
        gap[self.contact] = 0
        return np.maximum(gap, 0, out=gap)

    def refine(self) -> np.ndarray:
        """Return the pressure for the grid of twice as many points along each side, negative out of contact.

        The gap enters as the tension that would close it over one spacing, so that the edge of contact is between the
        points.
        """
        # A wave of two spacings along an axis is √2 less stiff than the one along the diagonal.
        signed = np.where(self.contact, self.pressure, -self._single.largest / np.sqrt(2) * self.gap())
        refined = np.empty((2 * self.grid.shape[0], 2 * self.grid.shape[1]))
        kernels.refine(signed, refined)
        return refined
