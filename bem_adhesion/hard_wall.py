"""Contact of an elastic half-space with a rigid rough solid that neither adheres nor gives way.

Find the pressure p with

    gap = C p − h − offset >= 0,    p >= 0,    gap p = 0,    <p> = mean pressure,

C = 2/(E* q) the compliance of the half-space. The contact set is found by a primal-dual active set (M. Hintermüller,
K. Ito & K. Kunisch, SIAM J. Optim. 13, 865 (2002)): on a trial set A solve C_AA p = h + offset with the given mean,
drop points that pull, add points that penetrate, repeat. Each linear solve is a few iterations of conjugate
gradients in single precision for a *correction* of p; the residual is taken afresh in double precision every time,
so that rounding does not accumulate. The preconditioner is the stiffness K = C⁻¹ of the whole surface between a
smooth extension from the contact set and its transpose (:mod:`bem_adhesion.extension`): the number of iterations
depends neither on the grid nor, from one point to full contact, much on the contact area.

The first guess comes from the same problem on every second point, recursively.
"""

from dataclasses import replace

import numpy as np
from numba import njit
from scipy.optimize import brentq

from bem_adhesion.elasticity import HalfSpace
from bem_adhesion.extension import Extension
from bem_adhesion.solution import Outcome, Solution
from contact_study.fields.grid import Grid

COARSEST = 32
"""Grids are halved down to this many points along the shorter side; fewer points would save nothing."""

COARSE_TOLERANCE = 1e-2
"""Residual on all grids but the finest: the discretisation error of a coarse grid makes more of it a waste."""

REDUCTION = 0.03
"""Factor by which conjugate gradients reduce the residual before the contact set is looked at again."""

INNER_ITERATIONS = 15
"""Limit of conjugate gradients on one contact set; about twice of what the reduction takes."""

_FAST = {"contract", "reassoc", "arcp", "nsz"}


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _offset(displacement, heights, contact):
    """Mean of displacement − heights over the contact set."""
    total = 0.0
    count = 0
    for i in range(contact.size):
        if contact[i]:
            total += displacement[i] - heights[i]
            count += 1
    return total / count


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _enter(displacement, heights, offset, threshold, contact):
    """Let points that penetrate by more than ``threshold`` enter the contact set; how many, and the deepest other."""
    entered = 0
    deepest = 0.0
    for i in range(contact.size):
        if not contact[i]:
            depth = heights[i] + offset - displacement[i]
            if depth > threshold:
                contact[i] = True
                entered += 1
            elif depth > deepest:
                deepest = depth
    return entered, deepest


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _residual(displacement, heights, offset, contact, residual):
    """Negative gap on the contact set, zero elsewhere; returns its largest magnitude."""
    largest = 0.0
    for i in range(contact.size):
        if contact[i]:
            depth = heights[i] + offset - displacement[i]
            residual[i] = depth
            if not abs(depth) <= largest:  # also when it is not a number
                largest = abs(depth)
        else:
            residual[i] = 0
    return largest


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _products(preconditioned, residual, contact):
    """Mean of the preconditioned residual over the contact set, and its product with the residual."""
    total = 0.0
    product = 0.0
    count = 0
    for i in range(contact.size):
        if contact[i]:
            total += preconditioned[i]
            product += preconditioned[i] * residual[i]
            count += 1
    return total / count, product


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _turn(preconditioned, mean, weight, contact, direction):
    """direction = preconditioned − mean + weight direction on the contact set, copied over the first argument."""
    shift = np.float32(mean)
    factor = np.float32(weight)
    for i in range(contact.size):
        if contact[i]:
            direction[i] = preconditioned[i] - shift + factor * direction[i]
        else:
            direction[i] = 0
        preconditioned[i] = direction[i]


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _advance(pressure, residual, direction, response, contact, product):
    """One step along ``direction``, whose displacement is ``response``; returns the largest residual left."""
    curvature = 0.0
    total = 0.0
    count = 0
    for i in range(contact.size):
        if contact[i]:
            curvature += direction[i] * response[i]
            total += response[i]
            count += 1
    length = product / curvature
    factor = np.float32(length)
    mean = np.float32(total / count)
    largest = np.float32(0)
    for i in range(contact.size):
        if contact[i]:
            pressure[i] += length * direction[i]
            residual[i] -= factor * (response[i] - mean)
            largest = max(largest, abs(residual[i]))
    return largest


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _leave(pressure, contact, change):
    """Let points that pull leave the contact set, note the change; how many, and the sum of the pressures left."""
    left = 0
    total = 0.0
    for i in range(contact.size):
        if pressure[i] < 0:
            change[i] = -pressure[i]
            pressure[i] = 0
            contact[i] = False
            left += 1
        else:
            change[i] = 0
        total += pressure[i]
    return left, total


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _rescale(pressure, factor, change):
    """Multiply the pressure by a factor and add what that changes to ``change``."""
    for i in range(pressure.size):
        change[i] += (factor - 1.0) * pressure[i]
        pressure[i] *= factor


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def _refine(signed, refined):
    """Bilinear interpolation to a periodic grid of twice as many points along each side."""
    rows, columns = signed.shape
    for i in range(rows):
        below = (i + 1) % rows
        for j in range(columns):
            right = (j + 1) % columns
            refined[2 * i, 2 * j] = signed[i, j]
            refined[2 * i, 2 * j + 1] = 0.5 * (signed[i, j] + signed[i, right])
            refined[2 * i + 1, 2 * j] = 0.5 * (signed[i, j] + signed[below, j])
            refined[2 * i + 1, 2 * j + 1] = 0.25 * (
                signed[i, j] + signed[i, right] + signed[below, j] + signed[below, right]
            )


