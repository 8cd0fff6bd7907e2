"""Expansions of an answer: shares of variance of functions whose shares are known."""

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import qmc, sobol_indices, uniform

from contact_study.numerics.expansion import Input, expansion

POINTS = qmc.Sobol(3, seed=np.random.default_rng(5)).random(256)


def test_a_linear_answer_of_normal_scores_has_the_shares_of_its_squares():
    answer = 4 + ndtri(POINTS) @ [3, 2, 1]
    found = expansion([Input()] * 3, POINTS, answer)
    first, joint, left = found.shares()
    np.testing.assert_allclose(first, np.array([9, 4, 1]) / 14, atol=1e-12)  # exact but for rounding
    assert max(joint, left) < 1e-12
    assert found.variance == pytest.approx(14, rel=1e-12)


def test_shares_agree_with_scipys_saltelli_estimate():
    def answer(x):  # x of shape (inputs, n), as scipy calls it
        return (1 + x[0]) * (2 + x[1] ** 2) + 0.5 * x[2]

    theirs = sobol_indices(func=answer, n=4096, dists=[uniform()] * 3, rng=np.random.default_rng(1))
    first, joint, left = expansion([Input("uniform")] * 3, POINTS, answer(POINTS.T)).shares()
    # scipy's own error with 4096 points, seen over seeds, is 3e-3.
    np.testing.assert_allclose(first, theirs.first_order, atol=6e-3)
    assert joint == pytest.approx(1 - theirs.first_order.sum(), abs=6e-3)
    assert left < 1e-3


def test_a_choice_among_values_takes_its_share_and_noise_is_left():
    effect = np.array([0.0, 3.0, 6.0])
    noise = np.random.default_rng(2).normal(size=256)
    answer = effect[np.minimum((POINTS[:, 0] * 3).astype(int), 2)] + noise
    first, _, left = expansion([Input("uniform", 3), Input(), Input()], POINTS, answer).shares()
    # Variance 6 of the choice, 1 of the noise; the noise's own variance of 256 points is good to 9 %.
    assert first[0] == pytest.approx(6 / 7, abs=0.02)
    assert left == pytest.approx(1 / 7, abs=0.02)
    assert first[1:].max() < 0.01


def test_functions_are_orthonormal():
    middle = (np.arange(4000) + 0.5) / 4000
    for one in (Input("uniform"), Input("uniform", 4), Input()):
        values = one.functions(middle, 2)
        # The midpoint rule cuts off the normal tails at one part in 8000.
        np.testing.assert_allclose(values @ values.T / 4000, np.eye(len(values)), atol=5e-3)
        np.testing.assert_allclose(values.mean(1), 0, atol=2e-3)


def test_few_points_give_a_linear_expansion_and_fewer_an_error():
    answer = POINTS @ [1, 2, 3]
    assert expansion([Input("uniform")] * 3, POINTS[:8], answer[:8]).order == 1
    with pytest.raises(ValueError, match="7 points determine no expansion in 3 inputs; 8 do"):
        expansion([Input("uniform")] * 3, POINTS[:7], answer[:7])


def test_prediction_returns_the_answer():
    answer = 1 + POINTS[:, 0] * POINTS[:, 1] - POINTS[:, 2] ** 2
    found = expansion([Input("uniform")] * 3, POINTS, answer)
    np.testing.assert_allclose(found.at(POINTS[:5]), answer[:5], atol=1e-12)
