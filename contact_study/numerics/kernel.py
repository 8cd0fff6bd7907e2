"""Compiled loops over arrays: their decorator, and the sum of products of two fields."""

from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import Any

import numpy as np


class kernel:
    """A function that Numba compiles at its first call, so that importing a package takes half the time.

    IEEE division by zero, sums in any order, infinities and NaN kept. It may call kernels of its own module.
    """

    def __init__(self, function: Callable[..., Any]):
        self._function = function
        update_wrapper(self, function)

    @cached_property
    def compiled(self) -> Callable[..., Any]:
        """The function as Numba has it."""
        from numba import njit  # slow to import

        names = self._function.__globals__
        for name in self._function.__code__.co_names:
            if isinstance(called := names.get(name), kernel):
                names[name] = called.compiled
        return njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})(self._function)

    def __call__(self, *arguments: Any) -> Any:
        return self.compiled(*arguments)


def inner_product(one: np.ndarray, other: np.ndarray) -> float:
    """Σ a b over all points of two real fields of one shape, to the same bits wherever they lie in memory.

    ``np.vdot`` waits for threads of the BLAS library, long where another case works on their core.
    """
    return float(_sum_of_products(one.ravel(), other.ravel()))


@kernel
def _sum_of_products(one, other):
    total = 0.0
    for i in range(one.size):
        total += np.float64(one[i]) * np.float64(other[i])
    return total
