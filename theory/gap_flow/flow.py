"""Gap-flow theory: roughness added scale by scale to the traction-separation law itself.

Akin to J. Joe, Traction Between Rough Surfaces (PhD thesis, University of Michigan, 2021, hdl:2027.42/169927). With
U(ū) the energy at mean gap ū, first φ(ū), and c = U'', a wave of height variance dm = 2πqC dq adds

    ∂U/∂m = ½ K c / (K + c).

Where c < −K two states coexist: U + ½Kū² becomes its convex hull ("equilibrium"), or U' + Kū its running minimum from
large gaps downward ("loading") or its running maximum from small gaps upward ("unloading"), where states lose
stability. With v = ½K²/(K + c) an implicit step reads ½K²/v + Δm v'' = K + c_old. Its transposed matrix, from coarse to
fine, turns a mean gap into the distribution of the local gap.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of
from theory.gap_flow.kernels import BRANCHES, backward_sweep, flow_through_scales
from theory.gap_flow.state import GapNodes, GapState, PressureCurve, core_of, cumulatives, positions, widening_nodes

GAP_FLOW_GAPS, GAP_FLOW_SCALES = 800, 1600  # nodes of the gap and bands of wavevectors


@dataclass(frozen=True)
class GapFlowOptions:
    """Numerical choices of the gap flow; the first step must spread an area by less than the distance of two nodes."""

    first_variance: float = 1e-5  # height variance of the first step, in squares of the law's length
    growth: float = 500  # of the steps after it, times the number of scales, until the spectrum's bands are shorter


@dataclass(frozen=True)
class GapFlow(PressureCurve):
    """The flowed energy: mean pressure over mean gap, and the way back to local gaps.

    Lengths are in units of ``length``, stresses of ``contact_modulus``.

    Attributes
    ----------
    law, length, contact_modulus : TractionLaw, float
        The law in units of ``length`` and ``contact_modulus``, and these (m, Pa).
    branch : str
        One of :data:`BRANCHES`.
    gaps, energy : numpy.ndarray, shape (n,)
        Nodes of the gap, and U at these, all roughness included.
    unconverged_steps : int
        Steps of the roughness in which Newton's method did not meet its tolerance.

    Examples
    --------
    :func:`gap_flow` returns one.
    """

    law: TractionLaw
    length: float
    contact_modulus: float
    branch: str
    gaps: np.ndarray
    energy: np.ndarray
    unconverged_steps: int
    _stiffness: np.ndarray
    _steps: np.ndarray
    _compliances: np.ndarray
    _hull: np.ndarray

    def _meant(self, crossings: np.ndarray) -> np.ndarray:
        return crossings[:1] if self.branch == "unloading" else crossings

    @property
    def name(self) -> str:
        """Theory, and its metastable branch if it is one: the group of its states in a dataset."""
        return "gap_flow" if self.branch == "equilibrium" else f"gap_flow/{self.branch}"

    @property
    def steps(self) -> int:
        """Steps in which the roughness was added."""
        return self._steps.size

    @property
    def converged(self) -> bool:
        """Whether the implicit equations of every step are solved."""
        return self.unconverged_steps == 0

    @cached_property
    def mean_gap(self) -> np.ndarray:
        """Mean gaps, from the law's zero, at which :attr:`pressure` stands, shape (n − 1,) (m)."""
        return 0.5 * (self.gaps[1:] + self.gaps[:-1]) * self.length

    @cached_property
    def pressure(self) -> np.ndarray:
        """p = −∂U/∂ū (Pa)."""
        return -np.diff(self.energy) / np.diff(self.gaps) * self.contact_modulus

    def states(self, mean_gaps: np.ndarray) -> list[GapState]:
        """Distribution of the local gap at each mean gap (m), all in one pass from coarse to fine."""
        asked = positions(mean_gaps, self.gaps[0] * self.length, self.gaps[-1] * self.length)
        reduced = asked / self.length
        weights = np.zeros((self.gaps.size, reduced.size))
        right, columns = np.clip(np.searchsorted(self.gaps, reduced), 1, self.gaps.size - 1), np.arange(reduced.size)
        share = (reduced - self.gaps[right - 1]) / (self.gaps[right] - self.gaps[right - 1])
        weights[right - 1, columns], weights[right, columns] = 1 - share, share
        elastic = np.zeros(reduced.size)
        backward_sweep(self.gaps, self._stiffness, self._steps, self._compliances, self._hull, weights, elastic)
        shares, nodes = np.ascontiguousarray(weights.T), GapNodes(self.law, self.gaps)
        of_curve = tuple(self.name.split("/")), nodes, self.length, self.contact_modulus
        found = []
        for gap, energy, weight, below in zip(asked, elastic, shares, cumulatives(nodes, shares), strict=True):
            values = self.pressure_at(float(gap)), float(energy) * self.contact_modulus * self.length, weight
            found.append(GapState(*of_curve, float(gap), *values, self.converged, cumulative=below))
        return found


