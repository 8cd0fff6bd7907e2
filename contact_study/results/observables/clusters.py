"""Contact clusters: their number, the largest area, and percolation of contact and gap.

Points belong to one cluster if a chain of neighbours along y or x connects them; a shared corner does not. Clusters
continue across the edges of a periodic cell. A cluster percolates a periodic cell if it meets its own image in a
neighbouring period: clusters of the plain map are joined across its edges, each join carries the period that it
crosses, and two ways to one cluster that differ in periods make a way around. With free boundaries a cluster percolates
if it touches two opposite rims.
"""

from collections import defaultdict

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import FLAG, InterfaceState, Observable, Value, Variable


def cluster_map(contact: np.ndarray, periodic: bool = True) -> np.ndarray:
    """Number the clusters of a map by size.

    Parameters
    ----------
    contact : numpy.ndarray of bool, shape (ny, nx)
        Whether a point is in contact.
    periodic : bool, optional
        Whether clusters continue at the opposite edge of the map.

    Returns
    -------
    numpy.ndarray of int, shape (ny, nx)
        0 without contact, 1 in the largest cluster, 2 in the next, and so on.
    """
    from scipy import ndimage  # slow to import
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    labels, count = ndimage.label(contact)
    if not count:
        return labels
    one = np.concatenate([labels[0], labels[:, 0]])
    other = np.concatenate([labels[-1], labels[:, -1]])
    meet = (one > 0) & (other > 0) & periodic
    joined = coo_array((np.ones(np.count_nonzero(meet)), (one[meet] - 1, other[meet] - 1)), shape=(count, count))
    clusters, cluster_of = connected_components(joined, directed=False)
    points = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    sizes = np.bincount(cluster_of, weights=points, minlength=clusters)
    rank = np.empty(clusters, int)
    rank[np.argsort(-sizes, kind="stable")] = np.arange(1, clusters + 1)
    return np.concatenate([[0], rank[cluster_of]])[labels]


def cluster_sizes(contact: np.ndarray, periodic: bool = True) -> np.ndarray:
    """Points of each cluster of a map (see :func:`cluster_map`), shape (clusters,), the largest first."""
    return np.bincount(cluster_map(contact, periodic).ravel())[1:]


def percolates(points: np.ndarray, periodic: bool = True) -> bool:
    """Whether a cluster of a map goes around the periodic cell, or joins two opposite rims of a free one.

    Parameters
    ----------
    points : numpy.ndarray of bool, shape (ny, nx)
        The map.
    periodic : bool, optional
        Whether it continues at its opposite edges.
    """
    from scipy import ndimage

    labels, _ = ndimage.label(points)
    edges = ((labels[0], labels[-1], (1, 0)), (labels[:, 0], labels[:, -1], (0, 1)))
    if not periodic:
        return any(bool(np.intersect1d(first[first > 0], last).size) for first, last, _ in edges)
    joins: dict[int, set[tuple[int, int, int]]] = defaultdict(set)
    for first, last, period in edges:
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


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    sizes = cluster_sizes(state.contact, state.periodic)
    return {
        "cluster_count": sizes.size,
        "largest_cluster_area": float(sizes.max(initial=0) / state.contact.size),
        "contact_percolates": percolates(state.contact, state.periodic),
        "gap_percolates": percolates(~state.contact, state.periodic),
    }


def _percolation(what: str) -> Variable:
    words = f"connected {what} around the periodic cell, or between opposite rims of a free one"
    return Variable("1", words, kind="flag", attrs=FLAG)


CLUSTERS = Observable(
    {
        "cluster_count": Variable("1", "number of contact clusters", kind="count"),
        "largest_cluster_area": Variable("1", "area of the largest contact cluster over nominal area"),
        "contact_percolates": _percolation("contact"),
        "gap_percolates": _percolation("gap"),
    },
    _read,
)
