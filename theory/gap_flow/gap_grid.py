"""Nodes of the local gap: the intervals that belong to them, and the stress of the law within these."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit

from contact_study.numerics.kernel import inner_product
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity

_PIECES = 32  # of a node's interval over which the distribution of stress is summed
_FINE = 0.8  # distance from the lowest node, in the law's lengths, over which nodes are even before they widen
_TABLE = 40001  # points between which the coordinate of the nodes is interpolated

# Nodes for one deviation of the stress of full contact, deviations up to which that holds, the part of it for tension,
# the peak tension in deviations from which on it counts for these, and the range of the gap that is usual.
_NODES_PER_DEVIATION, _EVEN, _OF_TENSION, _STRONGEST, _USUAL_STEPS = 4.0, 4.0, 0.5, 10.0, 4.6


@dataclass(frozen=True, eq=False)
class GapNodes:
    """Nodes that all states of a curve share, in units of a length and the contact modulus."""

    law: TractionLaw
    gaps: np.ndarray  # rising nodes of the local gap, shape (n,)
    between: np.ndarray | None = None  # where their intervals meet, shape (n - 1,); by default halfway

    @cached_property
    def edges(self) -> np.ndarray:
        """Ends of the intervals over which the nodes' weights are spread, shape (n + 1,)."""
        middle = 0.5 * (self.gaps[1:] + self.gaps[:-1]) if self.between is None else self.between
        return np.concatenate([self.gaps[:1], middle, self.gaps[-1:]])

    def mean_stress(self, shares: np.ndarray) -> float:
        """Mean of the distribution that :meth:`stress_masses` sorts into bins, in units of the modulus."""
        return inner_product(shares, 0.5 * (self._stress[1:] + self._stress[:-1]))

    def stress_masses(self, shares: np.ndarray, bins: np.ndarray) -> np.ndarray:
        """Area in each bin of the stress σ = −φ'(u), shape (m,) for m + 1 rising ends in units of the modulus."""
        masses = np.zeros(bins.size - 1)
        _spread(self._stress, shares, bins, masses)
        return masses

    def shares(self, cubics: np.ndarray) -> np.ndarray:
        """Area in each piece of the intervals, from the area below a gap in cubics of the distance in an interval."""
        ends = np.arange(_PIECES + 1) / _PIECES
        powers = np.diff(ends ** np.array([[3], [2], [1]]))
        return ((cubics[:3] * np.diff(self.edges) ** np.array([[3], [2], [1]])).T @ powers).ravel()

    @cached_property
    def _stress(self) -> np.ndarray:
        """σ at the ends of all pieces."""
        count = self.gaps.size
        return -self.law.traction(np.interp(np.arange(_PIECES * count + 1) / _PIECES, np.arange(count + 1), self.edges))


def gap_nodes(
    spectrum: RoughnessSpectrum, solid: Elasticity, law: TractionLaw, length: float, largest_gap: float, count: int
) -> np.ndarray:
    """Nodes from deep in the repulsion to far above the roughness, finest where the law varies."""
    lowest, steps = _reach(spectrum, solid, law, length, largest_gap)
    return lowest + _FINE * np.sinh(np.linspace(0, steps, count))


def nodes_even_in_stress(
    spectrum: RoughnessSpectrum, solid: Elasticity, law: TractionLaw, length: float, largest_gap: float, count: int
) -> GapNodes:
    """Nodes even in a sum of the coordinate of :func:`gap_nodes` and of the law's stress, which decides the mean.

    ``count`` is for roughness of the law's own size; wider ranges have more nodes, as many for each factor of e.
    """
    lowest, steps = _reach(spectrum, solid, law, length, largest_gap)
    count = int(np.ceil(count * max(steps / _USUAL_STEPS, 1)))
    fine = np.linspace(0, steps, _TABLE)
    gaps = lowest + _FINE * np.sinh(fine)
    deviation = float(np.sqrt(spectrum.full_contact_stress_variance(solid.stiffness))) / solid.contact_modulus
    stress = -law.traction(gaps) / max(deviation, law.peak_tensile_stress / _STRONGEST)
    # Even up to some deviations of the stress of full contact, logarithmic beyond; the tension by half as many.
    change = np.abs(np.diff(np.where(stress > 0, _EVEN * np.arcsinh(stress / _EVEN), _OF_TENSION * stress)))
    law_nodes = _NODES_PER_DEVIATION * np.concatenate([[0.0], np.cumsum(change)])
    law_nodes *= min(1.0, 0.5 * (count - 1) / law_nodes[-1])
    number = law_nodes + (count - 1 - law_nodes[-1]) * fine / steps
    places = np.interp(np.arange(2 * count - 1) / 2, number, gaps)
    return GapNodes(law, places[::2], places[1::2])


def _reach(
    spectrum: RoughnessSpectrum, solid: Elasticity, law: TractionLaw, length: float, largest_gap: float
) -> tuple[float, float]:
    """The lowest node, and how far the highest is in the inverse hyperbolic sine of the distance from it."""
    # No patch is pressed by twenty deviations of full contact; a mean pressure of the modulus is beyond all sense.
    deviation = float(np.sqrt(spectrum.full_contact_stress_variance(solid.stiffness))) / solid.contact_modulus
    highest = max(20 * deviation, 1.0) + 5 * law.peak_tensile_stress
    lowest = float(law.repulsive_gap(np.array(-highest)))
    roughness = np.sqrt(spectrum.mean_square_height) / length
    reach = max(5.0 + 11 * roughness, largest_gap / length + 7 * roughness)
    return lowest, float(np.arcsinh((reach - lowest) / _FINE))


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
