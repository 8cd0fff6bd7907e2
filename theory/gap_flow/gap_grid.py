"""Nodes of the local gap: the intervals that belong to them, and the stress of the law within these."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit

from contact_study.physics.laws.base import TractionLaw

# Pieces of a node's interval over which the distribution of stress is summed.
_PIECES = 32


@dataclass(frozen=True, eq=False)
class GapNodes:
    """Nodes that all states of a curve share.

    Attributes
    ----------
    law : TractionLaw
        The law, in units of its length and the contact modulus.
    gaps : numpy.ndarray, shape (n,)
        Rising nodes of the local gap in units of that length.
    """

    law: TractionLaw
    gaps: np.ndarray

    @cached_property
    def edges(self) -> np.ndarray:
        """Ends of the intervals over which the nodes' weights are spread, shape (n + 1,)."""
        middle = 0.5 * (self.gaps[1:] + self.gaps[:-1])
        return np.concatenate([self.gaps[:1], middle, self.gaps[-1:]])

    def stress_masses(self, cubics: np.ndarray, bins: np.ndarray) -> np.ndarray:
        """Area in each bin of the stress σ = −φ'(u), shape (m,) for m + 1 rising ends in units of the modulus.

        In each piece of an interval the area is spread evenly over its stresses, of which the steep repulsion holds
        many.

        Parameters
        ----------
        cubics : numpy.ndarray, shape (4, n)
            Area below a gap in each interval, as coefficients of the distance from its lower end, the third power
            first.
        bins : numpy.ndarray, shape (m + 1,)
            Ends of the bins.
        """
        ends = np.arange(_PIECES + 1) / _PIECES
        powers = np.diff(ends ** np.array([[3], [2], [1]]))
        shares = (cubics[:3] * np.diff(self.edges) ** np.array([[3], [2], [1]])).T @ powers
        masses = np.zeros(bins.size - 1)
        _spread(self._stress, shares.ravel(), bins, masses)
        return masses

    @cached_property
    def _stress(self) -> np.ndarray:
        """σ at the ends of all pieces."""
        count = self.gaps.size
        return -self.law.traction(np.interp(np.arange(_PIECES * count + 1) / _PIECES, np.arange(count + 1), self.edges))


@njit(cache=True, nogil=True, error_model="numpy")
def _spread(stress, shares, bins, masses):
    """Add the share of each piece, spread evenly from the stress at its one end to that at the other, to the bins."""
    last = masses.size - 1
    bin_ = 0  # pieces follow each other, and so do their bins
    for piece in range(shares.size):
        share = shares[piece]
        low, high = min(stress[piece], stress[piece + 1]), max(stress[piece], stress[piece + 1])
        if not share > 0.0 or high < bins[0] or low >= bins[last + 1]:
            continue
        while bin_ > 0 and bins[bin_] > low:
            bin_ -= 1
        while bin_ < last and bins[bin_ + 1] <= low:
            bin_ += 1
        if high <= bins[bin_ + 1] and low >= bins[bin_]:
            masses[bin_] += share
            continue
        density = share / (high - low)
        reached = bin_
        while reached <= last and bins[reached] < high:
            masses[reached] += density * (min(high, bins[reached + 1]) - max(low, bins[reached]))
            reached += 1
