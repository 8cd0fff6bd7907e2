"""Signs of life: solvers count their iterations, a listener in this process hears of them every other second."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

PAUSE = 2.0  # seconds

Listener = Callable[[int, float | None], object]

_listener: Listener | None = None
_count, _told = 0, 0.0


def beat(residual: float | None = None) -> None:
    """Count an iteration, which began with a residual in units of the tolerance's."""
    global _count, _told
    _count += 1
    if _listener is not None and time.monotonic() - _told >= PAUSE:
        _told = time.monotonic()
        _listener(_count, None if residual is None else float(residual))


def restart() -> None:
    """Begin to count, and to wait, for another load step."""
    global _count, _told
    _count, _told = 0, time.monotonic()


@contextmanager
def listening(listener: Listener) -> Iterator[None]:
    """Tell a listener, which takes the number of iterations since the last :func:`restart` and the residual."""
    global _listener
    before, _listener = _listener, listener
    restart()
    try:
        yield
    finally:
        _listener = before
