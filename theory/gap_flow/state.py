"""Theories of the local gap share its nodes, its distribution with what is read off it, and p over the mean gap."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numba import njit
from scipy.interpolate import PchipInterpolator, PPoly

from contact_study.inputs.units import stress
from contact_study.numerics.arguments import finite
from contact_study.numerics.kernel import inner_product
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity
from theory.datasets import Dataset, dataset_of

REMEDY = "use a lower pressure, weaker adhesion or Persson's theory"  # what helps where a curve ends early

_KEPT = 1e-6  # relative change of area and mean gap that the rounding of some thousand steps explains
_SEEN = 1e-9  # area of a node below which default bins need not reach it
_NO_WEIGHT = 1e-200  # weights below it are none: far beyond the roughness they fall off through all numbers
_QUANTITIES = ("relative_repulsive_area", "elastic_energy", "interaction_energy", "stress_balance", "residual")

_PIECES = 32  # of a node's interval over which the distribution of stress is summed
# Nodes are even before they widen over this distance from the lowest one, in the law's lengths, or over so many lengths
# in which the repulsion there decays, if those are shorter.
_FINE, _FINE_DECAYS = 0.8, 15.0
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

    @cached_property
    def stress(self) -> np.ndarray:
        """σ = −φ'(u) at the ends of all pieces of the intervals."""
        count = self.gaps.size
        return -self.law.traction(np.interp(np.arange(_PIECES * count + 1) / _PIECES, np.arange(count + 1), self.edges))


def cumulatives(nodes: GapNodes, weights: np.ndarray) -> list[PPoly]:
    """Area below a gap of every state from its weights, shape (states, n), monotone between the intervals' ends."""
    # Quotients of the interpolation overflow where a weight is next to no number.
    seen = np.where(np.abs(weights) > _NO_WEIGHT, weights, 0.0)
    below = np.concatenate([np.zeros((len(seen), 1)), np.cumsum(seen, axis=1)], axis=1)
    curves = PchipInterpolator(nodes.edges, below, axis=1)
    return [PPoly(np.ascontiguousarray(curves.c[..., state]), curves.x) for state in range(len(seen))]


@dataclass(frozen=True)
class GapState:
    """The local gaps at one mean gap.

    Attributes
    ----------
    labels : tuple of str
        Theory, and its metastable branch if it is one.
    nodes : GapNodes
        The local gaps, and the law, in units of ``length`` and ``contact_modulus`` (m, Pa).
    mean_gap, pressure, elastic_energy : float
        ū from the law's zero (m), p = −∂U/∂ū (Pa), and the energy of all waves per nominal area (J/m²).
    weights : numpy.ndarray, shape (n,)
        Fraction of the area at each node.
    converged : bool
        Whether the equations that the state rests on are solved.
    change : float, optional
        Largest change of a scale's mean response in the last iteration, of a theory that iterates.
    cumulative : scipy.interpolate.PPoly, optional
        Area below a gap, one of :func:`cumulatives`, where it was made for many states at once.

    Examples
    --------
    ``gap_flow(...).at_pressure(p)`` returns one, see :func:`theory.gap_flow`.
    """

    labels: tuple[str, ...]
    nodes: GapNodes
    length: float
    contact_modulus: float
    mean_gap: float
    pressure: float
    elastic_energy: float
    weights: np.ndarray
    converged: bool
    change: float | None = None
    cumulative: PPoly | None = None

    @property
    def law(self) -> TractionLaw:
        """The law in units of ``length`` and ``contact_modulus``."""
        return self.nodes.law

    @property
    def gaps(self) -> np.ndarray:
        """Nodes of the local gap in units of ``length``, shape (n,)."""
        return self.nodes.gaps

    @property
    def residual(self) -> float:
        """Last change of the responses; of a theory without iteration what parts both pressures, over E*."""
        apart = abs(self.mean_traction - self.pressure) / self.contact_modulus
        return apart if self.change is None else self.change

    @property
    def interaction_energy(self) -> float:
        """<φ> (J/m²)."""
        return inner_product(self.weights, self.law.potential(self.gaps)) * self.contact_modulus * self.length

    @property
    def mean_traction(self) -> float:
        """−<φ'>, which balances :attr:`pressure` up to the resolution of gaps and scales (Pa)."""
        return -inner_product(self.weights, self.law.traction(self.gaps)) * self.contact_modulus

    @property
    def stress_balance(self) -> float:
        """∫σP(σ) dσ / p: 1 but for the resolution and, in the edge flow, the trial field; NaN at p = 0."""
        ends = self.nodes.stress
        mean = inner_product(self._shares, 0.5 * (ends[1:] + ends[:-1])) * self.contact_modulus
        return mean / self.pressure if self.pressure else float("nan")

    @cached_property
    def _cumulative(self) -> PPoly:
        return self.cumulative or cumulatives(self.nodes, self.weights[None, :])[0]

    @cached_property
    def _shares(self) -> np.ndarray:
        """Area in each piece of the nodes' intervals, from the cubics of the area below a gap."""
        exponents = np.array([[3], [2], [1]])
        powers = np.diff((np.arange(_PIECES + 1) / _PIECES) ** exponents)
        return ((self._cumulative.c[:3] * np.diff(self.nodes.edges) ** exponents).T @ powers).ravel()

    def _below(self, gap: np.ndarray | float) -> np.ndarray:
        return self._cumulative(np.clip(gap, self.nodes.edges[0], self.nodes.edges[-1]))

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
        masses = np.zeros(bins.size - 1)
        _spread(self.nodes.stress, self._shares, bins, masses)
        return masses / np.diff(edges)

    def quantities(self, contact_distance: float | None = None) -> dict[str, Any]:
        """Everything that is read off the state, by its name in a dataset; distributions as functions of bin edges."""
        own = self.law.contact_distance * self.length
        # Every step keeps the whole area and the mean gap but for rounding.
        area, gap = self.weights.sum(), inner_product(self.weights, self.gaps) * self.length
        complete = bool(abs(area - 1) < _KEPT and abs(gap - self.mean_gap) < _KEPT * self.mean_gap)
        return {name: getattr(self, name) for name in _QUANTITIES} | {
            "mean_pressure": self.pressure,
            "mean_gap": self.mean_gap - self.law.equilibrium_distance * self.length,
            "relative_contact_area": self.fraction_below(own if contact_distance is None else contact_distance),
            "local_mean_pressure": self.mean_traction,
            "pressure_pdf": self.pressure_density,
            "gap_pdf": self.gap_density,
            "converged": self.converged and complete,
            "detached": False,
        }

    def to_dataset(
        self,
        contact_distance: float | None = None,
        pressure_edges: np.ndarray | None = None,
        gap_edges: np.ndarray | None = None,
    ) -> Dataset:
        """The state in the schema of ``theory.nc``, without the dimension of a path.

        Parameters
        ----------
        contact_distance : float, optional
            Gaps below it count as contact (m); by default those within the law's own contact distance.
        pressure_edges, gap_edges : numpy.ndarray, optional
            Edges of the bins of both distributions (Pa, m); by default even ones over all but a billionth of the area.
        """
        held = np.flatnonzero(self.weights > _SEEN)
        low, high = (float(self.nodes.edges[end]) for end in (held[0], held[-1] + 1))
        local = -self.law.traction(np.linspace(low, high, 4 * self.gaps.size)) * self.contact_modulus
        beside = 1e-3 * np.ptp(local)  # the peak of the law may lie between two of them
        bins = {
            "pressure_pdf": (pressure_edges, (float(local.min() - beside), float(local.max() + beside))),
            "gap_pdf": (gap_edges, (low * self.length, high * self.length)),
        }
        return dataset_of(self.labels, self.quantities(contact_distance), bins)


