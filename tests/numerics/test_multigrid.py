"""Transfer between a grid and one of half its points, against the stencils as sums of shifted arrays."""

import numpy as np
import pytest

from contact_study.numerics.multigrid import FEWEST_POINTS, can_be_halved, prolong, restrict


def test_restriction_is_full_weighting_and_prolongation_is_linear():
    random = np.random.default_rng(1)
    fine, coarse = random.standard_normal((8, 12)), random.standard_normal((4, 6))
    weights = {-1: 0.25, 0: 0.5, 1: 0.25}
    mean = sum(weights[i] * weights[j] * np.roll(fine, (-i, -j), (0, 1)) for i in weights for j in weights)
    found = np.empty((4, 6))
    restrict(fine, found)
    np.testing.assert_allclose(found, mean[::2, ::2], atol=1e-15)  # rounding of sums of order one
    between = np.zeros((8, 12))
    between[::2, ::2] = coarse
    linear = sum(4 * weights[i] * weights[j] * np.roll(between, (i, j), (0, 1)) for i in weights for j in weights)
    out = fine.copy()
    assert prolong(coarse, 0.3, out) == pytest.approx(0.3 * np.sum(fine**2), rel=1e-14)
    np.testing.assert_allclose(out, 0.3 * fine + linear, atol=1e-15)


def test_grids_that_are_halved():
    least = 2 * FEWEST_POINTS
    assert can_be_halved((least, least + 2))
    assert not any(map(can_be_halved, [(least + 1, least + 2), (least + 2, least + 1), (least - 2, least + 2)]))