class _Level:
    """The contact problem on one grid, in units of its own: rms height, longest period, and E* between them."""

    def __init__(self, heights: np.ndarray, grid: Grid, threads: int):
        self.heights = heights
        self.grid = grid
        self._double = HalfSpace(grid, 1.0, np.float64, threads=threads)
        self._single = HalfSpace(grid, 1.0, np.float32, threads=threads)
        self.contact = np.ones(grid.shape, bool)
        self.pressure = np.zeros(grid.shape)
        self._extension = Extension(self.contact)
        self._residual = np.empty(grid.shape, np.float32)
        self._direction = np.empty(grid.shape, np.float32)

    def equivalent_pairs(self, grid: Grid) -> float:
        """Work done so far, see :meth:`HalfSpace.equivalent_pairs`."""
        return self._double.equivalent_pairs(grid) + self._single.equivalent_pairs(grid)

    def start_from_full_contact(self, mean_pressure: float) -> bool:
        """Take the pressure of full contact without its tension; whether there was none, which solves the problem."""
        self._double.field[...] = self.heights
        np.add(self._double.stiffness(), mean_pressure, out=self.pressure)
        if self.pressure.min() >= 0:
            return True
        self.start_from(self.pressure, mean_pressure)
        return False

    def least_full_contact_pressure(self) -> float:
        """The smallest mean pressure of full contact."""
        self._double.field[...] = self.heights
        return -float(self._double.stiffness().min())

    def start_from(self, pressure: np.ndarray, mean_pressure: float) -> None:
        """Take the positive part of a pressure field, brought to the mean pressure."""
        np.maximum(pressure, 0, out=self.pressure)
        np.greater(self.pressure, 0, out=self.contact)
        self.pressure *= mean_pressure / self.pressure.mean()

    def solve(self, mean_pressure: float, tolerance: float, max_iterations: int) -> tuple[float, int, Outcome]:
        """Primal-dual active set from the present pressure; residual, iterations, outcome."""
        heights, contact, pressure = (a.reshape(-1) for a in (self.heights, self.contact, self.pressure))
        residual = self._residual.reshape(-1)
        threshold = 0.3 * tolerance
        # A guess is solved on its own contact set first: the gap that goes with a pressure that was interpolated and
        # cut off at zero says little about which points should enter.
        entered, deepest = 1, 0.0
        previous = np.inf
        iteration = 0
        while True:
            iteration += 1
            self._double.field[...] = self.pressure
            displacement = self._double.compliance().reshape(-1)
            if iteration > 1:
                offset = _offset(displacement, heights, contact)
                entered, deepest = _enter(displacement, heights, offset, threshold, contact)
            left = self._drop_tension(mean_pressure)
            offset = _offset(displacement, heights, contact)
            largest = _residual(displacement, heights, offset, contact, residual)
            error = max(largest, deepest)
            if not entered and not left and largest <= tolerance:
                return error, iteration, Outcome.CONVERGED
            if not entered and not left and not largest < 0.5 * previous:
                return error, iteration, Outcome.STALLED
            if iteration == max_iterations:
                return error, iteration, Outcome.ITERATION_LIMIT
            previous = largest
            self._correct(largest, threshold)

    def _drop_tension(self, mean_pressure: float) -> int:
        """Let points that pull leave the contact set, keep the load, and update the displacement; how many left."""
        change = self._single.field
        pressure = self.pressure.reshape(-1)
        left, total = _leave(pressure, self.contact.reshape(-1), change.reshape(-1))
        if left:
            factor = mean_pressure * self.grid.points / total
            _rescale(pressure, factor, change.reshape(-1))
            self._double.field += self._single.compliance()
        return left

    def _correct(self, largest: float, floor: float) -> None:
        """Conjugate gradients for the pressure that closes the gap of the contact set without changing the load."""
        buffer = self._single.field
        flat = buffer.reshape(-1)
        contact, pressure = self.contact.reshape(-1), self.pressure.reshape(-1)
        residual, direction = self._residual.reshape(-1), self._direction.reshape(-1)
        target = max(REDUCTION * largest, floor)
        self._extension.update()
        direction[...] = 0
        previous = np.inf
        for _ in range(INNER_ITERATIONS):
            if largest <= target:
                return
            self._extension.extend(self._residual, buffer)
            self._single.stiffness()
            self._extension.transpose(buffer)
            mean, product = _products(flat, residual, contact)
            _turn(flat, mean, product / previous, contact, direction)
            previous = product
            response = self._single.compliance().reshape(-1)
            largest = _advance(pressure, residual, direction, response, contact, product)

    def gap(self) -> np.ndarray:
        """Gap of the state that :meth:`solve` ended with; zero in contact."""
        gap = self._double.field - self.heights
        gap -= gap[self.contact].mean()
        gap[self.contact] = 0
        return np.maximum(gap, 0, out=gap)

    def refined(self) -> np.ndarray:
        """Pressure for the grid of twice as many points along each side, negative out of contact.

        There the gap is expressed as the tension that would close it over one spacing, so that the edge of contact
        is placed between the points.
        """
        stiffness = 0.5 * np.pi / max(self.grid.spacing)
        signed = np.where(self.contact, self.pressure, -stiffness * self.gap())
        refined = np.empty((2 * self.grid.shape[0], 2 * self.grid.shape[1]))
        _refine(signed, refined)
        return refined


