"""Distribution of the local gap in a theory that knows it, and what is read off it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import PchipInterpolator

from contact_study.problem.laws.base import TractionLaw

# Relative change of the area and of the mean gap that the rounding of some thousand steps explains.
_KEPT = 1e-6


@dataclass(frozen=True)
class GapState:
    """The local gaps at one mean gap.

    ``gaps`` and ``weights`` are in units of ``length``; energies and pressures are SI.

    Attributes
    ----------
    law : TractionLaw
        The law in units of ``length`` and ``contact_modulus``.
    length, contact_modulus : float
        The units (m, Pa).
    mean_gap : float
        ū from the law's zero (m).
    pressure : float
        p = −∂U/∂ū (Pa).
    elastic_energy : float
        Elastic energy of all waves, per nominal area (J/m²).
    gaps, weights : numpy.ndarray, shape (n,)
        Nodes of the local gap and the fraction of the area at each.
    converged : bool
        Whether the equations that the state rests on are solved.
    """

    law: TractionLaw
    length: float
    contact_modulus: float
    mean_gap: float
    pressure: float
    elastic_energy: float
    gaps: np.ndarray
    weights: np.ndarray
    converged: bool

    @property
    def complete(self) -> bool:
        """Whether the distribution holds the whole area and the mean gap, which every step keeps but for rounding."""
        area, gap = self.weights.sum(), self.weights @ self.gaps
        return bool(abs(area - 1) < _KEPT and abs(gap * self.length - self.mean_gap) < _KEPT * self.mean_gap)

    @property
    def interaction_energy(self) -> float:
        """<φ> (J/m²)."""
        return float(self.weights @ self.law.potential(self.gaps)) * self.contact_modulus * self.length

    @property
    def mean_traction(self) -> float:
        """−<φ'>, which balances :attr:`pressure` up to the resolution of gaps and scales (Pa)."""
        return -float(self.weights @ self.law.traction(self.gaps)) * self.contact_modulus

    @cached_property
    def _edges(self) -> np.ndarray:
        """Ends of the intervals over which the nodes' weights are spread."""
        middle = 0.5 * (self.gaps[1:] + self.gaps[:-1])
        return np.concatenate([self.gaps[:1], middle, self.gaps[-1:]])

    @cached_property
    def _cumulative(self) -> PchipInterpolator:
        return PchipInterpolator(self._edges, np.concatenate([[0.0], np.cumsum(self.weights)]))

    def _below(self, gap: np.ndarray | float) -> np.ndarray:
        return self._cumulative(np.clip(gap, self._edges[0], self._edges[-1]))

    def fraction_below(self, gap: float) -> float:
        """Fraction of the area whose local gap is below ``gap`` (m)."""
        return float(self._below(gap / self.length))

    @property
    def relative_repulsive_area(self) -> float:
        """Fraction of the area under positive pressure."""
        return self.fraction_below(self.law.equilibrium_distance * self.length)

    def gap_density(self, edges: np.ndarray) -> np.ndarray:
        """Mean of P(u) in bins (1/m), shape (n,) for n + 1 edges (m)."""
        return np.diff(self._below(np.asarray(edges) / self.length)) / np.diff(edges)

    def pressure_density(self, edges: np.ndarray) -> np.ndarray:
        """Mean of P(σ), σ = −φ'(u), in bins (1/Pa), shape (n,) for n + 1 edges (Pa); includes non-contact."""
        bins = np.asarray(edges) / self.contact_modulus
        # Four pieces to a node follow the steep repulsion; in each the area is spread evenly over its stresses.
        fine = np.interp(np.arange(4 * self.gaps.size + 1) / 4, np.arange(self.gaps.size + 1), self._edges)
        mass = np.diff(self._cumulative(fine))
        stress = -self.law.traction(fine)
        low, high = np.minimum(stress[1:], stress[:-1]), np.maximum(stress[1:], stress[:-1])
        occupied = mass > 0
        mass, low, high = mass[occupied], low[occupied], high[occupied]
        return np.diff(_mass_below(bins, low, high, mass)) / np.diff(edges)


def _mass_below(edges: np.ndarray, low: np.ndarray, high: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """Mass below each edge of pieces that are spread evenly from ``low`` to ``high``."""
    first = np.searchsorted(edges, low, side="right")
    whole = np.maximum(np.searchsorted(edges, high, side="left"), first)  # from this edge on all of the piece is below
    within = whole - first
    piece = np.repeat(np.arange(mass.size), within)
    edge = np.arange(piece.size) + np.repeat(first - np.cumsum(within) + within, within)
    part = mass[piece] * (edges[edge] - low[piece]) / (high[piece] - low[piece])
    passed = np.bincount(whole, weights=mass, minlength=edges.size + 1)[: edges.size]
    return np.bincount(edge, weights=part, minlength=edges.size) + np.cumsum(passed)
