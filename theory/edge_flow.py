"""Edge flow: the gap flow whose response to a wave costs the elastic energy of its own modulation.

The gap-flow theory (:mod:`theory.gap_flow`) lets every point of a wave answer by its own gap alone, so that contact has
no edges. Here the displacement answers the roughness h of wavevector q by (1 − f(u)) h, where u is the gap with all
coarser roughness, and the gap changes by −f h. For this trial field the distribution P of the gap and its mean-square
gradient, M(u) = P <|∇u|² | u>, follow from coarse to fine, starting from δ(u − ū) and zero, with the height variance m:

    ∂P/∂m = ½ (f² P)'',     M = f² N,     ∂N/∂m = ½ f⁻² (f⁴ N')' + f'² N + q² P.

The mean traction s(u) at a coarse gap u follows from fine to coarse, starting from φ'(u), and with it its slope c:

    ∂s/∂m = ½ f² s'',     c = s'.

On a half-space a wave that is modulated with the wavenumber p costs ½E* <|q + p|>, not K = ½E* q. As
X = −(P q²)⁻¹ ∂ M ∂ stands for p²/q² on functions of u, equilibrium of the scale asks

    [κ(X) K + c] f = K,     κ(X) = 1 + g [X/4 + 4/(X + 4) − 1],

with g = 1. On another solid g(q) is what a modulation of twice the wavenumber costs there over its cost on a half-space
(:func:`theory.edge_equilibrium.modulation_cost`); on a bed of springs nothing, and f = K/(K + c) as in the gap flow.
With E = <φ> + Σ ½ Δm <c f (1 − f)> the pressure is −dE/dū. The mean traction would be the same number if the trial
field were exact: their difference is the theory's own measure of its error.

There is no hull and no hysteresis: one state at each mean gap.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from contact_study.fields.arguments import finite
from contact_study.fields.spectrum import RoughnessSpectrum
from contact_study.problem.elasticity import Elasticity, elasticity_of
from contact_study.problem.laws.base import TractionLaw
from theory.edge_equilibrium import KERNEL, Equilibrium, Problem, scales_of
from theory.gap_flow import gap_nodes
from theory.gap_nodes import GapNodes
from theory.gap_state import GapState
from theory.pressure_curve import PressureCurve, core_of, positions

# Nodes of the gap and steps of the roughness.
EDGE_FLOW_GAPS, EDGE_FLOW_SCALES = 240, 80

# Approach: mean gap, in rms heights beyond twice the law's own, at which nothing is felt yet; the ratio of distances to
# the lowest node from one mean gap to the next.
_FAR, _RATIO = 7.0, 0.85

# Halvings of the step between two mean gaps where the iteration does not find the next, and states that are not found
# in a row before the curve ends.
_HALVINGS, _LOST = 3, 3

# Order of the spline through the energy, and points of its derivative between two mean gaps.
_ORDER, _POINTS = 5, 16

# States of the curve from which the start of one between them is interpolated.
_NEIGHBOURS = 4

# Pressure, in deviations of the stress of full contact, that the curve reaches if none is asked.
_WHOLE_CONTACT = 4.0


@dataclass(frozen=True)
class EdgeFlow(PressureCurve):
    """The curve of mean pressure over mean gap, and the states along it.

    Attributes
    ----------
    law : TractionLaw
        The law in units of ``length`` and ``contact_modulus``.
    length, contact_modulus : float
        The units (m, Pa).
    equilibria : tuple of Equilibrium
        The states that make the curve, mean gaps falling, in these units.
    """

    law: TractionLaw
    length: float
    contact_modulus: float
    equilibria: tuple[Equilibrium, ...]
    _problem: Problem

    @property
    def converged(self) -> bool:
        """Whether every state of the curve met the tolerance."""
        return all(self._solved(found) for found in self.equilibria)

    @property
    def unconverged_states(self) -> int:
        """States of the curve that did not meet the tolerance."""
        return sum(not self._solved(found) for found in self.equilibria)

    @property
    def sweeps(self) -> int:
        """Sweeps through all scales that the curve took."""
        return sum(found.sweeps for found in self.equilibria)

    @cached_property
    def _nodes(self) -> GapNodes:
        return GapNodes(self.law, self._problem.gaps)

    @cached_property
    def mean_gap(self) -> np.ndarray:
        """Rising mean gaps, from the law's zero, at which :attr:`pressure` stands, shape (n,) (m)."""
        ends = np.array([found.gap for found in reversed(self.equilibria)])
        pieces = np.arange(_POINTS) / _POINTS
        return np.append((ends[:-1, None] + np.diff(ends)[:, None] * pieces).ravel(), ends[-1]) * self.length

    @cached_property
    def pressure(self) -> np.ndarray:
        """p = −dE/dū, shape (n,) (Pa)."""
        return -self._energy(self.mean_gap / self.length, 1) * self.contact_modulus

    @cached_property
    def _energy(self) -> BSpline:
        """E over the mean gap, in the units of the flow."""
        potential = self.law.potential(self._problem.gaps)
        rising = self.equilibria[::-1]
        energies = [float(found.weights @ potential) + found.elastic for found in rising]
        order = min(_ORDER, len(rising) // 2 * 2 - 1)  # odd, and less than the states: a curve that ended early has few
        return make_interp_spline([found.gap for found in rising], energies, k=order)

    @property
    def pull_off_pressure(self) -> float:
        """Lowest pressure of the curve, the end of adhesion under pressure control (Pa).

        NaN where the curve does not reach as far as that: its lowest pressure is the one of its smallest mean gap.
        """
        lowest = int(np.argmin(self.pressure))
        return float(self.pressure[lowest]) if lowest > 0 else float("nan")

    def pressure_at(self, mean_gap: float) -> float:
        """Pressure at a mean gap within the curve (Pa)."""
        return -float(self._energy(mean_gap / self.length, 1)) * self.contact_modulus

    def states(self, mean_gaps: np.ndarray) -> list[GapState]:
        """Distribution of the local gap at each mean gap (m), each solved anew from its neighbours on the curve.

        Raises
        ------
        ValueError
            If a mean gap is no number or outside the curve.
        """
        return [self._state(gap) for gap in positions(mean_gaps, self.mean_gap[0], self.mean_gap[-1])]

    def _state(self, mean_gap: float) -> GapState:
        gaps = np.array([found.gap for found in self.equilibria])
        after = int(np.clip(np.searchsorted(-gaps, -mean_gap / self.length), 1, gaps.size - 1))
        first = int(np.clip(after - _NEIGHBOURS // 2, 0, max(gaps.size - _NEIGHBOURS, 0)))
        gap = float(np.clip(mean_gap / self.length, gaps[-1], gaps[0]))
        start = self._problem.between(self.equilibria[first : first + _NEIGHBOURS], gap)
        found = self._problem.solve(gap, start)
        # The spline's slope rests on the neighbours, a few of them on either side.
        rests_on = (found, *self.equilibria[max(after - 2, 0) : after + 2])
        return GapState(
            ("edge_flow",),
            self._nodes,
            self.length,
            self.contact_modulus,
            mean_gap,
            self.pressure_at(gap * self.length),
            found.elastic * self.contact_modulus * self.length,
            found.weights,
            all(self._solved(state) for state in rests_on),
            found.change,
        )

    def _solved(self, found: Equilibrium) -> bool:
        return found.change <= self._problem.tolerance


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
) -> EdgeFlow:
    """Edge flow of a surface, approached from far away.

    Areas converge with the second order of the nodes; the number of scales hardly matters (1e-4 from 80 to 320). At the
    default resolution the area of the paper's surface at 1 GPa is 0.13 % too large at ε0 and 0.5 % at 8 ε0.

    Parameters
    ----------
    spectrum : RoughnessSpectrum
        Roughness, a target or that of a surface.
    elasticity : Elasticity or float
        The solid; a number is the contact modulus E* of a half-space (Pa).
    law : TractionLaw
        Interaction of smooth surfaces.
    highest_pressure : float, optional
        Pressure that the curve reaches (Pa); by default one at which contact is all but whole.
    largest_gap, smallest_gap : float, optional
        Mean gaps, from the law's zero, that it reaches, too (m).
    gaps, scales : int, optional
        Nodes of the gap and steps of the roughness.
    tolerance : float, optional
        Largest change of a scale's mean response in the last sweep.
    iterations : int, optional
        Sweeps of a state before it is approached in smaller steps, or given up and flagged.
    kernel : tuple of float, optional
        Slope s, level t and pole b of κ(X) = s X + t + (1 − t) b/(X + b), what a modulation costs on a half-space.

    Raises
    ------
    ValueError
        If a number is no number, too small, or a pressure or mean gap beyond the nodes, or if the law has no core.

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
    length = core_of(law)
    solid = elasticity_of(elasticity)
    modulus = solid.contact_modulus
    reduced = law.scaled(length, modulus)
    x = gap_nodes(spectrum, solid, reduced, length, largest_gap, gaps)
    traction = np.array(reduced.traction(x), dtype=float)
    deviation = float(np.sqrt(spectrum.full_contact_stress_variance(solid.stiffness))) / modulus
    if highest_pressure is None:
        highest = max(_WHOLE_CONTACT * deviation, reduced.peak_tensile_stress)
    else:
        highest = finite("highest_pressure", highest_pressure, "Pa") / modulus
    # Local pressures scatter about the mean one, and the nodes must hold them.
    reach = float(-traction[0]) - 5 * deviation
    if highest > reach:
        raise ValueError(f"highest_pressure = {highest * modulus:g} Pa: the nodes reach {reach * modulus:.3g} Pa")
    far = max(2 + _FAR * np.sqrt(spectrum.mean_square_height) / length, largest_gap / length)
    near = far if smallest_gap is None else finite("smallest_gap", smallest_gap, "m") / length
    if near <= x[0]:
        raise ValueError(f"smallest_gap = {smallest_gap:g} m: the nodes begin at {x[0] * length:.6g} m")
    problem = Problem(x, traction, scales_of(spectrum, solid, length, scales), tolerance, iterations, kernel)
    return EdgeFlow(reduced, length, modulus, _approach(problem, far, near, highest), problem)


def _approach(problem: Problem, far: float, near: float, highest: float) -> tuple[Equilibrium, ...]:
    """States along falling mean gaps until both the smallest and the highest pressure are passed.

    They lie on nodes: a mean gap between nodes begins as a little scatter about it, whose energy depends on where
    between and would stand in the pressure as a ripple.
    """
    x = problem.gaps
    node = min(int(np.searchsorted(x, far)), x.size - 2)
    found = [problem.solve(float(x[node]), problem.local())]
    sound = found.copy()
    passed = lost = 0
    while passed < 2 and lost < _LOST and node > 1:  # one more: a spline is at its best between its points
        before = node
        node = min(int(np.searchsorted(x, x[0] + _RATIO * (x[before] - x[0]))), before - 1)
        state = _next(problem, sound, float(x[node]))
        for _ in range(_HALVINGS):
            if state.change <= problem.tolerance or node == before - 1:
                break
            node = (before + node + 1) // 2
            state = _next(problem, sound, float(x[node]))
        found.append(state)
        if state.change <= problem.tolerance:
            sound = [sound[-1], state]
            lost = 0
        else:
            lost += 1
        passed += bool(x[node] <= near and -(state.weights @ problem.traction) >= highest)
    return tuple(found)


def _next(problem: Problem, sound: list[Equilibrium], gap: float) -> Equilibrium:
    """The state at a mean gap, from the one or two last ones that converged."""
    return problem.solve(gap, problem.between(sound, gap))
