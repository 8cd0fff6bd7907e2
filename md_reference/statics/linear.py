"""The linear problem of one Newton step: conjugate gradients with a preconditioner split into core and tail.

Solve (S + D) x = −g, S the block's surface stiffness and D one 3×3 matrix per atom: large along the normal n where
atoms touch (the core), small everywhere else (the tail). With k = n·Dn, β² = c/(k + c) and B = 1 − (1 − β) n nᵀ,

    z = (1 − β²)/(k + ½ S_max) n nᵀ r + B (S + c)⁻¹ B r

inverts D in the core and S in the tail, long waves on coarser layers (:mod:`contact_study.numerics.multigrid`). Single
precision on a right-hand side scaled to one suffices: the Newton method's residual is evaluated in double precision.
"""

from typing import NamedTuple

import numpy as np

from contact_study.numerics.fourier import RealTransform
from contact_study.numerics.grid import Grid
from contact_study.numerics.kernel import inner_product, kernel
from contact_study.numerics.multigrid import HALVINGS, HalvedInverse, Inverse, can_be_halved
from md_reference.block.condensed import SurfaceStiffness
from md_reference.block.spectral import invert, multiply
from md_reference.statics.atomwise import split

_NEGLIGIBLE = 0.1  # curvature over c that is left to the tail
# Energy of a direction s below this fraction of the sum's terms counts as zero; above it times c |s|² without a test.
_ROUNDING = 1e-6


class LinearSolution(NamedTuple):
    """Approximate solution; ``indefinite`` if a direction of negative curvature ended it."""

    step: np.ndarray  # shape (3, ny, nx) (m)
    iterations: int
    indefinite: bool


