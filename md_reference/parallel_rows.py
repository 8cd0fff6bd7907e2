"""Rows of a layer shared among threads, by compiled kernels that release the interpreter's lock.

No row's numbers depend on the block of rows that contains it: results are bit-identical for any number of threads.
"""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cache

from numba import njit

# In smaller layers waking a thread costs what it gains, or more where the other cores are busy.
ATOMS_FOR_THREADS = 200**2
_FEWEST_BLOCKS = 2  # per thread: with one each, all wait for the last

row_kernel = njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "nsz"})
"""Compile a function of rows: sums in the order written, the interpreter's lock released."""


def share_rows(kernel: Callable[[int, int], object], rows: int, size: int, threads: int = 1) -> None:
    """Call ``kernel(first, end)`` for blocks of ``size`` rows in any order, with so many threads, the caller's too."""
    blocks = [(first, min(first + size, rows)) for first in range(0, rows, size)]
    left = iter(blocks)
    helpers = min(threads, len(blocks) // _FEWEST_BLOCKS) - 1
    tasks = [_pool(threads - 1).submit(_work, kernel, left) for _ in range(helpers)]
    try:
        _work(kernel, left)
    finally:
        failures = [task.exception() for task in tasks if not task.cancel()]
    for failure in failures:
        if failure is not None:
            raise failure


def _work(kernel: Callable[[int, int], object], blocks: Iterator[tuple[int, int]]) -> None:
    for first, end in blocks:
        kernel(first, end)


@cache
def _pool(helpers: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(helpers, thread_name_prefix="rows")


# A forked process has none of the threads.
os.register_at_fork(after_in_child=_pool.cache_clear)
