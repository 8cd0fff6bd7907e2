"""Autocorrelation of the contact."""

from functools import lru_cache

import numpy as np

from contact_study.results.state import Observable, Variable

# Half octaves down from half of the shorter side: a 700th of it is at least a point on the usual grids.
RINGS = 17
RING_EDGES = 0.5 * 2.0 ** (-0.5 * np.arange(RINGS, -1, -1))
RELATIVE_DISTANCE = np.sqrt(RING_EDGES[1:] * RING_EDGES[:-1])


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


_PAIRS = "share of the pairs of points a distance apart that are both in contact"
AUTOCORRELATION = Observable(
    {"contact_autocorrelation": Variable("1", _PAIRS, ("step", "relative_distance"))},
    lambda state, _: (
        {}
        if state.spacing is None
        else {"contact_autocorrelation": contact_autocorrelation(state.contact, state.spacing, state.periodic)}
    ),
    averaged=False,  # rings without a lag have no mean
)
