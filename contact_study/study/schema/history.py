"""Loading in time: cycles about the last point of a path, and the time to each of its points."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from contact_study.inputs.errors import InputError

if TYPE_CHECKING:
    from contact_study.study.schema.sections import LoadingSection

HISTORIES = ("points", "triangle", "sine")
OF_CYCLES = ("amplitude", "period", "cycles", "points_per_cycle")


def cycle(history: str, points: int) -> list[float]:
    """Return a cycle that begins upwards from zero, of amplitude one, at evenly spaced times after its start."""
    if history == "sine":
        return [math.sin(2 * math.pi * k / points) for k in range(1, points + 1)]
    phases = (k / points for k in range(1, points + 1))
    return [1 - abs(4 * ((t + 0.25) % 1) - 2) + 0.0 for t in phases]


def check_history(loading: "LoadingSection", defaults: Sequence[object]) -> None:
    """Raise InputError unless the keys of cycles and times fit to each other; ``defaults`` are those of OF_CYCLES."""
    kind, points = f'loading.history = "{loading.history}"', loading.points_per_cycle
    if loading.history == "points":
        given = [getattr(loading, name) for name in OF_CYCLES]
        for name, value, default in zip(OF_CYCLES, given, defaults, strict=True):
            if value != default:
                raise InputError(f'loading.{name}: belongs to loading.history = "triangle" or "sine"; leave it out')
    elif loading.amplitude is None:
        raise InputError(f"missing key loading.amplitude: {kind} needs it")
    elif points % 4:
        raise InputError(f"loading.points_per_cycle = {points}: extremes are points of multiples of 4; use one of them")
    elif loading.unload:
        raise InputError(f"loading.unload: {kind} ends at its last cycle; leave one out")
    path, several = loading.path[: loading.given], (loading.duration, loading.speed)
    for name, what, values in zip(("duration", "speed"), ("times", "speeds"), several, strict=True):
        if isinstance(values, tuple) and len(values) != len(path):
            raise InputError(f"loading.{name} holds {len(values)} {what} for {len(path)} points of loading.path")
    if loading.speed is None:
        return
    start = [0.0] if loading.control == "pressure" else []
    held = [value for before, value in zip([*start, *path], path[1 - len(start) :], strict=False) if before == value]
    if held and loading.duration is None:
        raise InputError(
            f"missing key loading.duration: loading.speed leads to no end of the dwell at {held[0]:g} in loading.path; "
            "give the time of dwells"
        )
    if loading.duration is not None and (not held or isinstance(loading.duration, tuple)):
        raise InputError(
            "loading.duration, loading.speed: give one of them; beside speeds, duration is the one time of all dwells, "
            "points that repeat the one before"
        )


def times_between(loading: "LoadingSection", origin: float) -> list[float]:
    """Return the time to each point of a path from the one before it, that of the first from an ``origin`` (s)."""
    path, count = loading.path[: loading.given], loading.given

    def each(value: float | tuple[float, ...] | None) -> list[float]:
        return list(value) if isinstance(value, tuple) else [value or 0.0] * count

    times = each(loading.duration)
    if loading.speed is not None:
        ways = [abs(after - before) for before, after in zip((origin, *path), path, strict=False)]
        times = [
            way / speed if way else dwell for way, speed, dwell in zip(ways, each(loading.speed), times, strict=True)
        ]
    if loading.unload:  # each interval takes as long as on the way there
        return times + times[:0:-1]
    cycles = len(loading.path) - count
    return times + [(loading.period or 0.0) / loading.points_per_cycle] * cycles
