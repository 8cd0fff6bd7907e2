"""Whether a case fits the memory that it will have, said before anything is allocated."""

import os
import socket
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from contact_study.errors import InputError
from contact_study.study.case import Case

# Height, gap, pressure, displacement, its spectrum, the kernel and a few of the solver's own: a dozen doubles.
_BYTES_PER_POINT = 100

_GROUPS = Path("/sys/fs/cgroup")
_OWN_GROUPS = Path("/proc/self/cgroup")

_share = float("inf")  # bytes that this process may use, where whoever has started it says so


@dataclass(frozen=True)
class Need:
    """Memory that something takes at least.

    Attributes
    ----------
    size : float
        Bytes.
    culprit : str
        What takes them, as a message names it.
    advice : str
        What takes less.
    """

    size: float
    culprit: str
    advice: str


def grid_of(case: Case) -> Need:
    """What a simulation on the grid of a case takes."""
    shape = case.surface.shape or (0, 0)
    return Need(_on_grid(shape), f"surface.shape = {list(shape)}", "fewer points")


def _on_grid(shape: tuple[int, int]) -> float:
    return float(shape[0] * shape[1] * _BYTES_PER_POINT)


def grid_fits(shape: tuple[int, int]) -> bool:
    """Whether the machine's memory holds a simulation on so many points."""
    return _on_grid(shape) <= _memory()


def most_points() -> float:
    """Points of the largest grid that the machine's memory holds."""
    return _memory() / _BYTES_PER_POINT


def memory_in_words(shape: tuple[int, int]) -> str:
    """What a simulation on so many points needs, such as ``1.2 GB``."""
    needed = _on_grid(shape)
    return f"{needed / 1e9:.2g} GB" if needed >= 1e8 else f"{needed / 1e6:.2g} MB"


def require(need: Need) -> None:
    """Raise InputError, as :func:`require_memory`, over what a case needs."""
    require_memory(need.size, need.culprit, need.advice)


def require_memory(needed: float, culprit: str, advice: str) -> None:
    """Raise InputError, naming the culprit, if ``needed`` bytes are more than this process may ever use.

    The system would otherwise kill the run without a word.
    """
    available = _memory()
    if needed > available:
        who = next((words for size, words in _limits() if size == available), "")
        raise InputError(
            f"{culprit}: needs at least {needed / 1e9:.3g} GB of memory, {who}{socket.gethostname()} has "
            f"{available / 1e9:.3g} GB; use {advice}"
        )


def require_memory_at_once(needs: Sequence[Need], workers: int | None) -> int:
    """Make sure that memory holds cases, the largest of them side by side.

    Parameters
    ----------
    needs : sequence of Need
        What they take.
    workers : int or None
        How many are asked for at once; None: as many as fit.

    Returns
    -------
    int
        How many fit.

    Raises
    ------
    InputError
        If one alone, or as many as are asked for, need more.
    """
    largest = max(needs, key=lambda need: need.size)
    require(largest)
    fitting = int(_memory() / max(largest.size, 1))
    if workers is not None and workers > fitting:
        require_memory(workers * largest.size, f"--workers {workers}: {largest.culprit}", f"--workers {fitting}")
    return fitting


def set_share(size: float | None) -> None:
    """Say how many bytes this process may use of its machine's memory, beside others there; None: it is not known."""
    global _share
    _share = float("inf") if size is None else float(size)


def _memory() -> float:
    """Bytes that this process may use: the machine's, or less inside a job's limit or a container."""
    return min((size for size, _ in _limits()), default=float("inf"))


def _limits() -> Iterator[tuple[float, str]]:
    """Limits (bytes), each with whose it is, to be followed by the name of the machine."""
    yield _share, "a Dask worker on "
    with suppress(AttributeError, ValueError, OSError):  # not on every system
        yield float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")), ""
    for path in _limit_files():
        with suppress(OSError, ValueError):  # no such group, or "max"
            yield float(path.read_text()), "the job on "


def _limit_files() -> Iterator[Path]:
    """Where the groups that this process is in may have a limit: a batch job, a container, a session."""
    yield _GROUPS / "memory.max"
    try:
        lines = _OWN_GROUPS.read_text().splitlines()
    except OSError:  # not on every system
        return
    for line in lines:
        _, kinds, group = line.split(":", 2)
        if kinds and "memory" not in kinds.split(","):
            continue
        # Of version 2, for which no kinds are named, and of version 1.
        root, name = (_GROUPS / "memory", "memory.limit_in_bytes") if kinds else (_GROUPS, "memory.max")
        own = Path(group.lstrip("/"))
        for parent in (own, *own.parents):
            yield root / parent / name
