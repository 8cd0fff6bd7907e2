"""Edge flow: the gap flow whose response to a wave costs the elastic energy of its own modulation.

This theory is this project's own and unpublished, judged by its simulations alone. The gap u changes by −f(u) h with
the roughness h of wavevector q, on a solid of the stiffness K(q). Its distribution P and mean-square gradient M(u) = P
<|∇u|² | u> follow from coarse to fine, from δ(u − ū) and zero, with the height variance m; the mean traction s(u) from
fine to coarse, from φ'(u):

    ∂P/∂m = ½ (f² P)'',     M = f² N,     ∂N/∂m = ½ f⁻² (f⁴ N')' + f'² N + q² P,     ∂s/∂m = ½ f² s''.

With c = s' and X = −(P q²)⁻¹ ∂ M ∂, which stands for p²/q² of a modulation p, equilibrium of the scale asks

    [κ(X) K + c] f = K,     κ(X) = 1 + g [X/4 + 4/(X + 4) − 1],

g = 1 on a half-space, on other solids :func:`theory.edge_flow.equilibrium.modulation_cost`. With
E = <φ> + Σ ½ Δm <c f (1 − f)> the pressure is −dE/dū. Under strong adhesion the curve has several pieces.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from contact_study.numerics.arguments import finite
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of
from theory.edge_flow.apparent_adhesion import apparent_adhesion, stronger
from theory.edge_flow.equilibrium import KERNEL, EdgeFlowOptions, Equilibrium, Piece, Problem, curve, scales_of
from theory.gap_flow.state import GapNodes, GapState, PressureCurve, core_of, nodes_even_in_stress, positions

EDGE_FLOW_GAPS, EDGE_FLOW_SCALES = 240, 80  # nodes of the gap and steps of the roughness
EDGE_FLOW_BRANCHES = ("loading", "unloading")

_FAR = 7.0  # mean gap, in rms heights beyond twice the law's own, at which nothing is felt yet
_ORDER, _MANY, _POINTS = 5, 12, 16  # of the energy's spline: order, states needed, pressures between two of them
_NEIGHBOURS = 4  # states of the curve from which one between them starts
_WHOLE_CONTACT = 4.0  # pressure that the curve reaches if none is asked, in deviations of full contact's stress


@dataclass(frozen=True)
class EdgeFlow(PressureCurve):
    """The curve of mean pressure over mean gap, and the states along it.

    Attributes
    ----------
    law, length, contact_modulus : TractionLaw, float
        The law in units of ``length`` and ``contact_modulus``, and these (m, Pa); on unloading that of the apparent
        work of adhesion.
    branch : str
        ``"loading"`` or ``"unloading"``.
    pieces : tuple of tuple of Equilibrium
        The states that make the curve, from far to contact, mean gaps falling, in these units; more than one piece
        where the iteration finds no state between.
    lost, limit : int, str
        Other mean gaps where it found none, and how strong adhesion is, in words.

    Examples
    --------
    :func:`edge_flow` returns one.
    """

    law: TractionLaw
    length: float
    contact_modulus: float
    pieces: tuple[Piece, ...]
    lost: int
    limit: str
    _problem: Problem
    _nodes: GapNodes
    branch: str = "loading"

    def _meant(self, crossings: np.ndarray) -> np.ndarray:
        found = crossings[~np.isin(crossings, self._ends)]  # between two pieces there is no state
        return found[found < self._fold] if self.branch == "unloading" else found

    @property
    def names(self) -> tuple[str, ...]:
        """Theory, and metastable branch: the groups of its states in a dataset; loading is the theory itself, too."""
        return (*["edge_flow"] * (self.branch == "loading"), f"edge_flow/{self.branch}")

    @cached_property
    def _end(self) -> str:  # type: ignore[override]
        return f"adhesion is too strong for the edge flow ({self.limit})"

    @property
    def equilibria(self) -> Piece:
        """All states, mean gaps falling."""
        return tuple(state for piece in self.pieces for state in piece)

    @property
    def unconverged_states(self) -> int:
        """Mean gaps whose state did not meet the tolerance, lost ones too."""
        return self.lost + sum(not self._solved(found) for found in self.equilibria)

    @property
    def converged(self) -> bool:
        """Whether every state of the curve met the tolerance."""
        return self.unconverged_states == 0

    @property
    def sweeps(self) -> int:
        """Sweeps through all scales that the curve took."""
        return sum(found.sweeps for found in self.equilibria)

    @cached_property
    def _curves(self) -> list[tuple[Piece, np.ndarray, BSpline]]:
        """The states of each piece from contact on, mean gaps at which it has pressures, and E over the mean gap."""
        potential = self.law.potential(self._problem.gaps)
        found = []
        for piece in reversed(self.pieces):
            rising = piece[::-1]
            gaps = np.array([state.gap for state in rising])
            places = (gaps[:-1, None] + np.diff(gaps)[:, None] * (np.arange(_POINTS) / _POINTS)).ravel()
            energies = [float(state.weights @ potential) + state.elastic for state in rising]
            order = _ORDER if len(rising) >= _MANY else min(3, len(rising) - 1)  # of few states a high order swings
            found.append((rising, np.append(places, gaps[-1]), make_interp_spline(gaps, energies, k=order)))
        return found

    @cached_property
    def mean_gap(self) -> np.ndarray:
        """Rising mean gaps, from the law's zero, at which :attr:`pressure` stands, shape (n,) (m)."""
        return np.concatenate([places for _, places, _ in self._curves]) * self.length

    @cached_property
    def pressure(self) -> np.ndarray:
        """p = −dE/dū, shape (n,) (Pa)."""
        return -np.concatenate([energy(places, 1) for _, places, energy in self._curves]) * self.contact_modulus

    @cached_property
    def _ends(self) -> np.ndarray:
        """Index of the last mean gap of each piece."""
        return np.cumsum([len(places) for _, places, _ in self._curves]) - 1

    @property
    def pull_off_pressure(self) -> float:
        """Lowest pressure of the curve, the end of adhesion (Pa); NaN where that is at the end of a piece."""
        lowest = self._fold
        return float("nan") if lowest == 0 or lowest in (*self._ends, *self._ends + 1) else float(self.pressure[lowest])

    def pressure_at(self, mean_gap: float) -> float:
        """Pressure at a mean gap within the curve (Pa); NaN between its pieces."""
        gap = mean_gap / self.length
        for _, places, energy in self._curves:
            if places[0] <= gap <= places[-1]:
                return -float(energy(gap, 1)) * self.contact_modulus
        return float("nan")

    def states(self, mean_gaps: np.ndarray) -> list[GapState]:
        """Distribution of the local gap at each mean gap (m), each solved from its neighbours on the curve."""
        return [self._state(gap) for gap in positions(mean_gaps, self.mean_gap[0], self.mean_gap[-1])]

    def _state(self, mean_gap: float) -> GapState:
        gap = float(np.clip(mean_gap / self.length, self.equilibria[-1].gap, self.equilibria[0].gap))
        falling = next(piece for piece, *_ in self._curves if gap <= piece[-1].gap)[::-1]  # between two the farther one
        gaps = np.array([found.gap for found in falling])
        after = int(np.clip(np.searchsorted(-gaps, -gap), 1, gaps.size - 1))
        first = int(np.clip(after - _NEIGHBOURS // 2, 0, max(gaps.size - _NEIGHBOURS, 0)))
        start = self._problem.between(falling[first : first + _NEIGHBOURS], gap)
        found = self._problem.solve(gap, start)
        # The spline's slope rests on the neighbours, a few of them on either side.
        rests_on = (found, *falling[max(after - 2, 0) : after + 2])
        pressure = self.pressure_at(gap * self.length)
        converged = bool(np.isfinite(pressure)) and all(self._solved(state) for state in rests_on)
        of_curve = tuple(self.names[0].split("/")), self._nodes, self.length, self.contact_modulus
        elastic = found.elastic * self.contact_modulus * self.length
        return GapState(*of_curve, mean_gap, pressure, elastic, found.weights, converged, found.change)

    def _solved(self, found: Equilibrium) -> bool:
        return found.change <= self._problem.tolerance and found.bounded <= self._problem.options.bounded_area


def edge_flow(
    spectrum: RoughnessSpectrum,
    elasticity: Elasticity | float,
    law: TractionLaw,
    highest_pressure: float | None = None,
    largest_gap: float = 0.0,
    smallest_gap: float | None = None,
    gaps: int = EDGE_FLOW_GAPS,
    scales: int = EDGE_FLOW_SCALES,
    tolerance: float = 1e-6,
    iterations: int = 100,
    kernel: tuple[float, float, float] = KERNEL,
    options: EdgeFlowOptions = EdgeFlowOptions(),  # noqa: B008
    branch: str = "loading",
) -> EdgeFlow:
    """Solve the edge flow, this project's own and unpublished theory, along its curve of pressure over mean gap.

    Areas converge with the second order of the nodes; at the default resolution that of the paper's surface at 1 GPa is
    0.1 % too large at ε0 and at 8 ε0. The number of scales hardly matters.

    Parameters
    ----------
    spectrum, elasticity, law
        As for :func:`gap_flow`.
    highest_pressure, largest_gap, smallest_gap : float, optional
        Pressure (Pa), by default nearly of whole contact, and mean gaps from the law's zero (m) that the curve reaches.
    gaps, scales : int, optional
        Nodes of the gap, and steps of the roughness; wider roughness has more nodes, wider bands have more steps.
    tolerance, iterations : float, int, optional
        Largest change of a scale's mean response in the last sweep, and sweeps of a state at most.
    kernel, options : tuple of float, EdgeFlowOptions, optional
        Slope s, level t and pole b of κ(X) = s X + t + (1 − t) b/(X + b) on a half-space; numerical choices.
    branch : str, optional
        ``"loading"``, or ``"unloading"`` with the work of adhesion of :func:`apparent_adhesion`, which may warn.

    Returns
    -------
    EdgeFlow
        The curve; states at a pressure or mean gap follow from it.

    Raises
    ------
    ValueError
        If a number is no number, too small, or a pressure or mean gap beyond the nodes, if the law has no core, or if
        the branch is unknown.

    Examples
    --------
    >>> from theory import LennardJones104, SelfAffineSpectrum, edge_flow
    >>> spectrum = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
    >>> flow = edge_flow(spectrum, 93.7e9, LennardJones104(work_of_adhesion=0.1, length=3.28e-10), gaps=120, scales=30)
    >>> state = flow.at_pressure(1e9)
    >>> 0 < state.fraction_below(3.68e-10) < 1
    True
    """
    for name, number, least in (("gaps", gaps, 8), ("scales", scales, 8), ("iterations", iterations, 1)):
        if not (isinstance(number, int) and number >= least):
            raise ValueError(f"{name} = {number!r}: must be a whole number, {least} at least")
    if not finite("tolerance", tolerance, "1") > 0:
        raise ValueError(f"tolerance = {tolerance!r}: must be positive")
    finite("largest_gap", largest_gap, "m")
    if branch not in EDGE_FLOW_BRANCHES:
        raise ValueError(f"branch = {branch!r}: expected one of {', '.join(EDGE_FLOW_BRANCHES)}")
    length = core_of(law)
    solid = elasticity_of(elasticity)
    modulus = solid.contact_modulus
    if branch == "unloading":
        law = stronger(law, apparent_adhesion(spectrum, solid, law))
    reduced = law.scaled(length, modulus)
    nodes = nodes_even_in_stress(spectrum, solid, reduced, length, largest_gap, gaps)
    x = nodes.gaps
    traction = np.array(reduced.traction(x), dtype=float)
    deviation = float(np.sqrt(spectrum.full_contact_stress_variance(solid.stiffness))) / modulus
    highest = max(_WHOLE_CONTACT * deviation, reduced.peak_tensile_stress)
    if highest_pressure is not None:
        highest = finite("highest_pressure", highest_pressure, "Pa") / modulus
    # Local pressures scatter about the mean one, and the nodes must hold them.
    reach = float(-traction[0]) - 5 * deviation
    if highest > reach:
        raise ValueError(f"highest_pressure = {highest * modulus:g} Pa: the nodes reach {reach * modulus:.3g} Pa")
    far = max(2 + _FAR * np.sqrt(spectrum.mean_square_height) / length, largest_gap / length)
    near = far if smallest_gap is None else finite("smallest_gap", smallest_gap, "m") / length
    if near <= x[0]:
        raise ValueError(f"smallest_gap = {smallest_gap:g} m: the nodes begin at {x[0] * length:.6g} m")
    share = law.work_of_adhesion / float(spectrum.full_contact_energy(solid.stiffness))
    for count in (scales, options.more_scales * scales):
        steps = scales_of(spectrum, solid, length, count, options)
        problem = Problem(x, traction, steps, tolerance, iterations, kernel, options)
        softening = f"softening {reduced.strongest_softening / float(steps.stiffness[0]):.2g}"
        limit = f"{share:.2g} of the energy of full contact, {softening} times the finest wave's stiffness"
        found = curve(problem, far, near, highest, count > scales)
        flow = EdgeFlow(reduced, length, modulus, *found, limit, problem, nodes, branch)
        if flow.converged:
            break
    return flow
