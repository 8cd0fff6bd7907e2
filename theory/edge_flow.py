"""Edge flow: the gap flow whose response to a wave costs the elastic energy of its own modulation.

The gap-flow theory (:mod:`theory.gap_flow`) lets every point of a wave answer by its own gap alone, so that contact has
no edges. Here the displacement answers the roughness h of wavevector q by (1 − f(u)) h, where u is the gap with all
coarser roughness, and the gap changes by −f h. For this trial field the distribution P of the gap and its mean-square
gradient, M(u) = P <|∇u|² | u>, follow from coarse to fine, starting from δ(u − ū) and zero, with the height variance m:

    ∂P/∂m = ½ (f² P)'',     M = f² N,     ∂N/∂m = ½ f⁻² (f⁴ N')' + f'² N + q² P.

The mean traction s(u) at a coarse gap u follows from fine to coarse, starting from φ'(u), and with it its slope c:

    ∂s/∂m = ½ f² s'',     c = s'.

A wave that is modulated with the wavenumber p costs ½E* <|q + p|>, not K = ½E* q. As X = −(P q²)⁻¹ ∂ M ∂ stands for
p²/q² on functions of u, equilibrium of the scale asks

    [κ(X) K + c] f = K,     κ(X) = X/4 + 4/(X + 4),

which κ = 1 would make the gap flow's f = K/(K + c).

Numerics. All f(u) of all scales are the unknowns of one fixed point: a sweep finds P and M from coarse to fine, s from
fine to coarse, and the f that are in equilibrium with them. Written so, no second derivative of f occurs and every
high-frequency change of f is damped by the implicit step that it acts in: the iteration is as good on fine grids as on
coarse ones. Its slowest modes are a few smooth ones (one near −2.4 and a complex pair beyond the unit circle at strong
adhesion), which Anderson's acceleration deals with; ln f is mixed, weighted by the area that it concerns. Steps of the
variance are short at both its ends, where the data are sharp: a long finest step makes the solution fold over in ū.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from contact_study.fields.spectrum import RoughnessSpectrum
from contact_study.problem.elasticity import Elasticity, elasticity_of
from contact_study.problem.laws.base import TractionLaw
from theory.edge_steps import local_response, sweep
from theory.gap_flow import gap_nodes
from theory.gap_state import GapState

# Bounds of the response: nothing follows more than three times its wave; contact gives way by K/(K + c).
_LEAST, _LARGEST = 1e-3, 20.0

# Coarse scales in which the distribution is still sharp.
_SHARP = 6

# States that Anderson's acceleration remembers, and the share of the change that it takes.
_MEMORY, _MIXING = 10, 0.5

# Area per scale below which a node's change does not count.
_UNSEEN = 1e-14

# Approach: mean gap at which nothing is felt yet, in rms heights, and largest ratio of neighbouring gaps.
_FAR, _RATIO = 4.8, 1.15

# Halvings of the way between two mean gaps where the iteration does not find the next.
_HALVINGS = 3


@dataclass(frozen=True)
class EdgeFlow:
    """States of the edge flow along mean gaps.

    Attributes
    ----------
    law : TractionLaw
        The law in units of ``length`` and ``contact_modulus``.
    length, contact_modulus : float
        The units (m, Pa).
    gaps : numpy.ndarray, shape (n,)
        Nodes of the local gap, in units of the length.
    mean_gap : numpy.ndarray, shape (k,)
        ū from the law's zero, falling (m).
    weights : numpy.ndarray, shape (k, n)
        Share of the area at each node.
    energy, elastic_energy : numpy.ndarray, shape (k,)
        Per nominal area (J/m²).
    mean_traction : numpy.ndarray, shape (k,)
        −<φ'> (Pa); what it lacks to :attr:`pressure` is the theory's own inconsistency.
    change : numpy.ndarray, shape (k,)
        Largest change of a scale's mean response in the last iteration.
    iterations : numpy.ndarray, shape (k,)
        Sweeps that each state took, those on the way to it among them.
    converged : numpy.ndarray, shape (k,)
        Whether the change met the tolerance.
    """

    law: TractionLaw
    length: float
    contact_modulus: float
    gaps: np.ndarray
    mean_gap: np.ndarray
    weights: np.ndarray
    energy: np.ndarray
    elastic_energy: np.ndarray
    mean_traction: np.ndarray
    change: np.ndarray
    iterations: np.ndarray
    converged: np.ndarray

    @property
    def pressure(self) -> np.ndarray:
        """p = −dE/dū along the mean gaps, by a spline through them (Pa)."""
        curve = CubicSpline(self.mean_gap[::-1], self.energy[::-1])
        return -curve(self.mean_gap, 1)

    def states(self) -> list[GapState]:
        """The distribution at each mean gap."""
        return [
            GapState(self.law, self.length, self.contact_modulus, float(gap), float(p), float(elastic), self.gaps, row)
            for gap, p, elastic, row in zip(
                self.mean_gap, self.pressure, self.elastic_energy, self.weights, strict=True
            )
        ]


def edge_flow(
    spectrum: RoughnessSpectrum,
    elasticity: Elasticity | float,
    law: TractionLaw,
    mean_gaps: np.ndarray,
    gaps: int = 240,
    scales: int = 80,
    tolerance: float = 1e-6,
    iterations: int = 100,
) -> EdgeFlow:
    """Edge flow at several mean gaps, approached from far away.

    Parameters
    ----------
    spectrum : RoughnessSpectrum
        Roughness.
    elasticity : Elasticity or float
        The solid; a number is the contact modulus E* of a half-space (Pa).
    law : TractionLaw
        Interaction of smooth surfaces.
    mean_gaps : numpy.ndarray, shape (k,)
        ū from the law's zero, in any order (m); the result has them falling.
    gaps, scales : int, optional
        Nodes of the gap and steps of the roughness.
    tolerance : float, optional
        Largest change of a scale's mean response in the last iteration.
    iterations : int, optional
        Sweeps of a state before it is approached in smaller steps, or given up.

    Raises
    ------
    ValueError
        If a mean gap is outside the nodes.
    """
    length = law.equilibrium_distance
    solid = elasticity_of(elasticity)
    contact_modulus = solid.contact_modulus
    reduced = law.scaled(length, contact_modulus)
    x = gap_nodes(spectrum, solid, reduced, length, float(np.max(mean_gaps)), gaps)
    problem = _Problem(x, *_scales(spectrum, length, scales), np.array(reduced.traction(x)))
    wanted = np.sort(np.asarray(mean_gaps, dtype=float) / length)[::-1]
    if wanted[0] >= x[-1] or wanted[-1] <= x[0]:
        raise ValueError("mean_gaps: outside the nodes of the flow")
    far = 1 + _FAR * np.sqrt(spectrum.mean_square_height) / length
    found = [state for state in problem.approach(_path(wanted, far), tolerance, iterations) if state.gap in wanted]
    weights = np.array([state.weights for state in found])
    elastic = np.array([state.elastic for state in found])
    potential, traction = reduced.potential(x), problem.traction
    change = np.array([state.change for state in found])
    return EdgeFlow(
        reduced,
        length,
        contact_modulus,
        x,
        np.array([state.gap for state in found]) * length,
        weights,
        (weights @ potential + elastic) * contact_modulus * length,
        elastic * contact_modulus * length,
        -(weights @ traction) * contact_modulus,
        change,
        np.array([state.iterations for state in found]),
        change <= tolerance,
    )


def _path(wanted: np.ndarray, far: float) -> np.ndarray:
    """Falling mean gaps from where nothing is felt yet through all that are wanted."""
    stops = np.concatenate([[max(far, wanted[0])], wanted])
    path = [stops[:1]]
    for before, behind in zip(stops[:-1], stops[1:], strict=True):
        pieces = max(int(np.ceil(np.log(before / behind) / np.log(_RATIO))), 1)
        path.append(np.append(np.geomspace(before, behind, pieces + 1)[1:-1], behind))
    return np.unique(np.concatenate(path))[::-1]


def _scales(spectrum: RoughnessSpectrum, length: float, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness, wavevector and height variance of each step, fine first, short at both ends of the variance."""
    fine = spectrum.band_edges(20000)
    below = 2 * np.pi * spectrum.moment(1, upper=fine)
    rising = np.concatenate([[True], np.diff(below) > 0])
    shares = 0.5 * (1 + np.cos(np.pi * np.arange(count + 1) / count))  # of the variance that is coarser
    edges = np.interp(shares * below[-1], below[rising], fine[rising])
    variance = -2 * np.pi * np.diff(spectrum.moment(1, upper=edges))
    wavevector = -2 * np.pi * np.diff(spectrum.moment(2, upper=edges)) / variance * length
    return 0.5 * wavevector, wavevector, variance / length**2


