import numpy as np
import pytest

from contact_study.numerics.inner_product import inner_product


@pytest.mark.parametrize("shape", [(7,), (5, 300), (3, 20, 31)])
def test_the_sum_of_products(shape):
    one, other = np.random.default_rng(0).standard_normal((2, *shape))
    expected = sum(float(a) * float(b) for a, b in zip(one.flat, other.flat, strict=True))
    # Rounding: 1e-16 of the sum of magnitudes, which is 1e4 at most.
    assert inner_product(one, other) == pytest.approx(expected, abs=1e-11)
    assert inner_product(one[::2], other.astype(np.float32)[::2]) == pytest.approx(
        float(np.sum(one[::2] * other.astype(np.float32)[::2])), abs=1e-11
    )


def test_its_bits_do_not_depend_on_where_the_fields_lie():
    one, other = np.random.default_rng(0).standard_normal((2, 1001))
    found = set()
    for shift in range(8):
        moved = np.empty(1001 + shift)[shift:]
        moved[...] = one
        found.add(inner_product(moved, other))
    assert len(found) == 1
