"""Memory that is given out array by array: where arrays that are never needed at the same time lie."""

import math

import numpy as np

# What FFTW's vector instructions need, and a line of the cache.
ALIGNMENT = 64


def aligned(size: int) -> np.ndarray:
    """So many bytes, of no defined content, that begin at a multiple of :data:`ALIGNMENT`."""
    memory = np.empty(size + ALIGNMENT, np.uint8)
    first = -memory.ctypes.data % ALIGNMENT
    return memory[first : first + size]


class Scratch:
    """Memory for the spectra of transforms that never need theirs at the same time."""

    def __init__(self) -> None:
        self._memory = aligned(0)

    def array(self, shape: tuple[int, ...], dtype: np.dtype) -> np.ndarray:
        """An array in the memory, of no defined content; more is taken where there is too little."""
        size = math.prod(shape) * dtype.itemsize
        if size > self._memory.size:
            self._memory = aligned(size)
        return self._memory[:size].view(dtype).reshape(shape)


class Memory:
    """Memory for arrays that lie side by side.

    Parameters
    ----------
    lent : numpy.ndarray of uint8, optional
        Memory whose owner does without its content while these arrays are in use. What finds no place in it, and all
        without it, is taken anew.
    """

    def __init__(self, lent: np.ndarray | None = None):
        self._left = aligned(0) if lent is None else lent

    def array(self, shape: tuple[int, ...], dtype: type) -> np.ndarray:
        """The next array, of no defined content."""
        size = math.prod(shape) * np.dtype(dtype).itemsize
        taken = -(-size // ALIGNMENT) * ALIGNMENT
        if size > self._left.size:
            return aligned(size).view(dtype).reshape(shape)
        memory, self._left = self._left[:size], self._left[taken:]
        return memory.view(dtype).reshape(shape)