def gap_flow(
    spectrum: RoughnessSpectrum,
    elasticity: Elasticity | float,
    law: TractionLaw,
    branch: str = "equilibrium",
    largest_gap: float = 0.0,
    gaps: int = GAP_FLOW_GAPS,
    scales: int = GAP_FLOW_SCALES,
    iterations: int = 60,
    options: GapFlowOptions = GapFlowOptions(),
) -> GapFlow:
    """Flow a traction-separation law through a roughness spectrum.

    Parameters
    ----------
    spectrum, elasticity, law : RoughnessSpectrum, Elasticity or float, TractionLaw
        Roughness; the solid, or the contact modulus E* of a half-space (Pa); interaction of smooth surfaces.
    branch : str, optional
        ``"equilibrium"``, ``"loading"`` or ``"unloading"``.
    largest_gap : float, optional
        Mean gap that the nodes must hold, beyond where surfaces of this roughness touch (m).
    gaps, scales, iterations : int, optional
        Nodes of the gap, bands of wavevectors at least, and Newton iterations of a step at most.
    options : GapFlowOptions, optional
        Numerical choices.

    Returns
    -------
    GapFlow
        The curve; states at a pressure or mean gap follow from it.

    Raises
    ------
    ValueError
        If the branch is unknown or the law has no core.

    Examples
    --------
    >>> from theory import LennardJones104, SelfAffineSpectrum, gap_flow
    >>> spectrum = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
    >>> flow = gap_flow(spectrum, 93.7e9, LennardJones104(work_of_adhesion=0.1, length=3.28e-10))
    >>> state = flow.at_pressure(1e9)
    >>> 0 < state.fraction_below(3.68e-10) < 1
    True
    """
    if branch not in BRANCHES:
        raise ValueError(f"branch = {branch!r}: expected one of {', '.join(BRANCHES)}")
    length = core_of(law)
    solid = elasticity_of(elasticity)
    reduced = law.scaled(length, solid.contact_modulus)
    _, x = widening_nodes(spectrum, solid, reduced, length, largest_gap, gaps)
    stiffness, steps = _scales(spectrum, solid, length, scales, options)
    energy = np.array(reduced.potential(x), dtype=float)
    kept = np.empty((steps.size, x.size)), np.empty((steps.size, x.size), dtype=np.int32)
    lost = int(flow_through_scales(x, stiffness, steps, BRANCHES.index(branch), iterations, energy, *kept))
    return GapFlow(reduced, length, solid.contact_modulus, branch, x, energy, lost, stiffness, steps, *kept)


def _scales(
    spectrum: RoughnessSpectrum, solid: Elasticity, length: float, count: int, options: GapFlowOptions
) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness, a mean that makes Σ ½K Δm exact, and height variance Δm of each step, fine scales first."""
    edges = spectrum.band_edges(count)
    variance = 2 * np.pi * np.diff(spectrum.moment(1, upper=edges))
    present = variance > 0  # some shells of a filtered surface are below the rounding of the sums
    variance, at_edges = variance[present], solid.stiffness(edges)
    bounds = np.sort([at_edges[:-1][present], at_edges[1:][present]], axis=0)
    energy = 2 * np.diff(spectrum.full_contact_energy(solid.stiffness, edges))[present]
    mean_stiffness = np.clip(energy / variance, *bounds)  # and others little above it
    # The implicit Euler step is of first order in the variance; the shells of a realised surface hold much of it.
    pieces = np.ceil(variance / variance.sum() * 0.4 * count).astype(int)
    stiffness = np.repeat(mean_stiffness * length / solid.contact_modulus, pieces)[::-1]
    steps = np.repeat(variance / pieces / length**2, pieces)[::-1]
    ends = np.cumsum(steps)
    growth = options.growth / count
    first = np.log1p(growth * ends[-1] / options.first_variance) / np.log1p(growth)
    grown = options.first_variance * np.expm1(np.log1p(growth) * np.arange(first)) / growth
    edges = np.union1d(ends, grown)
    inside = np.searchsorted(ends, 0.5 * (edges[1:] + edges[:-1]))
    return stiffness[inside], np.diff(edges)
