"""How contact at one point goes with contact at another: the autocorrelation of the contact, radially averaged.

With χ = 1 in contact and 0 elsewhere, c(r) = <χ(x) χ(x + r)> over the periodic cell is the share of the pairs of points
a distance r apart of which both are in contact: the relative contact area at r = 0, its square where contacts know
nothing of one another. −c'(0) is the length of the contact's edge per area over π (P. Debye, H. R. Anderson &
H. Brumberger, J. Appl. Phys. 28, 679 (1957) have it for volumes; looked up, not read). Distances are in units of the
cell's shorter side, so that all grids and sizes share their rings.
"""

from functools import lru_cache

import numpy as np
from scipy import fft

from contact_study.fields.distributions import Bins
from contact_study.observables.base import InterfaceState, Observable, Value, Variable

# Half octaves down from half of the shorter side: a 700th of it is a point and more on the usual grids.
RINGS = 17
RING_EDGES = 0.5 * 2.0 ** (-0.5 * np.arange(RINGS, -1, -1))
RELATIVE_DISTANCE = np.sqrt(RING_EDGES[1:] * RING_EDGES[:-1])


@lru_cache(maxsize=2)
def _rings(shape: tuple[int, int], spacing: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Ring of each lag of a periodic map, RINGS beyond the largest, and how many lags each has."""
    down, across = (np.minimum(np.arange(n), n - np.arange(n)) * d for n, d in zip(shape, spacing, strict=True))
    side = min(n * d for n, d in zip(shape, spacing, strict=True))
    distance = np.hypot(down[:, None], across[None, :]) / side
    # Half a side is within the last ring, and by a rounding so is a lag that stands on an edge.
    ring = np.searchsorted(RING_EDGES * (1 + 1e-12), distance.ravel(), side="left") - 1
    ring[(ring < 0) | (ring >= RINGS)] = RINGS
    return ring, np.bincount(ring, minlength=RINGS + 1)[:RINGS]


def contact_autocorrelation(contact: np.ndarray, spacing: tuple[float, float]) -> np.ndarray:
    """Mean of χ(x) χ(x + r) over a periodic map and over the lags r of each ring.

    Parameters
    ----------
    contact : numpy.ndarray of bool, shape (ny, nx)
        Whether a point is in contact.
    spacing : tuple of float
        Distance of points along y and x (m).

    Returns
    -------
    numpy.ndarray, shape (RINGS,)
        Not a number in a ring without a lag.
    """
    ring, lags = _rings((contact.shape[0], contact.shape[1]), spacing)
    spectrum = fft.rfft2(contact.astype(float))
    pairs = fft.irfft2(spectrum.real**2 + spectrum.imag**2, contact.shape) / contact.size
    sums = np.bincount(ring, weights=pairs.ravel(), minlength=RINGS + 1)[:RINGS]
    return np.divide(sums, lags, out=np.full(RINGS, np.nan), where=lags > 0)


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    if state.spacing is None:
        return {}
    return {"contact_autocorrelation": contact_autocorrelation(state.contact, state.spacing)}


CONTACT_AUTOCORRELATION = Observable(
    {
        "contact_autocorrelation": Variable(
            "1", "share of the pairs of points a distance apart that are both in contact", ("step", "relative_distance")
        ),
    },
    _read,
    averaged=False,  # rings without a lag have no mean
)
