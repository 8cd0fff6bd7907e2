"""Arguments of the library: what is refused, and in which unit and number."""

import numpy as np
import pytest

from contact_study.numerics.arguments import field, grid_of, positive, step_arguments


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: positive("size", -1.0, "m"), "size = -1.0: must be a positive finite number, in m"),
        (lambda: positive("size", 0, "m"), "size = 0"),
        (lambda: field("height", [[0.0, np.nan]]), "1 point is not"),
        (lambda: field("height", [[np.inf, np.nan]]), "2 points are not"),
        (lambda: grid_of(np.zeros((4, 6)), (1.0, 2.0, 3.0)), "one period or two"),
        (lambda: grid_of(np.zeros((4, 6)), (1.0,)), "one period or two"),
        (lambda: step_arguments("pressure", np.nan, np.zeros(2), (2,)), "mean pressure must be a finite number, in Pa"),
        (lambda: step_arguments("approach", np.nan, np.zeros(2), (2,)), "approach must be a finite number, in m"),
        (lambda: step_arguments("gap", 0.0, np.zeros(2), (3,)), "this contact needs"),
    ],
)
def test_what_is_refused(call, words):
    with pytest.raises(ValueError, match=words.replace("(", r"\(")):
        call()


def test_one_period_stands_for_both():
    heights = np.zeros((4, 6))
    assert grid_of(heights, 2.0).size == (2.0, 2.0)
    assert (grid_of(heights, (1.0, 3.0)).size, grid_of(heights, (1.0, 3.0)).shape) == ((1.0, 3.0), (4, 6))
