"""Intervals of 50 synthetic experiments hold the true values as often as they say."""

import pytest

from scripts.validate_inference import KINDS, covered


@pytest.mark.validation
@pytest.mark.parametrize("name", list(KINDS["spheres"]))
def test_intervals_hold_the_true_value_in_45_of_50_experiments(name):
    for _, parameter, held, *_ in covered(name, KINDS["spheres"][name], 50):
        # 45 of 50 by 90 % intervals, with a standard deviation of √(50 · 0.9 · 0.1) = 2.1; two of them.
        assert 41 <= int(held.split()[0]) <= 49, parameter
