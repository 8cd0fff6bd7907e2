"""Clusters of contact, and percolation of contact and gap."""

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import FLAG, InterfaceState, Observable, Value, Variable

_AROUND = "around the periodic cell, or between opposite rims of a free one"


def cluster_map(contact: np.ndarray, periodic: bool = True) -> np.ndarray:
    """Number the clusters of a map, chains of neighbours along y or x, by size: 0 without contact, 1 in the largest."""
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


def percolates(points: np.ndarray, periodic: bool = True) -> bool:
    """Whether a cluster of a map goes around the periodic cell, or joins two opposite rims of a free one.

    A simple way around crosses the edges of one axis an odd number of times: a cell of twice the periods tells all.
    """
    from scipy import ndimage
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    labels, count = ndimage.label(points)
    edges = ((labels[0], labels[-1], 1), (labels[:, 0], labels[:, -1], 2))
    if not periodic or not count:
        return any(bool(np.intersect1d(first[first > 0], last).size) for first, last, _ in edges)
    # Four copies of the map, numbered by the parity of the periods along both axes, 1 and 2.
    joins = []
    for first, last, axis in edges:
        meet = (first > 0) & (last > 0)
        joins += [(last[meet] - 1 + count * copy, first[meet] - 1 + count * (copy ^ axis)) for copy in range(4)]
    one, other = np.concatenate(joins, axis=1)
    joined = coo_array((np.ones(one.size), (one, other)), shape=(4 * count, 4 * count))
    clusters = connected_components(joined, directed=False)[1].reshape(4, count)
    return bool((clusters[1:] == clusters[0]).any())


def _clusters(state: InterfaceState, _: Bins) -> dict[str, Value]:
    sizes = np.bincount(cluster_map(state.contact, state.periodic).ravel())[1:]
    return {
        "cluster_count": sizes.size,
        "largest_cluster_area": float(sizes.max(initial=0) / state.contact.size),
        "contact_percolates": percolates(state.contact, state.periodic),
        "gap_percolates": percolates(~state.contact, state.periodic),
    }


CLUSTERS = Observable(
    {
        "cluster_count": Variable("1", "number of contact clusters", kind="count"),
        "largest_cluster_area": Variable("1", "area of the largest contact cluster over nominal area"),
        "contact_percolates": Variable("1", f"connected contact {_AROUND}", kind="flag", attrs=FLAG),
        "gap_percolates": Variable("1", f"connected gap {_AROUND}", kind="flag", attrs=FLAG),
    },
    _clusters,
)
