import numpy as np
import pytest

from md_reference.newton_step import NewtonSolver
from tests.md_reference.systems import stiffness_of
from tests.md_reference.test_block import apply

SHAPE = (9, 12)


def times_diagonal(diagonal, u):
    xx, yy, zz, xy, xz, yz = diagonal
    return np.stack(
        [
            xx * u[0] + xy * u[1] + xz * u[2],
            xy * u[0] + yy * u[1] + yz * u[2],
            xz * u[0] + yz * u[1] + zz * u[2],
        ]
    )


def free_of_uniform_compression(stiffness, image, u):
    """S u without S_zz at q = 0."""
    image = image.copy()
    image[2] -= stiffness.coefficients[2, 0, 0] * u[2].mean()
    return image


def random_diagonal(scale, seed=0):
    """Positive definite 3×3 matrices of widely different size."""
    rng = np.random.default_rng(seed)
    factor = rng.standard_normal((*SHAPE, 3, 3)) * 10 ** rng.uniform(-1, 0.5, SHAPE)[..., None, None]
    d = scale * factor @ np.swapaxes(factor, -1, -2)
    return np.stack([d[..., 0, 0], d[..., 1, 1], d[..., 2, 2], d[..., 0, 1], d[..., 0, 2], d[..., 1, 2]])


@pytest.mark.parametrize("fixed_mean", [False, True])
def test_step_solves_the_linear_problem(fixed_mean):
    stiffness = stiffness_of(SHAPE)
    solver = NewtonSolver(stiffness, fixed_mean)
    scale = np.abs(stiffness.coefficients).max()
    solver.diagonal[...] = random_diagonal(0.1 * scale)
    gradient = np.random.default_rng(1).standard_normal((3, *SHAPE))
    if fixed_mean:
        gradient[2] -= gradient[2].mean()
    found = solver.solve(gradient, 0.02 * scale, 1e-4, 500)
    image = free_of_uniform_compression(stiffness, apply(stiffness, found.step), found.step)
    image += times_diagonal(solver.diagonal.astype(float), found.step)
    left = image + gradient
    if fixed_mean:
        left[2] -= left[2].mean()
        assert abs(found.step[2].mean()) < 1e-6 * np.abs(found.step).max()
    assert not found.indefinite
    # Twice the asked reduction: single precision.
    assert np.linalg.norm(left) < 2e-4 * np.linalg.norm(gradient)
    assert solver.transform.pairs == found.iterations


def test_step_does_not_depend_on_the_size_of_the_gradient():
    stiffness = stiffness_of(SHAPE)
    solver = NewtonSolver(stiffness, False)
    solver.diagonal[...] = random_diagonal(1.0)
    gradient = np.random.default_rng(2).standard_normal((3, *SHAPE))
    one = solver.solve(gradient, 1.0, 1e-3, 100)
    small = solver.solve(gradient * 2.0**-60, 1.0, 1e-3, 100)
    np.testing.assert_array_equal(one.step * 2.0**-60, small.step)


def test_negative_curvature_ends_the_iteration():
    stiffness = stiffness_of(SHAPE)
    solver = NewtonSolver(stiffness, False)
    gradient = np.random.default_rng(3).standard_normal((3, *SHAPE))
    solver.diagonal[:3] = -2 * np.abs(stiffness.coefficients).max()
    assert solver.solve(gradient, 1.0, 1e-3, 100).indefinite
    image = free_of_uniform_compression(stiffness, apply(stiffness, solver.direction), solver.direction)
    image += times_diagonal(solver.diagonal.astype(float), solver.direction)
    assert np.sum(image * solver.direction) < 0
    solver.diagonal[...] = random_diagonal(1.0)
    assert not solver.solve(gradient, 1.0, 1e-3, 100).indefinite