class HardWallContact:
    """One rough surface against a half-space, to be solved at any number of loads.

    Parameters
    ----------
    height : numpy.ndarray, shape grid.shape
        Heights of the rigid surface, toward the block (m); their mean is of no consequence.
    grid : Grid
        The periodic grid; any shape. Shapes that can be halved converge in half the time.
    contact_modulus : float
        E* = E / (1 − ν²) (Pa).
    threads : int, optional
        Threads of the transforms.

    Raises
    ------
    ValueError
        If a height is not finite, the shapes differ, or the modulus is not positive.
    """

    def __init__(self, height: np.ndarray, grid: Grid, contact_modulus: float, threads: int = 1):
        if height.shape != grid.shape:
            raise ValueError(f"height has shape {height.shape}, the grid {grid.shape}")
        if not np.all(np.isfinite(height)):
            raise ValueError("height is not finite everywhere")
        if not (np.isfinite(contact_modulus) and contact_modulus > 0):
            raise ValueError(f"contact_modulus = {contact_modulus:g} Pa: must be positive")
        self.grid = grid
        self.contact_modulus = contact_modulus
        self._threads = threads
        self._height = height
        mean_free = height - height.mean()
        self._mean_height = float(height.mean())
        self._rms_height = float(np.sqrt(np.mean(mean_free**2)))
        self._flat = self._rms_height <= np.finfo(float).eps * np.abs(height).max()
        if not self._flat:
            period = max(grid.size)
            self._pressure_unit = contact_modulus * self._rms_height / period
            unit_grid = Grid(grid.shape, (grid.size[0] / period, grid.size[1] / period))
            mean_free /= self._rms_height
            self._level = _Level(mean_free, unit_grid, threads)

    def at_pressure(
        self,
        mean_pressure: float,
        tolerance: float = 1e-10,
        initial: np.ndarray | None = None,
        max_iterations: int = 200,
    ) -> Solution:
        """The contact under a mean pressure; parameters, result and errors as in :func:`solve`."""
        if not np.isfinite(mean_pressure):
            raise ValueError(f"mean_pressure = {mean_pressure:g} Pa: must be finite")
        if mean_pressure < 0:
            raise ValueError(
                f"mean_pressure = {mean_pressure:g} Pa: a hard wall without adhesion carries no tension"
            )
        if not tolerance > 0:
            raise ValueError(f"tolerance = {tolerance:g}: must be positive")
        if initial is not None and initial.shape != self.grid.shape:
            raise ValueError(f"initial has shape {initial.shape}, the grid {self.grid.shape}")
        if self._flat:
            return self._solution(np.full(self.grid.shape, mean_pressure), np.zeros(self.grid.shape))
        if mean_pressure == 0:
            return self._solution(np.zeros(self.grid.shape), self._height.max() - self._height)
        level, load = self._level, mean_pressure / self._pressure_unit
        before = level.equivalent_pairs(level.grid)
        coarse_pairs = 0.0
        full = False
        if initial is not None and initial.max() > 0:
            level.start_from(initial, load)
        else:
            full, coarse_pairs = _start_from_coarser(level, load, max_iterations, self._threads)
        pressure = level.pressure * self._pressure_unit
        if full:
            gap = np.zeros(self.grid.shape)
            residual, iterations, outcome = 0.0, 0, Outcome.CONVERGED
        else:
            residual, iterations, outcome = level.solve(load, tolerance, max_iterations)
            np.multiply(level.pressure, self._pressure_unit, out=pressure)
            gap = level.gap()
            gap *= self._rms_height
        pairs = coarse_pairs + level.equivalent_pairs(level.grid) - before
        return self._solution(pressure, gap, residual, iterations, pairs, outcome)

    def at_gap(
        self,
        mean_gap: float,
        tolerance: float = 1e-10,
        initial: np.ndarray | None = None,
        max_iterations: int = 200,
    ) -> Solution:
        """The contact at a mean gap, found as the pressure that leaves it.

        Parameters
        ----------
        mean_gap : float
            Mean separation of the surfaces, >= 0 (m). Above the gap of first touch there is no contact, at zero
            the pressure is the least of full contact.
        tolerance, initial, max_iterations
            As in :func:`solve`; the mean gap is met to ``tolerance`` of the rms height.

        Raises
        ------
        ValueError
            If the gap is negative or not finite.
        """
        if not (np.isfinite(mean_gap) and mean_gap >= 0):
            raise ValueError(f"mean_gap = {mean_gap:g} m: must be zero or positive")
        touch = self._height.max() - self._mean_height
        if self._flat or mean_gap >= touch:
            lowest_gap = mean_gap - touch
            return self._solution(np.zeros(self.grid.shape), lowest_gap + self._height.max() - self._height)
        least_full = self._level.least_full_contact_pressure() * self._pressure_unit
        if mean_gap == 0:
            return self.at_pressure(least_full * (1 + 1e-12), tolerance)
        found = None
        pairs = 0.0

        def excess(log_pressure: float) -> float:
            nonlocal found, pairs, initial
            found = self.at_pressure(np.exp(log_pressure), tolerance, initial, max_iterations)
            initial = found.pressure
            pairs += found.fft_pairs
            difference = float(found.gap.mean()) - mean_gap
            return 0.0 if abs(difference) <= tolerance * self._rms_height else difference

        high = np.log(least_full)
        low = high - mean_gap / self._rms_height
        while excess(low) < 0:
            high, low = low, low - 2.0
        brentq(excess, low, high, xtol=1e-15, rtol=1e-14)
        return replace(found, fft_pairs=pairs)

    def _solution(self, pressure, gap, residual=0.0, iterations=0, pairs=0.0, outcome=Outcome.CONVERGED) -> Solution:
        displacement = self._height + gap
        elastic_energy = 0.5 * np.mean(pressure * displacement) - 0.5 * np.mean(pressure) * np.mean(displacement)
        return Solution(
            displacement, gap, pressure, float(elastic_energy), 0.0, residual, iterations, pairs, outcome
        )


