"""Rows of a layer shared out to threads, by compiled kernels that release the interpreter's lock.

A kernel does a block of rows by itself, and no row's numbers depend on the block it is in: results are the same bits
for any number of threads. Whoever is free takes the next block. Who waits sleeps, and the caller works as well: where
the other cores are busy it does most of the blocks, and withdraws what nobody has begun.
"""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cache

# Below so many atoms of a layer waking a thread takes what it gains, or more where the other cores are busy.
ATOMS_FOR_THREADS = 200**2
_FEWEST_BLOCKS = 2  # of a thread: with one each, who is late makes the other wait


class ParallelRows:
    """Blocks of consecutive rows, done by one or several threads.

    Parameters
    ----------
    threads : int, optional
        The caller among them.
    """

    def __init__(self, threads: int = 1):
        self.threads = threads

    def run(self, kernel: Callable[[int, int], object], rows: int, size: int) -> None:
        """Call ``kernel(first, end)`` for blocks of ``size`` rows, ``first`` … ``end − 1``, in any order.

        A layer of few blocks is done by fewer threads.
        """
        blocks = [(first, min(first + size, rows)) for first in range(0, rows, size)]
        left = iter(blocks)
        helpers = min(self.threads, len(blocks) // _FEWEST_BLOCKS) - 1
        tasks = [_pool(self.threads - 1).submit(_work, kernel, left) for _ in range(helpers)]
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
