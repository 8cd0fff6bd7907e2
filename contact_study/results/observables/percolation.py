"""Percolation: whether contact, or the gap beside it, goes all the way around the periodic cell, or through a free one.

Points are connected to their neighbours along y and x, not over corners. A patch goes around if a chain of it leads
from a point to the same point of a neighbouring period: the patches of the plain map are joined over its edges, each
join carries the period that it crosses, and two ways to one patch that differ in periods make a way around. A surface
with free boundaries has no neighbouring period: a patch goes through it if it touches two opposite rims, along y or
along x.
"""

from collections import defaultdict

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.observables.solver_report import FLAG
from contact_study.results.state import InterfaceState, Observable, Value, Variable


def goes_around(points: np.ndarray) -> bool:
    """Whether a connected patch of a periodic map meets its own image in a neighbouring period.

    Parameters
    ----------
    points : numpy.ndarray of bool, shape (ny, nx)
        The map.
    """
    from scipy import ndimage  # slow to import, and a run of a theory loads this file for its dataset entries alone

    labels, _ = ndimage.label(points)
    joins: dict[int, set[tuple[int, int, int]]] = defaultdict(set)
    for first, last, period in ((labels[0], labels[-1], (1, 0)), (labels[:, 0], labels[:, -1], (0, 1))):
        meet = (first > 0) & (last > 0)
        for here, there in set(zip(last[meet].tolist(), first[meet].tolist(), strict=True)):
            joins[here].add((there, *period))
            joins[there].add((here, -period[0], -period[1]))
    periods: dict[int, tuple[int, int]] = {}
    for start in joins:
        if start in periods:
            continue
        periods[start] = (0, 0)
        waiting = [start]
        while waiting:
            here = waiting.pop()
            for there, down, across in joins[here]:
                reached = (periods[here][0] + down, periods[here][1] + across)
                if there not in periods:
                    periods[there] = reached
                    waiting.append(there)
                elif periods[there] != reached:
                    return True
    return False


def goes_through(points: np.ndarray) -> bool:
    """Whether a connected patch of a map that ends at its edges touches two opposite ones, along y or along x.

    Parameters
    ----------
    points : numpy.ndarray of bool, shape (ny, nx)
        The map.
    """
    from scipy import ndimage  # as above

    labels, _ = ndimage.label(points)
    opposite = ((labels[0], labels[-1]), (labels[:, 0], labels[:, -1]))
    return any(bool(np.intersect1d(first[first > 0], last).size) for first, last in opposite)


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    percolates = goes_around if state.periodic else goes_through
    return {"contact_percolates": percolates(state.contact), "gap_percolates": percolates(~state.contact)}


PERCOLATION = Observable(
    {
        "contact_percolates": Variable(
            "1",
            "whether a connected contact goes around the periodic cell, or joins opposite rims of a free one",
            kind="flag",
            attrs=FLAG,
        ),
        "gap_percolates": Variable(
            "1",
            "whether a connected gap goes around the periodic cell, or joins opposite rims of a free one",
            kind="flag",
            attrs=FLAG,
        ),
    },
    _read,
)