def _start_from_coarser(level: _Level, load: float, max_iterations: int, threads: int) -> tuple[bool, float]:
    """Give a level its first pressure from coarser ones; whether it is full contact, and the work on coarser grids."""
    rows, columns = level.grid.shape
    if rows % 2 or columns % 2 or min(rows, columns) < 2 * COARSEST:
        return level.start_from_full_contact(load), 0.0
    coarser = _Level(
        np.ascontiguousarray(level.heights[::2, ::2]), level.grid.with_shape((rows // 2, columns // 2)), threads
    )
    full, pairs = _start_from_coarser(coarser, load, max_iterations, threads)
    if full:
        full = level.start_from_full_contact(load)
    else:
        coarser.solve(load, COARSE_TOLERANCE, max_iterations)
        level.start_from(coarser.refined(), load)
    return full, pairs / 4 + coarser.equivalent_pairs(level.grid)


def solve(
    height: np.ndarray,
    grid: Grid,
    contact_modulus: float,
    mean_pressure: float,
    tolerance: float = 1e-10,
    initial: np.ndarray | None = None,
    max_iterations: int = 200,
    threads: int = 1,
) -> Solution:
    """Contact of a rough surface with a half-space under a mean pressure.

    Parameters
    ----------
    height, grid, contact_modulus, threads
        As in :class:`HardWallContact`.
    mean_pressure : float
        Force per nominal area, >= 0 (Pa).
    tolerance : float, optional
        Largest gap inside the contact and largest penetration outside, in units of the rms height.
    initial : numpy.ndarray, shape grid.shape, optional
        Pressure of a similar state to start from (Pa), in place of the coarser grids.
    max_iterations : int, optional
        Limit of active-set iterations on each grid.

    Returns
    -------
    Solution
        ``residual`` is what ``tolerance`` bounds. Contact is where the pressure is positive; the gap there is zero.

    Raises
    ------
    ValueError
        If the mean pressure is negative or a number is not finite; also as :class:`HardWallContact`.
    """
    return HardWallContact(height, grid, contact_modulus, threads).at_pressure(
        mean_pressure, tolerance, initial, max_iterations
    )