@dataclass(frozen=True)
class _State:
    gap: float
    weights: np.ndarray
    elastic: float
    change: float
    iterations: int
    response: np.ndarray


class _Problem:
    """The fixed point of all responses, in units of the law's length and the modulus."""

    def __init__(self, x, stiffness, wavevector, steps, traction):
        self.x, self.stiffness, self.wavevector, self.steps, self.traction = x, stiffness, wavevector, steps, traction
        shape = (steps.size, x.size)
        self._weights, self._gradients = np.empty((steps.size + 1, x.size)), np.empty((steps.size + 1, x.size))
        self._answer = np.empty(shape)
        self._elastic = 0.0

    def approach(self, path: np.ndarray, tolerance: float, iterations: int) -> Iterator[_State]:
        """States along falling mean gaps, each started from those before it."""
        response = np.empty((self.steps.size, self.x.size))
        local_response(self.x, self.stiffness, self.steps, self.traction, response)
        before: list[tuple[float, np.ndarray]] = []  # of the last two states that converged
        for gap in path:
            sweeps = 0
            for _ in range(2**_HALVINGS):
                target = gap
                for _ in range(_HALVINGS + 1):
                    start = _extrapolated(before, target) if before else response
                    state = self.solve(target, start, tolerance, iterations)
                    sweeps += state.iterations
                    if state.change <= tolerance or not before:
                        break
                    target = 0.5 * (before[-1][0] + target)
                if state.change <= tolerance:
                    before = [*before[-1:], (target, state.response)]
                if target == gap or state.change > tolerance:
                    break
            if target != gap:  # the way is barred: the state that the iteration leaves is given, and flagged
                state = self.solve(gap, before[-1][1], tolerance, iterations)
            response = state.response
            yield _State(gap, state.weights, state.elastic, state.change, sweeps, state.response)

    def solve(self, gap: float, response: np.ndarray, tolerance: float, iterations: int) -> _State:
        """State at one mean gap, from a first response."""
        start = np.zeros(self.x.size)
        right = int(np.searchsorted(self.x, gap))
        share = (gap - self.x[right - 1]) / (self.x[right] - self.x[right - 1])
        start[right - 1], start[right] = 1 - share, share

        def update(logarithm: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
            f = np.exp(logarithm)
            self._elastic = sweep(
                self.x,
                self.stiffness,
                self.wavevector,
                self.steps,
                self.traction,
                start,
                _SHARP,
                f,
                self._weights,
                self._gradients,
                self._answer,
            )
            answer = np.clip(self._answer, _LEAST, _LARGEST)
            area = np.maximum(0.5 * (self._weights[1:] + self._weights[:-1]), 0.0)
            change = float(np.max(np.sum(area * np.abs(answer - f), axis=1)))
            return np.log(answer) - logarithm, np.sqrt(area + _UNSEEN) * f, change

        bounds = (np.log(_LEAST), np.log(_LARGEST))
        logarithm, change, count = _accelerated(update, np.log(response), bounds, tolerance, iterations)
        return _State(gap, self._weights[0].copy(), self._elastic, change, count, np.exp(logarithm))


def _extrapolated(before: list[tuple[float, np.ndarray]], gap: float) -> np.ndarray:
    """Response at a mean gap from those at two larger ones, along straight lines of ln f over ln ū."""
    (last, response), (first, earlier) = before[-1], before[0]
    if first == last:
        return response
    step = np.log(gap / last) / np.log(last / first) * np.log(response / earlier)
    return np.clip(response * np.exp(np.clip(step, -0.5, 0.5)), _LEAST, _LARGEST)


def _accelerated(
    update: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, float]],
    values: np.ndarray,
    bounds: tuple[float, float],
    tolerance: float,
    iterations: int,
) -> tuple[np.ndarray, float, int]:
    """Anderson's acceleration of a fixed point; returns the values, their last change and the updates made.

    ``update`` gives the residual of the values, the weight of each in the least squares and the change to be stopped
    at. D. G. Anderson, J. ACM 12, 547 (1965).
    """
    past_values: list[np.ndarray] = []
    past_residuals: list[np.ndarray] = []
    for count in range(1, iterations + 1):
        residual, weight, change = update(values)
        if change <= tolerance or not np.isfinite(change) or count == iterations:
            break
        past_values = [*past_values[-_MEMORY:], values]
        past_residuals = [*past_residuals[-_MEMORY:], residual]
        moved = _MIXING * residual
        if len(past_values) > 1:
            steps = np.diff(past_values, axis=0)
            turns = np.diff(past_residuals, axis=0)
            weighted = (turns * weight).reshape(len(turns), -1)
            normal = weighted @ weighted.T
            normal[np.diag_indices_from(normal)] += 1e-12 * np.trace(normal)
            shares = np.linalg.solve(normal, weighted @ (residual * weight).ravel())
            moved = moved - np.tensordot(shares, steps + _MIXING * turns, axes=1)
        values = np.clip(values + moved, *bounds)
    return values, change, count