class PressureCurve(ABC):
    """The curve p(ū) of a surface, to be asked for the state at a pressure or a mean gap."""

    _end = "adhesion is too strong for it"  # why the curve may end before a pressure

    @property
    @abstractmethod
    def mean_gap(self) -> np.ndarray:
        """Rising mean gaps, from the law's zero, at which :attr:`pressure` stands, shape (n,) (m)."""

    @property
    @abstractmethod
    def pressure(self) -> np.ndarray:
        """p = −∂U/∂ū, shape (n,) (Pa)."""

    @abstractmethod
    def states(self, mean_gaps: np.ndarray) -> list[GapState]:
        """Distribution of the local gap at each mean gap (m); ValueError outside the nodes of the flow."""

    @cached_property
    def _tension(self) -> tuple[int, int]:
        """First index of the widest range of gaps under tension, and the one after its last.

        Narrower ones are errors of the slope of the energy, close to full contact, where the pressure rises steeply.
        """
        below = np.concatenate([[False], self.pressure < 0, [False]])
        first, after = np.flatnonzero(below[1:] & ~below[:-1]), np.flatnonzero(below[:-1] & ~below[1:])
        if not first.size:
            return 0, self.pressure.size
        widest = int(np.argmax(self.mean_gap[after - 1] - self.mean_gap[first]))
        return int(first[widest]), int(after[widest])

    @property
    def _fold(self) -> int:
        """Index of the lowest pressure."""
        first, after = self._tension
        return first + int(np.argmin(self.pressure[first:after]))

    @property
    def pull_off_pressure(self) -> float:
        """Lowest pressure of the curve, the end of adhesion under pressure control (Pa)."""
        return float(self.pressure[self._fold])

    @property
    def work_of_separation(self) -> float:
        """Work of the tension from contact without load to separation under a prescribed gap (J/m²)."""
        first, after = self._tension
        return -float(np.trapezoid(np.minimum(self.pressure[first:after], 0.0), self.mean_gap[first:after]))

    def _meant(self, crossings: np.ndarray) -> np.ndarray:
        """Choose those of several stable states, gaps rising, that the branch may be in; the last of them is meant."""
        return crossings

    def gap_at(self, pressure: float) -> float:
        """Mean gap, from the law's zero, of the stable state at a pressure (m); NaN if there is none.

        Of several it is the largest, on an unloading branch one before the pull-off. ValueError if the nodes do not
        reach it.
        """
        p, gap = self.pressure, self.mean_gap
        finite("pressure", pressure, "Pa")
        if pressure > p.max():
            ends = f"it ends at {stress(float(p.max()))}: {self._end}, or its nodes end there; {REMEDY}"
            raise ValueError(f"pressure: the flow has no equilibrium at {stress(pressure)}, {ends}")
        crossings = self._meant(np.flatnonzero((p[:-1] > pressure) & (p[1:] <= pressure)))
        if crossings.size == 0:
            return float("nan")
        i = crossings[-1]
        weight = (p[i] - pressure) / (p[i] - p[i + 1])
        return float((1 - weight) * gap[i] + weight * gap[i + 1])

    def pressure_at(self, mean_gap: float) -> float:
        """Pressure at a mean gap within the nodes (Pa)."""
        return float(np.interp(mean_gap, self.mean_gap, self.pressure))

    def at_pressure(self, pressure: float) -> GapState:
        """The distribution of gaps in the state that :meth:`gap_at` chooses (Pa); ValueError if there is none."""
        gap = self.gap_at(pressure)
        if np.isnan(gap):
            lowest = self.pull_off_pressure
            reason = f"below the pull-off at {lowest:.3g} Pa" if pressure < lowest else "no state found carries it"
            raise ValueError(f"pressure = {pressure:g} Pa: {reason}")
        return self.states(np.array([gap]))[0]


