import numpy as np

from contact_study.numerics.memory import ALIGNMENT, Memory, Scratch, aligned


def test_arrays_lie_side_by_side_in_what_is_lent_and_beyond_it_anew():
    lent = aligned(1000)
    memory = Memory(lent)
    first, second = memory.array((5, 7), np.float64), memory.array((3, 5, 7), np.float32)
    third = memory.array((5, 7), np.float64)
    fits = memory.array((4,), np.float64)
    for array, inside in ((first, True), (second, True), (third, False), (fits, True)):
        assert np.shares_memory(array, lent) == inside
        assert array.ctypes.data % ALIGNMENT == 0
    for one, other in ((first, second), (second, fits), (first, fits)):
        assert not np.shares_memory(one, other)
    first[...], second[...], fits[...] = 1.0, 2.0, 3.0
    assert (first == 1).all()
    assert (second == 2).all()


def test_memory_of_nobody_is_taken_anew():
    memory = Memory()
    assert not np.shares_memory(memory.array((2, 3), np.float32), memory.array((2, 3), np.float32))


def test_scratch_is_one_memory_as_large_as_its_largest():
    scratch = Scratch()
    large, small = scratch.array((8, 4), np.dtype(np.complex128)), scratch.array((3, 2), np.dtype(np.complex64))
    larger = scratch.array((9, 9), np.dtype(np.complex128))
    assert np.shares_memory(large, small)
    assert not np.shares_memory(large, larger)
    assert larger.ctypes.data % ALIGNMENT == 0
