"""Observables of the map of contact: its area and edge, its clusters and percolation, its autocorrelation."""

from functools import lru_cache

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import FLAG, InterfaceState, Observable, Value, Variable

# A point in contact counts with its whole cell. V. A. Yastrebov, G. Anciaux & J.-F. Molinari, Tribol. Int. 114, 161
# (2017), arXiv:1701.02727, correct that by A' = A − (π − 1 + ln 2)/24 · S Δx, where S is the length of the edge along
# the sides of the cells, 4/π of the edge's own if that has no preferred direction; a free rim is no such side.
OVERCOUNT = (np.pi - 1 + np.log(2)) / 24
# Half octaves down from half of the shorter side: a 700th of it is at least a point on the usual grids.
RINGS = 17
RING_EDGES = 0.5 * 2.0 ** (-0.5 * np.arange(RINGS, -1, -1))
RELATIVE_DISTANCE = np.sqrt(RING_EDGES[1:] * RING_EDGES[:-1])
_AROUND = "around the periodic cell, or between opposite rims of a free one"


def edge_sides(contact: np.ndarray, periodic: bool = True) -> tuple[int, int]:
    """Sides along x and along y between cells in contact and others, across the edges of a periodic map too."""
    first = 0 if periodic else 1
    along_x = int(np.count_nonzero((contact != np.roll(contact, 1, axis=0))[first:]))
    along_y = int(np.count_nonzero((contact != np.roll(contact, 1, axis=1))[:, first:]))
    return along_x, along_y


def _area(state: InterfaceState, _: Bins) -> dict[str, Value]:
    areas = {"contact": state.contact, "repulsive": state.pressure > 0}
    sides = {kind: edge_sides(area, state.periodic) for kind, area in areas.items()}
    values: dict[str, Value] = {f"relative_{kind}_area": float(np.mean(area)) for kind, area in areas.items()}
    for kind, area in areas.items():
        values[f"corrected_{kind}_area"] = max(float(np.mean(area)) - OVERCOUNT * sum(sides[kind]) / area.size, 0.0)
    if state.spacing is not None:
        dy, dx = state.spacing
        along_x, along_y = sides["contact"]
        values["contact_perimeter"] = np.pi / 4 * (along_x * dx + along_y * dy) / (state.contact.size * dy * dx)
    return values


_CORRECTED = "over nominal area, corrected for the grid at its edge"
AREA = Observable(
    {
        "relative_contact_area": Variable("1", "contact area over nominal area"),
        "relative_repulsive_area": Variable("1", "area under positive pressure over nominal area"),
        "corrected_contact_area": Variable("1", f"contact area {_CORRECTED}"),
        "corrected_repulsive_area": Variable("1", f"area under positive pressure {_CORRECTED}"),
        "contact_perimeter": Variable("m-1", "length of the contact's edge, assumed isotropic, over nominal area"),
    },
    _area,
)


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


@lru_cache(maxsize=2)
def _rings(
    shape: tuple[int, int], spacing: tuple[float, float], periodic: bool
) -> tuple[tuple[int, ...], np.ndarray, np.ndarray]:
    """Shape of the transforms, ring of each lag on it (RINGS beyond the largest), and pairs of each ring."""
    from scipy import fft  # slow to import

    # With free boundaries a map twice as large: no lag reaches across the edge.
    padded = shape if periodic else tuple(fft.next_fast_len(2 * n - 1, True) for n in shape)
    steps = [np.minimum(np.arange(n), n - np.arange(n)) for n in padded]
    down, across = (step * d for step, d in zip(steps, spacing, strict=True))
    side = min(n * d for n, d in zip(shape, spacing, strict=True))
    distance = np.hypot(down[:, None], across[None, :]) / side
    # The slack keeps a lag on a ring's edge inside, whatever its rounding.
    ring = np.searchsorted(RING_EDGES * (1 + 1e-12), distance.ravel(), side="left") - 1
    ring[(ring < 0) | (ring >= RINGS)] = RINGS
    inside = [np.full(n, n) if periodic else np.maximum(n - step, 0) for n, step in zip(shape, steps, strict=True)]
    pairs = np.outer(*inside).ravel()
    return padded, ring, np.bincount(ring, weights=pairs, minlength=RINGS + 1)[:RINGS]


def contact_autocorrelation(contact: np.ndarray, spacing: tuple[float, float], periodic: bool = True) -> np.ndarray:
    """Average χ(x) χ(x + r), χ = 1 in contact, over the pairs of points of each ring of lags r; NaN without a lag.

    −c'(0) is the length of the edge per area over π (P. Debye, H. R. Anderson & H. Brumberger, J. Appl. Phys. 28, 679
    (1957), for volumes). Rings are in units of the shorter side, ``spacing`` that of points along y and x (m).
    """
    from scipy import fft

    shape, ring, pairs = _rings((contact.shape[0], contact.shape[1]), spacing, periodic)
    spectrum = fft.rfft2(contact.astype(float), shape)
    touching = fft.irfft2(spectrum.real**2 + spectrum.imag**2, shape)
    sums = np.bincount(ring, weights=touching.ravel(), minlength=RINGS + 1)[:RINGS]
    return np.divide(sums, pairs, out=np.full(RINGS, np.nan), where=pairs > 0)


def _autocorrelation(state: InterfaceState, _: Bins) -> dict[str, Value]:
    if state.spacing is None:
        return {}
    return {"contact_autocorrelation": contact_autocorrelation(state.contact, state.spacing, state.periodic)}


_PAIRS = "share of the pairs of points a distance apart that are both in contact"
AUTOCORRELATION = Observable(
    {"contact_autocorrelation": Variable("1", _PAIRS, ("step", "relative_distance"))},
    _autocorrelation,
    averaged=False,  # rings without a lag have no mean
)
