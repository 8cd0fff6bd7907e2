"""Memory shared by arrays that are never needed at the same time, by one thread at a time."""

import math
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

import numpy as np

# Bytes: the vector instructions of FFTW, and a line of the cache.
ALIGNMENT = 64
_Method = TypeVar("_Method", bound=Callable[..., Any])


def in_turn(method: _Method) -> _Method:
    """Make threads take turns in a method, by the lock ``turn`` of its object: its arrays serve one at a time."""

    @wraps(method)
    def taken(self: Any, /, *arguments: Any, **options: Any) -> Any:
        with self.turn:
            return method(self, *arguments, **options)

    return cast(_Method, taken)


def aligned(size: int) -> np.ndarray:
    """Allocate bytes of undefined content that begin at a multiple of :data:`ALIGNMENT`."""
    memory = np.empty(size + ALIGNMENT, np.uint8)
    first = -memory.ctypes.data % ALIGNMENT
    return memory[first : first + size]


class Scratch:
    """Memory for the spectra of transforms that never need theirs at the same time."""

    def __init__(self) -> None:
        self._memory = aligned(0)

    def array(self, shape: tuple[int, ...], dtype: np.dtype) -> np.ndarray:
        """Return an array of undefined content in the memory, which grows where it is too small."""
        size = math.prod(shape) * dtype.itemsize
        if size > self._memory.size:
            self._memory = aligned(size)
        return self._memory[:size].view(dtype).reshape(shape)


class Memory:
    """Memory for arrays side by side: bytes lent by an owner who does not need them meanwhile, then allocated ones."""

    def __init__(self, lent: np.ndarray | None = None):
        self._left = aligned(0) if lent is None else lent

    def array(self, shape: tuple[int, ...], dtype: type) -> np.ndarray:
        """Return the next array, of undefined content."""
        size = math.prod(shape) * np.dtype(dtype).itemsize
        if size > self._left.size:
            return aligned(size).view(dtype).reshape(shape)
        memory, self._left = self._left[:size], self._left[-(-size // ALIGNMENT) * ALIGNMENT :]
        return memory.view(dtype).reshape(shape)
