"""How contact at one point goes with contact at another: the autocorrelation of the contact, radially averaged.

With χ = 1 in contact and 0 elsewhere, c(r) = <χ(x) χ(x + r)> over the periodic cell is the share of the pairs of points
a distance r apart of which both are in contact: the relative contact area at r = 0, its square where contacts know
nothing of one another. −c'(0) is the length of the contact's edge per area over π (for volumes P. Debye, H. R. Anderson
& H. Brumberger, J. Appl. Phys. 28, 679 (1957)). With free boundaries the pairs are those inside the surface, the fewer
the longer the lag. Distances are in units of the cell's shorter side, so that all grids and sizes share their rings.
"""

from functools import lru_cache

import numpy as np
from scipy import fft

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable

# Half octaves down from half of the shorter side: a 700th of it is a point and more on the usual grids.
RINGS = 17
RING_EDGES = 0.5 * 2.0 ** (-0.5 * np.arange(RINGS, -1, -1))
RELATIVE_DISTANCE = np.sqrt(RING_EDGES[1:] * RING_EDGES[:-1])


@lru_cache(maxsize=2)
def _rings(
    shape: tuple[int, int], spacing: tuple[float, float], periodic: bool
) -> tuple[tuple[int, int], np.ndarray, np.ndarray]:
    """Shape of the transforms, ring of each lag on it, RINGS beyond the largest, and how many pairs each ring has."""
    # Twice the map, so that no lag meets the other side of it.
    padded = (
        shape if periodic else (fft.next_fast_len(2 * shape[0] - 1, True), fft.next_fast_len(2 * shape[1] - 1, True))
    )
    steps = [np.minimum(np.arange(n), n - np.arange(n)) for n in padded]
    down, across = (step * d for step, d in zip(steps, spacing, strict=True))
    side = min(n * d for n, d in zip(shape, spacing, strict=True))
    distance = np.hypot(down[:, None], across[None, :]) / side
    # Half a side is within the last ring, and by a rounding so is a lag that stands on an edge.
    ring = np.searchsorted(RING_EDGES * (1 + 1e-12), distance.ravel(), side="left") - 1
    ring[(ring < 0) | (ring >= RINGS)] = RINGS
    inside = [np.full(n, n) if periodic else np.maximum(n - step, 0) for n, step in zip(shape, steps, strict=True)]
    pairs = np.outer(*inside).ravel()
    return padded, ring, np.bincount(ring, weights=pairs, minlength=RINGS + 1)[:RINGS]


def contact_autocorrelation(contact: np.ndarray, spacing: tuple[float, float], periodic: bool = True) -> np.ndarray:
    """Share of the pairs of points a lag r apart for which χ(x) χ(x + r) = 1, over all lags of each ring.

    Parameters
    ----------
    contact : numpy.ndarray of bool, shape (ny, nx)
        Whether a point is in contact.
    spacing : tuple of float
        Distance of points along y and x (m).
    periodic : bool, optional
        Whether pairs go over the edges of the map; else they are those inside it.

    Returns
    -------
    numpy.ndarray, shape (RINGS,)
        Not a number in a ring without a lag.
    """
    shape, ring, pairs = _rings((contact.shape[0], contact.shape[1]), spacing, periodic)
    spectrum = fft.rfft2(contact.astype(float), shape)
    touching = fft.irfft2(spectrum.real**2 + spectrum.imag**2, shape)
    sums = np.bincount(ring, weights=touching.ravel(), minlength=RINGS + 1)[:RINGS]
    return np.divide(sums, pairs, out=np.full(RINGS, np.nan), where=pairs > 0)


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    if state.spacing is None:
        return {}
    return {"contact_autocorrelation": contact_autocorrelation(state.contact, state.spacing, state.periodic)}


CONTACT_AUTOCORRELATION = Observable(
    {
        "contact_autocorrelation": Variable(
            "1", "share of the pairs of points a distance apart that are both in contact", ("step", "relative_distance")
        ),
    },
    _read,
    averaged=False,  # rings without a lag have no mean
)
