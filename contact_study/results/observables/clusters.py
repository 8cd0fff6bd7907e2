"""Clusters of contact and their sizes, and percolation of contact and gap."""

import math
from collections import defaultdict

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import FLAG, InterfaceState, Observable, Value, Variable, noted

# Octaves of the area of a patch over that of the cell, down to a point of a grid of 8192².
PATCH_EDGES = 2.0 ** np.arange(-26, 1)
RELATIVE_PATCH_AREA = np.sqrt(PATCH_EDGES[1:] * PATCH_EDGES[:-1])
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


def channels(points: np.ndarray, periodic: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """Points of the clusters that go around the periodic cell along y, and along x, or join these rims of a free one.

    A cluster goes around an axis if a walk through it ends at its start in another period along that axis.
    """
    from scipy import ndimage

    labels, count = ndimage.label(points)
    through = np.zeros((2, count + 1), bool)
    rims = (labels[-1], labels[0]), (labels[:, -1], labels[:, 0])
    if not periodic:
        for axis, (last, first) in enumerate(rims):
            through[axis, np.intersect1d(first[first > 0], last)] = True
        return through[0][labels], through[1][labels]
    meetings: dict[int, list[tuple[int, np.ndarray]]] = defaultdict(list)  # over the edges, with the step in periods
    for step, (last, first) in zip(np.eye(2, dtype=int), rims, strict=True):
        meet = (last > 0) & (first > 0)
        for here, there in np.unique([last[meet], first[meet]], axis=1).T.tolist():
            meetings[here].append((there, step))
            meetings[there].append((here, -step))
    period: dict[int, np.ndarray] = {}  # in which a walk first meets a label
    for start in meetings:
        if start in period:
            continue
        period[start], cluster, around = np.zeros(2, int), [start], np.zeros(2, bool)
        for here in cluster:
            for there, step in meetings[here]:
                if there not in period:
                    period[there] = period[here] + step
                    cluster.append(there)
                around |= period[there] != period[here] + step
        through[:, cluster] = around[:, None]
    return through[0][labels], through[1][labels]


def percolates(points: np.ndarray, periodic: bool = True) -> bool:
    """Whether a cluster of a map goes around the periodic cell, or joins two opposite rims of a free one."""
    return any(bool(through.any()) for through in channels(points, periodic))


def _clusters(state: InterfaceState, _: Bins) -> dict[str, Value]:
    sizes = np.bincount(cluster_map(state.contact, state.periodic).ravel())[1:]
    shares = sizes / state.contact.size
    values: dict[str, Value] = {
        "cluster_count": sizes.size,
        "largest_cluster_area": float(sizes.max(initial=0) / state.contact.size),
        "patch_size_density": np.histogram(shares, PATCH_EDGES)[0] / np.diff(PATCH_EDGES),
        "contact_percolates": percolates(state.contact, state.periodic),
        "gap_percolates": percolates(~state.contact, state.periodic),
    }
    if state.spacing is not None:
        diameters = 2 * np.sqrt(sizes * math.prod(state.spacing) / np.pi)
        values["mean_patch_diameter"] = float(np.average(diameters, weights=sizes)) if sizes.size else 0.0
    return values


CLUSTERS = Observable(
    {
        "cluster_count": Variable("1", "number of contact clusters", kind="count"),
        "largest_cluster_area": Variable("1", "area of the largest contact cluster over nominal area"),
        "mean_patch_diameter": noted(
            "m",
            "mean diameter of contact clusters, weighted by their areas",
            "of the circle of a cluster's area; zero without contact",
        ),
        "patch_size_density": noted(
            "1",
            "number of contact clusters per relative area of a cluster",
            "in octaves; its integral is cluster_count, and with the relative area relative_contact_area",
            ("step", "relative_patch_area"),
        ),
        "contact_percolates": Variable("1", f"connected contact {_AROUND}", kind="flag", attrs=FLAG),
        "gap_percolates": Variable("1", f"connected gap {_AROUND}", kind="flag", attrs=FLAG),
    },
    _clusters,
)
