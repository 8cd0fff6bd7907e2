import numpy as np
import pytest

from contact_study.numerics.kernel import inner_product
from contact_study.numerics.memory import ALIGNMENT, Memory, Scratch, aligned


def test_arrays_lie_side_by_side_in_what_is_lent_and_beyond_it_anew():
    lent = aligned(1000)
    memory = Memory(lent)
    first, second = memory.array((5, 7), np.float64), memory.array((3, 5, 7), np.float32)
    beyond, fits = memory.array((5, 7), np.float64), memory.array((4,), np.float64)
    for array, inside in ((first, True), (second, True), (beyond, False), (fits, True)):
        assert np.shares_memory(array, lent) == inside
        assert array.ctypes.data % ALIGNMENT == 0
    for one, other in ((first, second), (second, fits), (first, fits)):
        assert not np.shares_memory(one, other)
    assert not np.shares_memory(Memory().array((2, 3), np.float32), Memory().array((2, 3), np.float32))
    # Scratch is one memory, as large as its largest array.
    scratch, kind = Scratch(), np.dtype(np.complex128)
    large, small, larger = (scratch.array(shape, kind) for shape in ((8, 4), (3, 2), (9, 9)))
    assert np.shares_memory(large, small)
    assert not np.shares_memory(large, larger)
    assert larger.ctypes.data % ALIGNMENT == 0


@pytest.mark.parametrize("shape", [(7,), (3, 20, 31)])
def test_inner_product_has_the_same_bits_wherever_the_fields_lie(shape):
    one, other = np.random.default_rng(0).standard_normal((2, *shape))
    # Rounding: 1e-16 of the sum of magnitudes, which is 1e4 at most.
    assert inner_product(one, other) == pytest.approx(np.sum(one * other), abs=1e-11)
    single = other.astype(np.float32)[::2]
    assert inner_product(one[::2], single) == pytest.approx(np.sum(one[::2] * single), abs=1e-11)
    moved = [np.append(np.empty(shift), one)[shift:].reshape(shape) for shift in range(8)]
    assert len({inner_product(field, other) for field in moved}) == 1
