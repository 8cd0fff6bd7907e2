"""The linearised contact: conjugate gradients for (K + D) x = r with a preconditioner split into core and tail.

K is the solid, D = φ'' the law's curvature: large where surfaces repel (the core), small and often negative where they
attract (the tail). z = (1 − b²) / (D⁺ + ½ K_max) r + b (K + c)⁻¹ b r inverts D in the core and K in the tail with one
pair of transforms, b² = c / (D⁺ + c). All arrays are in float32.
"""

from functools import partial
from typing import NamedTuple

import numpy as np

from bem_adhesion.operators import MakeOperator, PeriodicOperator
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.numerics.kernel import inner_product, kernel
from contact_study.numerics.memory import Memory
from contact_study.numerics.multigrid import HALVINGS, HalvedInverse, Inverse, can_be_halved

# Rounding of float32: below this fraction of its terms the energy of a direction is negative.
CURVATURE_ROUNDING = 1e-7
UNIFORM = 1e-6  # rounding of a uniform field by transforms in float32, over the field
STIFFNESS_REDUCTION, STIFFNESS_ITERATIONS = 1e-4, 400  # of a contact stiffness


def typical_wavenumber(height: np.ndarray, grid: Grid) -> float:
    """Return rms slope over rms height, at least the longest wave's wavenumber (1/m), whatever the size: for c."""
    power = grid.variances(fourier.transform(height))
    variance = power.sum() or np.inf
    return max(2 * np.pi / max(grid.size), float(np.sqrt(np.sum(grid.wavenumber**2 * power) / variance)))


class FourierPreconditioner:
    """The inverse by the transforms of an operator, with the shift c (Pa/m)."""

    def __init__(self, operator: PeriodicOperator, shift: float):
        self.field = operator.field
        self.apply_and_sum = partial(operator.apply_and_sum, operator.inverse_shifted(shift))


def preconditioner_for(
    operator: PeriodicOperator, make: MakeOperator, shift: float, short_waves: float, halvings: int = HALVINGS
) -> Inverse:
    """Return the inverse on an operator in float32: only waves longer than a few points need K, by coarser grids."""
    if not (halvings and can_be_halved(operator.grid.shape)):
        return FourierPreconditioner(operator, shift)
    coarse = make(operator.grid.halved, np.float32)
    inverse = preconditioner_for(coarse, make, shift, short_waves, halvings - 1)
    return HalvedInverse(operator.field, inverse, operator.largest, short_waves)


@kernel
def _begin(right_side, curvature, shift, grid, residual, direction, solution, buffer):
    """Start from zero: residual = right side, buffer = b·residual; return Σ residual² and the core part of Σ r z."""
    square = core_product = 0.0
    zero = right_side.dtype.type(0)
    one = right_side.dtype.type(1)
    for i in range(right_side.shape[0]):
        row = core_row = zero
        for j in range(right_side.shape[1]):
            r = right_side[i, j]
            d = max(curvature[i, j], zero)
            tail = shift / (d + shift)
            residual[i, j] = r
            direction[i, j] = zero
            solution[i, j] = zero
            buffer[i, j] = np.sqrt(tail) * r
            row += r * r
            core_row += (one - tail) / (d + grid) * r * r
        square += row
        core_product += core_row
    return square, core_product


@kernel
def _direct(curvature, residual, shift, grid, softening, beta, direction, buffer):
    """Write the new direction s = z + β s, also into the buffer; return Σ D s² and Σ s²."""
    product = square = 0.0
    zero = residual.dtype.type(0)
    one = residual.dtype.type(1)
    for i in range(residual.shape[0]):
        row = square_row = zero
        for j in range(residual.shape[1]):
            d = curvature[i, j]
            positive = max(d, zero)
            negative = min(d, zero)
            tail = shift / (positive + shift)
            z = (one - tail) / (positive + grid) * residual[i, j] + np.sqrt(tail) * buffer[i, j]
            s = z + beta * direction[i, j]
            direction[i, j] = s
            buffer[i, j] = s
            row += (positive + softening * negative) * s * s
            square_row += s * s
        product += row
        square += square_row
    return product, square


