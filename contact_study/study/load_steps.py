"""When a point of one loading path is a point of another: the one rule by which paths are matched.

Two points are the same if the prescribed value, the branch and the number of earlier visits are: contacts remember,
and the second time at a pressure is not the first.
"""

from collections import Counter
from collections.abc import Iterable

import numpy as np

from contact_study.study.case import Case

PathPoint = tuple[str, int, int]  # prescribed value to twelve digits, 1 on the way back, earlier visits


def path_points(prescribed: Iterable[float], unloading: Iterable[int]) -> list[PathPoint | None]:
    """Name the points of a path; None where it is padded, by NaN. ``unloading`` is 1 at each point on the way back."""
    visits: Counter[tuple[str, int]] = Counter()
    points: list[PathPoint | None] = []
    for value, back in zip(prescribed, unloading, strict=True):
        if np.isnan(value):
            points.append(None)
            continue
        # The same pressure written in another unit differs in the last of sixteen digits; no zero has a sign.
        key = (f"{value + 0.0:.12g}", int(back))
        points.append((*key, visits[key]))
        visits[key] += 1
    return points


def path_points_of(case: Case) -> list[PathPoint | None]:
    """Names of the points of a case's path."""
    values, branches = zip(*case.path, strict=True)
    return path_points(values, (branch == "unloading" for branch in branches))
