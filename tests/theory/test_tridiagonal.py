"""Elimination from both ends against dense matrices, and the scale's equation of the edge flow built on it."""

import numpy as np
import pytest

from theory.edge_flow.equilibrium import KERNEL
from theory.edge_flow.kernels import _respond, compare, differences
from theory.numerics.tridiagonal import factorise, solve


@pytest.mark.parametrize("rows", [2, 3, 120])
def test_a_matrix_and_its_transpose_are_solved(rows):
    random = np.random.default_rng(rows)
    lower, upper, aim = random.uniform(-1, 1, (3, rows))
    diagonal = random.uniform(2.5, 4, rows)
    matrix = np.diag(diagonal) + np.diag(lower[1:], -1) + np.diag(upper[:-1], 1)
    inverse, inward, outward = np.empty((3, rows))
    factorise(lower, diagonal, upper, inverse, inward, outward)
    for factors, dense in (((inverse, inward, outward), matrix), ((inverse, outward, inward), matrix.T)):
        values = aim.copy()
        solve(*factors, values)
        # Dominant diagonals: rounding alone.
        np.testing.assert_allclose(values, np.linalg.solve(dense, aim), rtol=1e-12, atol=1e-14)


@pytest.mark.validation
@pytest.mark.parametrize(("nodes", "kernel"), [(8, KERNEL), (31, (0.1, 0.6, 2.5))])
def test_the_response_solves_its_two_coupled_equations(nodes, kernel):
    random = np.random.default_rng(nodes)
    x = np.cumsum(random.uniform(0.5, 1.5, nodes))
    stiffness, modulation, square = 1.3, 0.7, 2.0
    curvature = random.uniform(-0.4, 2, nodes)
    weights, gradients = random.uniform(0.5, 1, (2, 2, nodes))
    answer, rows = np.empty(nodes), np.empty((7, nodes))
    cell = differences(x)[4]
    _respond(x, cell, (stiffness, modulation, square), kernel, curvature, weights, gradients, answer, rows)
    # X = −(P q²)⁻¹ ∂ M ∂ on the inner nodes, with no flux to the nodes at the ends.
    inner = slice(1, nodes - 1)
    share, mean = weights.mean(axis=0), gradients.mean(axis=0)
    flux = np.zeros(nodes - 1)
    flux[1:-1] = (0.5 * (mean[1:] + mean[:-1]) / np.diff(x) / square)[1:-1]
    operator = np.diag(np.append(flux, 0) + np.append(0, flux)) - np.diag(flux, 1) - np.diag(flux, -1)
    operator = (operator / share[:, None])[inner, inner]
    one = np.eye(nodes - 2)
    slope, level, pole = kernel
    half_space = slope * operator + level * one + (1 - level) * pole * np.linalg.inv(operator + pole * one)
    cost = (1 - modulation) * one + modulation * half_space
    expected = np.linalg.solve(stiffness * cost + np.diag(curvature[inner]), np.full(nodes - 2, stiffness))
    np.testing.assert_allclose(answer[inner], expected, rtol=1e-9)
    ends = [0, nodes - 1]
    np.testing.assert_allclose(answer[ends], stiffness / (stiffness + curvature[ends]), rtol=1e-14)


def test_the_change_is_that_of_the_worst_scale_and_no_number_is_kept():
    weights = np.full((4, 2), 0.5)
    response, answer = np.ones((3, 2)), np.array([[1.0, 1.5], [1.0, 1.25], [-1.0, 30.0]])
    importance = np.empty((3, 2))
    # The negative answer and the one beyond the bound count as they are.
    assert compare(weights, response, answer.copy(), 1e-3, 20.0, 0.0, importance) == pytest.approx(0.5 * (2 + 29))
    assert compare(weights[:3], response[:2], answer[:2].copy(), 1e-3, 20.0, 0.0, importance[:2]) == 0.25
    np.testing.assert_allclose(importance, np.sqrt(0.5))
    answer[0, 0] = np.nan
    assert np.isnan(compare(weights, response, answer, 1e-3, 20.0, 0.0, importance))
