"""How long a load step takes, roughly, from what was measured; docs/performance.md explains the measurements."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from contact_study.study.case import Case

# Processor time per load step and point, or atom (s): from a typical to a slow step of one core of 2023.
# Continuum: scripts/benchmark_grids.py (data/benchmark_grids.csv). Atoms, free boundaries, slow motion and theories:
# wall_time in datasets of the example studies.
_HARD_WALL = (0.9e-6, 2.5e-6)
_ADHESIVE = (0.6e-6, 5e-6)
_FREE_BOUNDARY = 4.0  # factor
_SLOW_MOTION = 30.0  # factor
_ATOMS = (6e-6, 1e-4)
_THEORY = (0.02, 0.5)  # per load step alone


def seconds_per_step(kind: str, case: "Case") -> tuple[float, float] | None:
    """Return a typical and a long processor time of a load step of a model (s); None where it was not measured."""
    if kind == "theory":
        return _THEORY
    if kind == "atomistic":
        if case.atomistic.method not in ("quasi_static", "overdamped"):
            return None
        points, (low, high) = float(case.lattice.atoms[0] * case.lattice.atoms[1]), _ATOMS
        slow = case.atomistic.method == "overdamped"
    else:
        shape = case.scales.shape
        points, (low, high) = float(shape[0] * shape[1]), _ADHESIVE if case.law.attracts else _HARD_WALL
        slow = case.solver.path == "overdamped" and case.law.attracts
    factor = (_SLOW_MOTION if slow else 1.0) * (_FREE_BOUNDARY if case.elasticity.boundary == "free" else 1.0)
    return low * points * factor, high * points * factor


def seconds_of(kind: str, steps: "Iterable[tuple[Case, int]]") -> tuple[float, float] | None:
    """Return the processor time of so many steps of each case, as :func:`seconds_per_step`."""
    each = [(number, seconds_per_step(kind, case)) for case, number in steps]
    if any(found is None for _, found in each):
        return None
    low, high = (sum(number * found[end] for number, found in each if found) for end in (0, 1))
    return low, high


def duration(seconds: float) -> str:
    """Write a time to one or two digits, in a unit that suits it."""
    for size, unit in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.0f} s" if seconds >= 1 else "1 s"
