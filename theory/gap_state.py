"""Distribution of the local gap in a theory that knows it, and what is read off it."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from contact_study.problem.laws.base import TractionLaw

if TYPE_CHECKING:
    import xarray as xr

# Relative change of the area and of the mean gap that the rounding of some thousand steps explains.
_KEPT = 1e-6

# Area of a node below which default bins need not reach it.
_SEEN = 1e-9

# Pieces of a node's interval over which the distribution of stress is summed.
_PIECES = 32

# Weights below it are none: a state at a gap far beyond the roughness falls off through all numbers.
_NO_WEIGHT = 1e-200


@dataclass(frozen=True)
class GapState:
    """The local gaps at one mean gap.

    ``gaps`` and ``weights`` are in units of ``length``; energies and pressures are SI.

    Attributes
    ----------
    labels : tuple of str
        Theory, and its metastable branch if it is one.
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
    change : float, optional
        Largest change of a scale's mean response in the last iteration, of a theory that iterates.
    """

    labels: tuple[str, ...]
    law: TractionLaw
    length: float
    contact_modulus: float
    mean_gap: float
    pressure: float
    elastic_energy: float
    gaps: np.ndarray
    weights: np.ndarray
    converged: bool
    change: float | None = None

    @property
    def residual(self) -> float:
        """Last change of the responses; of a theory without iteration what parts both pressures, over E*.

        That is no measure of convergence but of the resolution: second order in the nodes of the gap, first in the
        scales and where coexistence ends between nodes.
        """
        if self.change is not None:
            return self.change
        return abs(self.mean_traction - self.pressure) / self.contact_modulus

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
        # Quotients of the interpolation overflow where a weight is next to no number.
        seen = np.where(np.abs(self.weights) > _NO_WEIGHT, self.weights, 0.0)
        return PchipInterpolator(self._edges, np.concatenate([[0.0], np.cumsum(seen)]))

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
        # In each piece the area is spread evenly over its stresses, of which the steep repulsion holds many.
        nodes = self.gaps.size
        fine = np.interp(np.arange(_PIECES * nodes + 1) / _PIECES, np.arange(nodes + 1), self._edges)
        mass = np.diff(self._cumulative(fine))
        stress = -self.law.traction(fine)
        low, high = np.minimum(stress[1:], stress[:-1]), np.maximum(stress[1:], stress[:-1])
        occupied = mass > 0
        mass, low, high = mass[occupied], low[occupied], high[occupied]
        return np.diff(_mass_below(bins, low, high, mass)) / np.diff(edges)

    def quantities(self, contact_distance: float | None = None) -> dict[str, Any]:
        """Everything that is read off the state, by its name in a dataset; distributions as functions of bin edges.

        The mean gap is from the law's equilibrium distance, as in all datasets.

        Parameters
        ----------
        contact_distance : float, optional
            Gaps below it count as contact (m); by default those within the law's own contact distance.
        """
        own = self.law.contact_distance * self.length
        return {
            "mean_pressure": self.pressure,
            "mean_gap": self.mean_gap - self.law.equilibrium_distance * self.length,
            "relative_contact_area": self.fraction_below(own if contact_distance is None else contact_distance),
            "relative_repulsive_area": self.relative_repulsive_area,
            "elastic_energy": self.elastic_energy,
            "interaction_energy": self.interaction_energy,
            "local_mean_pressure": self.mean_traction,
            "pressure_pdf": self.pressure_density,
            "gap_pdf": self.gap_density,
            "converged": self.converged and self.complete,
            "detached": False,
            "residual": self.residual,
        }

    def to_dataset(
        self,
        contact_distance: float | None = None,
        pressure_edges: np.ndarray | None = None,
        gap_edges: np.ndarray | None = None,
    ) -> "xr.Dataset":
        """The state in the schema of ``theory.nc``, without the dimension of a path.

        Parameters
        ----------
        contact_distance : float, optional
            Gaps below it count as contact (m); by default those within the law's own contact distance.
        pressure_edges, gap_edges : numpy.ndarray, optional
            Edges of the bins of both distributions (Pa, m); by default even ones over all but a billionth of the area.

        Raises
        ------
        ValueError
            If edges do not rise.
        """
        from theory.datasets import dataset_of  # xarray is slow to import, and only needed here

        held = np.flatnonzero(self.weights > _SEEN)
        low, high = (float(self._edges[end]) for end in (held[0], held[-1] + 1))
        stress = -self.law.traction(np.linspace(low, high, 4 * self.gaps.size)) * self.contact_modulus
        beside = 1e-3 * np.ptp(stress)  # the peak of the law may lie between two of them
        return dataset_of(
            self.labels,
            self.quantities(contact_distance),
            {"pressure_pdf": pressure_edges, "gap_pdf": gap_edges},
            {
                "pressure_pdf": (float(stress.min() - beside), float(stress.max() + beside)),
                "gap_pdf": (low * self.length, high * self.length),
            },
        )


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
