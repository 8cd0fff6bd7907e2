"""Memory and time of a case: whether it fits before anything is allocated, and how long a load step takes."""

import os
import socket
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from contact_study.inputs.errors import InputError

if TYPE_CHECKING:
    from contact_study.study.case import Case

# A dozen doubles: height, gap, pressure, displacement, its spectrum, the kernel and arrays of the solver.
_BYTES_PER_POINT = 100

_LEAKAGE_PER_POINT = 1700  # bytes, of the factors of a sparse matrix, measured on 256² to 1024² points

_GROUPS = Path("/sys/fs/cgroup")
_OWN_GROUPS = Path("/proc/self/cgroup")

_share = float("inf")  # bytes that this process may use, set by its starter


@dataclass(frozen=True)
class Need:
    """Least memory of a part of a case (bytes), its name in a message, and the advice how to need less."""

    size: float
    culprit: str
    advice: str


def on_grid(shape: tuple[int, int]) -> float:
    """Memory (bytes) of a simulation on a grid of this shape."""
    return float(shape[0] * shape[1] * _BYTES_PER_POINT)


def of_leakage(shape: tuple[int, int]) -> float:
    """Memory (bytes) of a direct solve of Reynolds flow on a grid of this shape."""
    return on_grid(shape) + float(shape[0] * shape[1] * _LEAKAGE_PER_POINT)


def most_points() -> float:
    """Number of points of the largest grid that the machine's memory holds."""
    return _memory() / _BYTES_PER_POINT


def in_words(size: float) -> str:
    """Write a memory (bytes), such as ``1.2 GB``."""
    return f"{size / 1e9:.2g} GB" if size >= 1e8 else f"{size / 1e6:.2g} MB"


def require(need: Need) -> None:
    """Raise InputError if a need exceeds the memory of this process; the system would kill it without a message."""
    available = _memory()
    if need.size > available:
        who = next((words for size, words in _limits() if size == available), "")
        raise InputError(
            f"{need.culprit}: needs at least {need.size / 1e9:.3g} GB of memory, {who}{socket.gethostname()} has "
            f"{available / 1e9:.3g} GB; use {need.advice}"
        )


def require_at_once(needs: Sequence[Need], workers: int | None) -> int:
    """Count the cases that fit memory at once; raises InputError if one, or ``workers`` of them, do not."""
    largest = max(needs, key=lambda need: need.size)
    require(largest)
    fitting = int(_memory() / max(largest.size, 1))
    if workers is not None and workers > fitting:
        require(Need(workers * largest.size, f"--workers {workers}: {largest.culprit}", f"--workers {fitting}"))
    return fitting


def set_share(size: float | None) -> None:
    """Set the bytes of its machine's memory that this process may use; None: unknown."""
    global _share
    _share = float("inf") if size is None else float(size)


def _memory() -> float:
    """Bytes that this process may use: the machine's memory, or the limit of a job or container."""
    return min((size for size, _ in _limits()), default=float("inf"))


def _limits() -> Iterator[tuple[float, str]]:
    """Limits (bytes), each with the words that precede the machine's name in a message."""
    yield _share, "a Dask worker on "
    with suppress(AttributeError, ValueError, OSError):  # not on every system
        yield float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")), ""
    # Files that may hold the limits of this process's control groups: batch job, container, session.
    files, lines = [_GROUPS / "memory.max"], []
    with suppress(OSError):  # not on every system
        lines = _OWN_GROUPS.read_text().splitlines()
    for line in lines:
        _, kinds, group = line.split(":", 2)
        if not kinds or "memory" in kinds.split(","):
            # Version 2 names no kinds, version 1 does.
            root, name = (_GROUPS / "memory", "memory.limit_in_bytes") if kinds else (_GROUPS, "memory.max")
            own = Path(group.lstrip("/"))
            files += [root / parent / name for parent in (own, *own.parents)]
    for path in files:
        with suppress(OSError, ValueError):  # no such group, or "max"
            yield float(path.read_text()), "the job on "


# Processor time per load step and point, or atom (s): from a typical to a slow step of one core of 2023.
# Continuum: scripts/benchmark_grids.py (data/benchmark_grids.csv). Atoms, free boundaries, slow motion and theories:
# wall_time in datasets of the example studies.
_HARD_WALL = (0.9e-6, 2.5e-6)
_ADHESIVE = (0.6e-6, 5e-6)
_FREE_BOUNDARY = 4.0  # factor
_SLOW_MOTION = 30.0  # factor
_ATOMS = (6e-6, 1e-4)
_LEAKAGE = (4e-6, 4e-5)
_THEORY = (0.02, 0.5)  # per load step alone


def seconds_of(kind: str, steps: "Iterable[tuple[Case, int]]") -> tuple[float, float] | None:
    """Typical and long processor time of so many load steps of each case (s); None where it was not measured."""
    low = high = 0.0
    for case, number in steps:
        if kind != "theory" and case.output.leakage and case.surface.shape:
            flow = number * case.surface.shape[0] * case.surface.shape[1]
            low, high = low + _LEAKAGE[0] * flow, high + _LEAKAGE[1] * flow
        points, slow, free = 1.0, False, kind != "theory" and case.elasticity.boundary != "periodic"
        if kind == "theory":
            own_low, own_high = _THEORY
        elif kind == "atomistic":
            if case.atomistic.method not in ("quasi_static", "overdamped"):
                return None
            points, (own_low, own_high) = float(case.lattice.atoms[0] * case.lattice.atoms[1]), _ATOMS
            slow = case.atomistic.method == "overdamped"
        else:
            shape = case.scales.shape
            points, (own_low, own_high) = float(shape[0] * shape[1]), _ADHESIVE if case.law.attracts else _HARD_WALL
            slow = case.solver.path == "overdamped" and case.law.attracts
        factor = number * points * (_SLOW_MOTION if slow else 1.0) * (_FREE_BOUNDARY if free else 1.0)
        low, high = low + own_low * factor, high + own_high * factor
    return low, high


def duration(seconds: float) -> str:
    """Write a time to one or two digits, in a unit that suits it."""
    for size, unit in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{max(seconds, 1.0):.0f} s"