def core_of(law: TractionLaw) -> float:
    """The equilibrium distance, at which a law's core ends (m); ValueError if there is a wall in its place."""
    if law.has_wall:
        raise ValueError(f"law: {law.title}: has a wall, which no flow of the local gap goes through; take a core")
    return law.equilibrium_distance


def positions(mean_gaps: np.ndarray, lowest: float, highest: float) -> np.ndarray:
    """Mean gaps (m) as an array; ValueError if one is outside the two ends, or no number."""
    asked = np.atleast_1d(np.asarray(mean_gaps, dtype=float))
    wrong = ~((asked >= lowest) & (asked <= highest))
    if wrong.any():
        nodes = f"{lowest:.6g} m to {highest:.6g} m"
        raise ValueError(f"mean_gaps: {asked[wrong][0]:.6g} m is outside the nodes of the flow, {nodes}")
    return asked


def nodes_even_in_stress(
    spectrum: RoughnessSpectrum, solid: Elasticity, law: TractionLaw, length: float, largest_gap: float, count: int
) -> GapNodes:
    """Nodes even in a sum of the coordinate of :func:`widening_nodes` and of the law's stress, which decides the mean.

    ``count`` is for roughness of the law's own size; wider ranges have more nodes, as many for each factor of e.
    """
    fine, gaps = widening_nodes(spectrum, solid, law, length, largest_gap, _TABLE)
    count = int(np.ceil(count * max(fine[-1] / _USUAL_STEPS, 1)))
    deviation = float(np.sqrt(spectrum.full_contact_stress_variance(solid.stiffness))) / solid.contact_modulus
    stress = -law.traction(gaps) / max(deviation, law.peak_tensile_stress / _STRONGEST)
    # Even up to some deviations of the stress of full contact, logarithmic beyond; the tension by half as many.
    change = np.abs(np.diff(np.where(stress > 0, _EVEN * np.arcsinh(stress / _EVEN), _OF_TENSION * stress)))
    law_nodes = _NODES_PER_DEVIATION * np.concatenate([[0.0], np.cumsum(change)])
    law_nodes *= min(1.0, 0.5 * (count - 1) / law_nodes[-1])
    number = law_nodes + (count - 1 - law_nodes[-1]) * fine / fine[-1]
    places = np.interp(np.arange(2 * count - 1) / 2, number, gaps)
    return GapNodes(law, places[::2], places[1::2])


def widening_nodes(
    spectrum: RoughnessSpectrum, solid: Elasticity, law: TractionLaw, length: float, largest_gap: float, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Even steps of a coordinate from zero, and gaps there: even where the law varies, then ever wider apart."""
    # No patch is pressed by twenty deviations of full contact; a mean pressure of the modulus is beyond all sense.
    deviation = float(np.sqrt(spectrum.full_contact_stress_variance(solid.stiffness))) / solid.contact_modulus
    highest = max(20 * deviation, 1.0) + 5 * law.peak_tensile_stress
    lowest = float(law.repulsive_gap(np.array(-highest)))
    roughness = np.sqrt(spectrum.mean_square_height) / length
    reach = max(5.0 + 11 * roughness, largest_gap / length + 7 * roughness)
    decay = abs(law.traction(np.array(lowest)) / law.stiffness(np.array(lowest)))
    width = float(np.minimum(_FINE, _FINE_DECAYS * decay))
    coordinate = np.linspace(0, float(np.arcsinh((reach - lowest) / width)), count)
    return coordinate, lowest + width * np.sinh(coordinate)


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