@kernel
def _descend(curvature, shift, grid, softening, alpha, direction, solution, residual, buffer):
    """Step x += α s, r −= α (K + D) s; return Σ r² and the core part of Σ r z."""
    square = core_product = 0.0
    zero = residual.dtype.type(0)
    one = residual.dtype.type(1)
    for i in range(residual.shape[0]):
        row = core_row = zero
        for j in range(residual.shape[1]):
            d = curvature[i, j]
            positive = max(d, zero)
            negative = min(d, zero)
            s = direction[i, j]
            solution[i, j] += alpha * s
            r = residual[i, j] - alpha * (buffer[i, j] + (positive + softening * negative) * s)  # of K s
            residual[i, j] = r
            tail = shift / (positive + shift)
            buffer[i, j] = np.sqrt(tail) * r
            row += r * r
            core_row += (one - tail) / (positive + grid) * r * r
        square += row
        core_product += core_row
    return square, core_product


@kernel
def _uniform_response(curvature, shift, grid, response, out):
    """Write M⁻¹ 1 from its part in the tail, b·``response``; return its sum."""
    total = 0.0
    zero = response.dtype.type(0)
    one = response.dtype.type(1)
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            positive = max(curvature[i, j], zero)
            tail = shift / (positive + shift)
            out[i, j] = (one - tail) / (positive + grid) + np.sqrt(tail) * response[i, j]
            total += out[i, j]
    return total


@kernel
def _project(uniform_response, response, whole, residual, buffer):
    """Subtract the uniform stress from r that leaves M⁻¹ r without mean; return it, and the change of Σ r z."""
    total = 0.0
    for i in range(residual.shape[0]):
        for j in range(residual.shape[1]):
            total += uniform_response[i, j] * residual[i, j]
    stress = total / whole
    uniform = response.dtype.type(stress)
    for i in range(residual.shape[0]):
        for j in range(residual.shape[1]):
            residual[i, j] -= uniform
            buffer[i, j] -= uniform * response[i, j]
    return stress, -total * stress


class LinearResult(NamedTuple):
    """Iterations of a linear solve, whether it stopped at negative curvature, and the stress that holds a mean."""

    iterations: int
    negative_curvature: bool
    stress: float = 0.0


def _without_mean(square: float, residual: np.ndarray) -> float:
    """Return Σ (r − <r>)² by Σ r²."""
    return max(square - float(residual.sum(dtype=float)) ** 2 / residual.size, 0.0)


