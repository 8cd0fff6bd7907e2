"""Contact clusters: how many separate patches the contact consists of, and how large the largest is.

Points of contact belong to one cluster if a chain of contact points connects them, each beside the next along y or x,
across the edges of the periodic cell too (a surface with free boundaries ends there); points that share only a corner
are not connected. A distribution of the sizes would need bins of area, which studies do not have.
"""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable


def cluster_map(contact: np.ndarray, periodic: bool = True) -> np.ndarray:
    """Which cluster of a map each point belongs to.

    Parameters
    ----------
    contact : numpy.ndarray of bool, shape (ny, nx)
        Whether a point is in contact.
    periodic : bool, optional
        Whether patches that end at an edge of the map go on at the opposite one.

    Returns
    -------
    numpy.ndarray of int, shape (ny, nx)
        0 without contact, 1 in the largest cluster, 2 in the next, and so on.
    """
    from scipy import ndimage  # slow to import, and a run of a theory loads this file for its dataset entries alone

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


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    sizes = cluster_sizes(state.contact, state.periodic)
    return {
        "cluster_count": sizes.size,
        "largest_cluster_area": float(sizes.max(initial=0) / state.contact.size),
    }


CONTACT_CLUSTERS = Observable(
    {
        "cluster_count": Variable("1", "connected patches of contact", kind="count"),
        "largest_cluster_area": Variable("1", "area of the largest connected contact over nominal area"),
    },
    _read,
)