class LinearSolver:
    """Conjugate gradients, owner of the single-precision arrays and transforms.

    ``shift`` is c of the preconditioner (N/m), positive; ``fixed_mean`` keeps the mean of the normal component. The
    caller writes D into ``diagonal`` (N/m, shape (6, ny, nx)): xx, yy, zz, xy, xz, yz. ``direction``, shape
    (3, ny, nx), is the last search direction: one of negative curvature if the solver stopped on it.
    """

    def __init__(self, stiffness: SurfaceStiffness, shift: float, fixed_mean: bool, threads: int = 1):
        shape = (3, *stiffness.grid.shape)
        self.transform = RealTransform(shape, np.float32, threads)
        self.fixed_mean = fixed_mean
        self.diagonal = np.zeros((6, *shape[1:]), np.float32)
        self.direction = np.empty(shape, np.float32)
        self._shift = shift
        self._coefficients = stiffness.coefficients.astype(np.float32)
        self._coefficients[2, 0, 0] = 0.0
        self._half_grid = 0.5 * float(np.max(self._coefficients[2]))
        self._multiplicity = stiffness.grid.multiplicity[0].astype(np.float32)
        self._transforms = [self.transform]
        self._preconditioner = preconditioner_of(self._transforms, self._coefficients, shift, HALVINGS, threads)
        self._residual = np.empty(shape, np.float32)
        self._solution = np.empty(shape, np.float32)
        self._split_curvature = np.full(self.diagonal.shape, np.nan, np.float32)
        self._normal = np.zeros(shape, np.float32)
        self._removed = np.empty(shape[1:], np.float32)
        self._core = np.empty(shape[1:], np.float32)

    @property
    def pairs(self) -> float:
        """Transform pairs so far, on coarser grids in proportion to their points."""
        return sum(transform.pairs / 4**number for number, transform in enumerate(self._transforms))

    def solve(
        self, gradient: np.ndarray, reduction: float, max_iterations: int, total: float = np.inf
    ) -> LinearSolution:
        """Solve (S + D) x = −gradient (N), whose normal mean is zero if that mean is fixed.

        The solve ends when the residual's norm has fallen by the factor ``reduction`` and |Σ residual| of the normal
        component is at most ``total`` (N): the softest mode of a light contact, its mean height, may be a small part
        of the norm.
        """
        scale = float(np.max(np.abs(gradient)))
        transform, normalisation = self.transform, 1 / self.transform.points
        spectrum, field = transform.spectrum.view(np.float32), transform.field
        waves = self._coefficients, self._multiplicity
        parts = self._normal, self._removed, self._core
        residual, direction, solution = self._residual, self.direction, self._solution
        given = self._shift, self._half_grid, _NEGLIGIBLE * self._shift, self._split_curvature
        split(self.diagonal, *given, *parts)
        np.multiply(gradient, -1 / scale, out=residual, casting="same_kind")
        solution[...] = direction[...] = 0.0
        squares, core = _take_tail(residual, *parts, field)
        target = reduction**2 * squares
        previous, indefinite, iterations = np.inf, False, 0
        while iterations < max_iterations:
            product = core + self._preconditioner.apply_and_sum()
            if not product > 0.0:
                break  # only rounding is left
            iterations += 1
            local, length = _turn(residual, *parts, product / previous, self.diagonal, direction, field)
            if self.fixed_mean:
                local -= self._remove_mean()
            previous = product
            transform.forward()
            elastic = multiply(spectrum, *waves, normalisation)
            curvature = local + elastic
            if curvature <= _ROUNDING * self._shift * length:
                # What may be rounding: of the sum's terms, S of a nearly uniform field among them.
                terms = inner_product(np.abs(self.diagonal[:3]) * direction, direction) + elastic
                if curvature <= _ROUNDING * (terms + 2 * _ROUNDING * self._half_grid * length):
                    indefinite = True
                    break
            transform.backward()
            _descend(product / curvature, direction, self.diagonal, field, solution, residual)
            if self.fixed_mean:
                residual[2] -= np.mean(residual[2], dtype=np.float64)  # the constraint's own force
            squares, core = _take_tail(residual, *parts, field)
            if squares <= target and (np.isinf(total) or abs(residual[2].sum(dtype=float)) * scale <= total):
                break
        return LinearSolution(solution * scale, iterations, indefinite)

    def unstable_direction(self, max_iterations: int) -> np.ndarray | None:
        """Find a direction of negative curvature of S + D, shape (3, ny, nx); None if conjugate gradients meet none."""
        # A random right side, the same each time, on atoms of negative D, as every unstable mode is.
        start = np.maximum(-self.diagonal[:3], 0)
        start *= 1 + np.random.default_rng(0).standard_normal(start.shape, dtype=np.float32)
        if self.fixed_mean:
            start[2] -= np.mean(start[2])
        if not start.any():
            return None
        found = self.solve(start, 0.0, max_iterations)
        return self.direction / np.abs(self.direction).max() if found.indefinite else None

    def _remove_mean(self) -> float:
        """Make the normal mean of the direction (and of the transform's field) zero; return the change of s·D s."""
        mean = np.float32(np.mean(self.direction[2], dtype=np.float64))
        xz, yz, zz = self.diagonal[4], self.diagonal[5], self.diagonal[2]
        x, y, w = self.direction
        lost = 2 * mean * (xz * x + yz * y + zz * w) - mean * mean * zz
        self.direction[2] -= mean
        self.transform.field[2] -= mean
        return float(np.sum(lost, dtype=np.float64))


class FourierPreconditioner:
    """(S + shift)⁻¹ by transforms of three components in float32; S and ``shift`` in N/m."""

    def __init__(self, transform: RealTransform, coefficients: np.ndarray, shift: float):
        self.field = transform.field
        self._transform = transform
        grid = Grid((transform.shape[1], transform.shape[2]), (1.0, 1.0))
        self._operator = coefficients, grid.multiplicity[0].astype(np.float32), shift, 1 / transform.points

    def apply_and_sum(self) -> float:
        product = invert(self._transform.forward().view(np.float32), *self._operator)
        self._transform.backward()
        return product


