"""Points of paths are matched by value, branch and visit."""

import numpy as np

from contact_study.study.load_steps import path_points, path_points_of
from contact_study.study.study import make_study
from tests.study.test_study import changed


def test_points_of_a_case_are_those_of_its_dataset():
    table = changed("loading", path=["0 Pa", "1 GPa", "0.1 GPa", "1 GPa"], unload=True)
    (case,) = make_study(table).cases
    points = path_points_of(case)
    assert points == [
        ("0", 0, 0),
        ("1000000000", 0, 0),
        ("100000000", 0, 0),
        ("1000000000", 0, 1),
        ("100000000", 1, 0),
        ("1000000000", 1, 0),
        ("0", 1, 0),
    ]
    values, branches = zip(*case.path, strict=True)
    assert path_points([*values, np.nan], [*(branch == "unloading" for branch in branches), -1]) == [*points, None]


def test_twelve_digits_tell_points_apart_and_no_sign_of_zero():
    one, near, same, zero, minus = path_points([1e9, 1e9 * (1 + 1e-11), 1e9 * (1 + 1e-15), 0.0, -0.0], [0] * 5)
    assert one[0] != near[0]
    assert (same[0], same[2]) == (one[0], 1)
    assert (minus[0], minus[2]) == (zero[0], 1)