class LinearisedContact:
    """Linear solver on one grid for a shift c (Pa/m): the ``solution`` (m) is in memory ``idle`` between two solves."""

    def __init__(
        self, operator: PeriodicOperator, shift: float, inverse: Inverse | None = None, memory: Memory | None = None
    ):
        self.operator = operator
        self._shift = np.float32(shift)
        self._grid = np.float32(0.5 * operator.largest)
        self._preconditioner = inverse or FourierPreconditioner(operator, shift)
        arrays = (memory or Memory()).array((3, *operator.grid.shape), np.float32)
        self._residual, self.direction, self.solution = arrays
        self.idle = arrays.reshape(-1).view(np.uint8)

    def solve(
        self,
        right_side: np.ndarray,
        curvature: np.ndarray,
        softening: float,
        reduction: float,
        iterations: int,
        total: float = np.inf,
        mean: float | None = None,
    ) -> LinearResult:
        """Solve (K + D⁺ + softening·D⁻) x = right side: |residual| <= reduction·|right side|, |Σ residual| <= total.

        A given ``mean`` of x is held by a uniform stress: the preconditioned residuals have none (N. I. M. Gould,
        M. E. Hribar and J. Nocedal, SIAM J. Sci. Comput. 23 (4), 2001).
        """
        operator, buffer = self.operator, self.operator.field
        weights = self._shift, self._grid
        kept = np.float32(softening)
        residual, direction, solution = self._residual, self.direction, self.solution
        stress = 0.0
        if mean is not None:
            response, uniform_response, whole = self._respond(curvature)
        if mean:
            scale = np.float32(mean / whole * uniform_response.size)
            right_side = self._left_by(scale * uniform_response, right_side, curvature, kept)
        square, core_product = _begin(right_side, curvature, *weights, residual, direction, solution, buffer)
        if mean:
            solution += scale * uniform_response
        target = reduction**2 * square
        if mean is not None:
            bending = _without_mean(square, residual)
            target = max(reduction**2 * bending, UNIFORM**2 * square)
            if bending <= UNIFORM**2 * square:
                return LinearResult(0, False, float(residual.mean(dtype=float)))
        previous = np.inf
        for iteration in range(1, iterations + 1):
            product = core_product + self._preconditioner.apply_and_sum()
            if mean is not None:
                uniform, change = _project(uniform_response, response, whole, residual, buffer)
                stress, product = stress + uniform, product + change
            beta = np.float32(product / previous)
            local, length = _direct(curvature, residual, *weights, kept, beta, direction, buffer)
            elastic = operator.apply_and_sum(operator.stiffness)
            energy = local + elastic
            if energy <= CURVATURE_ROUNDING * length and energy <= self._rounding(curvature, kept, elastic, length):
                return LinearResult(iteration, True, stress)
            alpha = np.float32(product / energy)
            square, core_product = _descend(curvature, *weights, kept, alpha, direction, solution, residual, buffer)
            previous = product
            square = square if mean is None else _without_mean(square, residual)
            if square <= target and (np.isinf(total) or abs(residual.sum(dtype=float)) <= total):
                break
        if mean is not None:
            stress += float(residual.mean(dtype=float))
        return LinearResult(iteration, False, stress)

    def _respond(self, curvature: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        """Return the part of M⁻¹ 1 in the tail without its factor b, M⁻¹ 1, and the sum of that."""
        buffer, weights = self.operator.field, (self._shift, self._grid)
        self.solution[...] = 1
        _begin(self.solution, curvature, *weights, self._residual, self.direction, self.direction, buffer)
        self._preconditioner.apply_and_sum()
        response, uniform_response = buffer.copy(), np.empty_like(buffer)
        return response, uniform_response, _uniform_response(curvature, *weights, response, uniform_response)

    def _left_by(
        self, moved: np.ndarray, right_side: np.ndarray, curvature: np.ndarray, softening: np.float32
    ) -> np.ndarray:
        """Return what a displacement leaves of the right side."""
        self.operator.field[...] = moved
        left = right_side - self.operator.apply(self.operator.stiffness)
        left -= np.where(curvature < 0, softening * curvature, curvature) * moved
        return left

    def _rounding(self, curvature: np.ndarray, softening: np.float32, elastic: float, length: float) -> float:
        """Return the rounding of the energy of the direction s with <s, K s> = ``elastic`` and |s|² = ``length``."""
        softened = np.abs(np.where(curvature < 0, softening * curvature, curvature))
        local = inner_product(softened * self.direction, self.direction)
        # K of a field that is nearly uniform is itself rounding.
        return CURVATURE_ROUNDING * (local + elastic + CURVATURE_ROUNDING * self.operator.largest * length)

    def mean_stiffness(self, curvature: np.ndarray, held: np.ndarray) -> float:
        """Return −dp/dū = <x, (K + φ'') x> / <x>² (Pa/m): zero without a force, infinite if held, NaN at a fold.

        Free points follow (K + φ'') x = −dp, from the rigid displacement; the error is the square of that of x.
        """
        if held.all():
            return np.inf
        if not held.any() and not curvature.any():
            return 0.0
        local = np.where(held, np.float32(0), curvature)
        displacement = (~held).astype(float)
        right_side = -(self._flexure(displacement) + local)
        right_side -= right_side.mean(where=~held, dtype=float)
        right_side[held] = 0
        largest = float(np.abs(right_side).max())
        if largest > 0:
            # At unit size: squares of a very small tail underflow in single precision.
            unit = right_side / np.float32(largest)
            result = self.solve(unit, curvature, 1.0, STIFFNESS_REDUCTION, STIFFNESS_ITERATIONS)
            if result.negative_curvature or result.iterations == STIFFNESS_ITERATIONS:
                return np.nan
            displacement += np.where(held, 0, largest * self.solution.astype(float))
        bent, flexure = displacement - displacement.mean(), self._flexure(displacement)
        energy = inner_product(bent, flexure) + inner_product(displacement, local * displacement)
        return float(energy / displacement.size / displacement.mean() ** 2)

    def _flexure(self, displacement: np.ndarray) -> np.ndarray:
        """Return K x without a spring on the mean; its rounding is that of the bending part of x."""
        self.operator.field[...] = displacement - displacement.mean()
        return self.operator.apply(self.operator.stiffness)