def preconditioner_of(
    transforms: list[RealTransform], coefficients: np.ndarray, shift: float, halvings: int, threads: int = 1
) -> Inverse:
    """Return (S + shift)⁻¹ in the last transform's buffer, and append the transforms of coarser grids that save work.

    S is needed for waves longer than a few atoms only: one stiffness per component represents the rest.
    """
    transform = transforms[-1]
    rows, columns = transform.shape[1:]
    if not (halvings and can_be_halved((rows, columns))):
        return FourierPreconditioner(transform, coefficients, shift)
    transforms.append(RealTransform((3, rows // 2, columns // 2), np.float32, threads))
    # S of the waves that every second atom can carry.
    kept = np.r_[: rows // 4 + 1, rows - (rows // 2 - rows // 4 - 1) : rows]
    coarse = np.ascontiguousarray(coefficients[:, kept, : columns // 4 + 1])
    coarser = preconditioner_of(transforms, coarse, shift, halvings - 1, threads)
    return HalvedInverse(transform.field, coarser, coefficients[:3].max(axis=(1, 2)))


@kernel
def _take_tail(r, normal, removed, core, field):
    """Write B r into ``field``; return r·r and the core's part of r·z."""
    squares = product = 0.0
    for j in range(r.shape[1]):
        row = np.float32(0.0)
        row_product = np.float32(0.0)
        for i in range(r.shape[2]):
            x, y, w = r[0, j, i], r[1, j, i], r[2, j, i]
            along = normal[0, j, i] * x + normal[1, j, i] * y + normal[2, j, i] * w
            taken = removed[j, i] * along
            field[0, j, i] = x - taken * normal[0, j, i]
            field[1, j, i] = y - taken * normal[1, j, i]
            field[2, j, i] = w - taken * normal[2, j, i]
            row += x * x + y * y + w * w
            row_product += core[j, i] * along * along
        squares += float(row)
        product += float(row_product)
    return squares, product


@kernel
def _turn(r, normal, removed, core, ratio, diagonal, direction, field):
    """Write the direction s = z + ratio·s, also into ``field`` in place of (S + c)⁻¹ B r; return s·D s and s·s."""
    beta = np.float32(ratio)
    local = length = 0.0
    for j in range(r.shape[1]):
        row = np.float32(0.0)
        row_length = np.float32(0.0)
        for i in range(r.shape[2]):
            n_x, n_y, n_z = normal[0, j, i], normal[1, j, i], normal[2, j, i]
            x, y, w = field[0, j, i], field[1, j, i], field[2, j, i]
            along = core[j, i] * (n_x * r[0, j, i] + n_y * r[1, j, i] + n_z * r[2, j, i])
            along -= removed[j, i] * (n_x * x + n_y * y + n_z * w)
            x += along * n_x + beta * direction[0, j, i]
            y += along * n_y + beta * direction[1, j, i]
            w += along * n_z + beta * direction[2, j, i]
            direction[0, j, i] = field[0, j, i] = x
            direction[1, j, i] = field[1, j, i] = y
            direction[2, j, i] = field[2, j, i] = w
            row_length += x * x + y * y + w * w
            row += diagonal[0, j, i] * x * x + diagonal[1, j, i] * y * y + diagonal[2, j, i] * w * w
            row += np.float32(2.0) * (diagonal[3, j, i] * x * y + diagonal[4, j, i] * x * w + diagonal[5, j, i] * y * w)
        local += float(row)
        length += float(row_length)
    return local, length


@kernel
def _descend(step, direction, diagonal, stretch, solution, r):
    """Step along the direction s, with S s in ``stretch``."""
    alpha = np.float32(step)
    for j in range(r.shape[1]):
        for i in range(r.shape[2]):
            x, y, w = direction[0, j, i], direction[1, j, i], direction[2, j, i]
            xy, xz, yz = diagonal[3, j, i], diagonal[4, j, i], diagonal[5, j, i]
            solution[0, j, i] += alpha * x
            solution[1, j, i] += alpha * y
            solution[2, j, i] += alpha * w
            r[0, j, i] -= alpha * (stretch[0, j, i] + diagonal[0, j, i] * x + xy * y + xz * w)
            r[1, j, i] -= alpha * (stretch[1, j, i] + xy * x + diagonal[1, j, i] * y + yz * w)
            r[2, j, i] -= alpha * (stretch[2, j, i] + xz * x + yz * y + diagonal[2, j, i] * w)
