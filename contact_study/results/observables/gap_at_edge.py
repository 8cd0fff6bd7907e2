"""The gap near the contact: its mean at a distance from the nearest point in contact."""

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.observables.autocorrelation import RING_EDGES, RINGS
from contact_study.results.state import InterfaceState, Observable, Value, noted


def distance_to_contact(contact: np.ndarray, spacing: tuple[float, float], periodic: bool = True) -> np.ndarray:
    """Distance of each point (m) to the nearest one in contact, across the edges of a periodic map; infinite without.

    ``spacing`` is that of points along y and x (m).
    """
    from scipy import ndimage  # slow to import

    if not contact.any():
        return np.full(contact.shape, np.inf)
    if not periodic:
        return ndimage.distance_transform_edt(~contact, spacing)
    shortest = min(n * step for n, step in zip(contact.shape, spacing, strict=True))
    for part in (8, 4, 1):  # few points are far from contact; a whole period further is enough for all
        margins = [-(-n // part) for n in contact.shape]
        whole = ndimage.distance_transform_edt(~np.pad(contact, [(n, n) for n in margins], mode="wrap"), spacing)
        distance = whole[margins[0] : -margins[0], margins[1] : -margins[1]]
        if distance.max() <= shortest / part:
            break
    return distance


def _gap_at_edge(state: InterfaceState, _: Bins) -> dict[str, Value]:
    if state.spacing is None:
        return {}
    side = min(n * step for n, step in zip(state.contact.shape, state.spacing, strict=True))
    distance = distance_to_contact(state.contact, state.spacing, state.periodic)[~state.contact] / side
    gap = state.gap[~state.contact]
    # The slack keeps a distance on a ring's edge inside, whatever its rounding.
    ring = np.searchsorted(RING_EDGES * (1 + 1e-12), distance, side="left") - 1
    inside = (ring >= 0) & (ring < RINGS)
    points = np.bincount(ring[inside], minlength=RINGS)
    sums = np.bincount(ring[inside], weights=gap[inside] - state.equilibrium_distance, minlength=RINGS)
    return {"gap_at_distance": np.divide(sums, points, out=np.full(RINGS, np.nan), where=points > 0)}


GAP_AT_EDGE = Observable(
    {
        "gap_at_distance": noted(
            "m",
            "mean gap minus equilibrium distance at a distance from the nearest contact",
            "between points of the grid: the contact's edge is about half of a spacing nearer",
            ("step", "relative_distance"),
        )
    },
    _gap_at_edge,
    averaged=False,  # rings without a point have no mean
)
