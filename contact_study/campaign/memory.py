"""Whether a study can fit this machine at all, said before anything is allocated."""

import os
from pathlib import Path

from contact_study.problem.errors import InputError
from contact_study.problem.study import Study

# Height, gap, pressure, displacement, its spectrum, the kernel and a few of the solver's own: a dozen doubles.
_BYTES_PER_POINT = 100


def check_memory(study: Study) -> None:
    """Refuse a grid that the machine's memory cannot hold; the system would otherwise kill the run without a word.

    Raises
    ------
    InputError
        If the largest grid of the study needs more than all memory.
    """
    shape = max((case.surface.shape or (0, 0) for case in study.cases), key=lambda shape: shape[0] * shape[1])
    require_memory(shape[0] * shape[1] * _BYTES_PER_POINT, f"surface.shape = {list(shape)}", "fewer points")


def grid_fits(shape: tuple[int, int]) -> bool:
    """Whether the machine's memory holds a simulation on so many points."""
    return shape[0] * shape[1] <= most_points()


def most_points() -> float:
    """Points of the largest grid that the machine's memory holds."""
    return _memory() / _BYTES_PER_POINT


def memory_in_words(shape: tuple[int, int]) -> str:
    """What a simulation on so many points needs, such as ``1.2 GB``."""
    needed = shape[0] * shape[1] * _BYTES_PER_POINT
    return f"{needed / 1e9:.2g} GB" if needed >= 1e8 else f"{needed / 1e6:.2g} MB"


def require_memory(needed: float, culprit: str, advice: str) -> None:
    """Raise InputError, naming the culprit, if ``needed`` bytes are more than all memory."""
    available = _memory()
    if needed > available:
        raise InputError(
            f"{culprit}: needs at least {needed / 1e9:.3g} GB of memory, this machine has {available / 1e9:.3g} GB; "
            f"use {advice}"
        )


def _memory() -> float:
    """Bytes that this process may use: the machine's, or less in a container."""
    try:
        physical = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):  # not on every system
        physical = float("inf")
    try:
        return min(physical, float(Path("/sys/fs/cgroup/memory.max").read_text()))
    except (OSError, ValueError):  # no such group, or "max"
        return physical
