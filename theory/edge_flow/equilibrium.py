"""The states of the edge flow: all responses at a mean gap in equilibrium; see :mod:`theory.edge_flow.flow`.

All f(u) of all scales are the unknowns of one fixed point, whose few slow modes Anderson's acceleration deals with.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity
from theory.edge_flow.kernels import bounded_area, compare, differences, local_response, sweep
from theory.numerics.fixed_point import accelerated

# Slope s, level t and pole b of the cost κ(X) = s X + t + (1 − t) b/(X + b) of a modulation on a half-space.
KERNEL = (0.25, 0.0, 4.0)


@dataclass(frozen=True)
class EdgeFlowOptions:
    """Numerical choices of the edge flow; the defaults serve all surfaces and laws that were tried."""

    least: float = 1e-6  # bounds of the response f; a short core holds a gap to far less than a wave
    largest: float = 20.0
    sharp_scales: int = 6  # coarse ones, of a sharp distribution, taken by the implicit Euler method
    unseen_area: float = 1e-9  # area per scale below which the change of a node does not count
    step: float = 1.0  # largest change of ln f in an iteration
    restarts: int = 3  # halvings of an iteration that leads to no numbers
    extrapolation: float = 0.2  # largest change of ln f by which a start is extrapolated
    bands: int = 20000  # in which the variance is tabulated, to be cut into scales
    finest_variance: float = 0.01  # and that of all finer ones a scale has at most, in squares of the law's length
    widest_band: float = 0.25  # of a scale in ln q
    modulation: float = 2.0  # its wavenumber, in those of the wave, at which solids are compared with the half-space
    weakest: float = 0.05  # part of the law from which adhesion is grown at one mean gap
    growth: float = 1.5  # of that part, at first and at least
    least_growth: float = 1.1
    gap_ratio: float = 0.85  # of the distances to the lowest node from one mean gap of the curve to the next
    halvings: int = 3  # of that step
    lost: int = 3  # states lost in a row that end the curve
    fewest: int = 4  # states of a piece
    deepest: float = 0.5  # of the distance to the lowest node where states begin that are followed from contact outward
    in_contact: tuple[float, int] = (0.01, 3)  # of the tolerance, and times the iterations, for these
    bounded_area: float = 0.1  # of a scale in which the growth of the gradients may be bounded
    more_scales: int = 3  # times as many scales, where that is larger or states are lost
    starts: tuple[float, ...] = (0.7, 0.45, 0.25, 0.1, 0.04)  # of the approach's end, where adhesion is grown instead


_DEFAULT = EdgeFlowOptions()


class Scales(NamedTuple):
    """Steps of the roughness from fine to coarse, shape (k,) each, in units of a length and a modulus."""

    stiffness: np.ndarray  # K, the mean over the height variance, which makes the energy of full contact exact
    modulation: np.ndarray  # g, the cost of a modulation compared with a half-space: 1 there, 0 on springs
    square: np.ndarray  # q², the mean over the height variance, which makes the mean-square slope exact
    steps: np.ndarray  # height variance Δm


def scales_of(
    spectrum: RoughnessSpectrum, solid: Elasticity, length: float, count: int, options: EdgeFlowOptions = _DEFAULT
) -> Scales:
    """Steps in units of ``length`` (m), ``count`` at least, short at both ends of the variance, with its sharp data."""
    bands = spectrum.band_edges(options.bands)
    below = 2 * np.pi * spectrum.moment(1, upper=bands)
    rising = np.concatenate([[True], np.diff(below) > 0])
    shares = 0.5 * (1 + np.cos(np.pi * np.arange(count + 1) / count))  # of the variance that is coarser
    edges = np.interp(shares * below[-1], below[rising], bands[rising])
    edges = _shortened(edges, bands, below[-1] - below, length, options)
    variance = -2 * np.pi * np.diff(spectrum.moment(1, upper=edges))
    # Differences of sums over all waves may be off by their rounding, where steps are as small.
    square = -2 * np.pi * np.diff(spectrum.moment(3, upper=edges)) / variance
    stiffness = -2 * np.diff(spectrum.full_contact_energy(solid.stiffness, edges)) / variance
    every = solid.stiffness(bands)
    square = np.clip(square, bands[0] ** 2, bands[-1] ** 2)
    stiffness = np.clip(stiffness, every.min(), every.max()) * length / solid.contact_modulus
    return Scales(stiffness, modulation_cost(solid, np.sqrt(square)), square * length**2, variance / length**2)


def _shortened(
    edges: np.ndarray, bands: np.ndarray, finer: np.ndarray, length: float, options: EdgeFlowOptions
) -> np.ndarray:
    """Ends of steps, wavevectors falling, with those cut that are long in ln q or beside the finer variance."""
    doublings = np.log2(1 + finer / (options.finest_variance * length**2))
    octaves = np.log(bands[-1] / bands) / options.widest_band
    pieces = np.ones(edges.size - 1)
    for measure in (doublings, octaves):
        pieces = np.maximum(pieces, np.diff(np.interp(edges, bands, measure)) - 1e-6)
    both = np.interp(edges, bands, doublings + octaves)
    ends = [np.linspace(*pair, int(np.ceil(n)), endpoint=False) for pair, n in zip(pairwise(both), pieces, strict=True)]
    cut = np.interp(-np.concatenate([*ends, both[-1:]]), -(doublings + octaves), bands)
    cut[np.cumsum([0, *map(len, ends)])] = edges  # as they were, to the last digit
    return cut


def modulation_cost(solid: Elasticity, wavenumber: np.ndarray) -> np.ndarray:
    """The cost of modulating a wave, compared with a half-space: g = 1 there, 0 where all waves are as stiff.

    1/(K(q) + c) becomes the mean of 1/(K(|q + p|) + c) over directions, here at p = 2q and c = K(q), by which K(q)
    seems to grow. Where long waves are stiffer it costs nothing.
    """
    angles = (np.arange(64) + 0.5) * np.pi / 64  # the midpoint rule converges exponentially on a period
    together = np.sqrt(1 + _DEFAULT.modulation**2 + 2 * _DEFAULT.modulation * np.cos(angles))

    def growth(relative: np.ndarray) -> np.ndarray:
        return 1 / np.mean(1 / (relative + 1), axis=-1) - 2

    relative = solid.stiffness(wavenumber[:, None] * together) / solid.stiffness(wavenumber)[:, None]
    return np.maximum(growth(relative) / growth(together), 0.0)


@dataclass(frozen=True)
class Equilibrium:
    """The state at one mean gap ū."""

    gap: float
    weights: np.ndarray  # share of the area at each node, shape (n,)
    elastic: float  # energy
    change: float  # largest one of a scale's mean response in the last sweep
    sweeps: int
    response: np.ndarray  # f of each scale, shape (k, n)
    bounded: float = 0.0  # largest area of a scale whose step is too long for the growth of the gradients

    @cached_property
    def logarithm(self) -> np.ndarray:
        """ln f, from which neighbours start."""
        return np.log(self.response)


Piece = tuple[Equilibrium, ...]


@dataclass(frozen=True)
class Problem:
    """A law on nodes of the gap, φ' at these, and the roughness that it is in equilibrium with, in its units."""

    gaps: np.ndarray
    traction: np.ndarray
    scales: Scales
    tolerance: float  # largest change of a scale's mean response in the last sweep
    iterations: int  # sweeps of a state at most
    kernel: tuple[float, float, float] = KERNEL
    options: EdgeFlowOptions = _DEFAULT

    @cached_property
    def _geometry(self) -> np.ndarray:
        return differences(self.gaps)

    def local(self) -> np.ndarray:
        """Response to a law that the finer scales only smooth, shape (k, n): where nothing touches."""
        response = np.empty((self.scales.steps.size, self.gaps.size))
        local_response(self._geometry, self.scales.stiffness, self.scales.steps, self.traction, response)
        return response

    def between(self, states: Sequence[Equilibrium], gap: float) -> np.ndarray:
        """Response at a mean gap from those at others, shape (k, n): ln f a polynomial of ln ū, bounded beyond them."""
        places, place = np.log([state.gap for state in states]), np.log(gap)
        logarithm = np.zeros_like(states[-1].response)
        for own, state in zip(places, states, strict=True):
            others = places[places != own]
            logarithm += np.prod((place - others) / (own - others)) * state.logarithm
        if not places.min() <= place <= places.max():
            last = states[-1].logarithm
            logarithm = last + np.clip(logarithm - last, -self.options.extrapolation, self.options.extrapolation)
        return np.clip(np.exp(logarithm), self.options.least, self.options.largest)

    def grown(self, gap: float) -> Equilibrium:
        """The state at a mean gap, followed from a weaker law of the same range to the law itself."""
        options = self.options
        weaker = replace(self, traction=options.weakest * self.traction)
        states, strength, growth = [weaker.solve(gap, weaker.local())], options.weakest, options.growth
        bounds, reach = np.log([options.least, options.largest]), options.extrapolation
        while strength < 1 and growth > options.least_growth and states[-1].change <= self.tolerance:
            stronger = min(growth * strength, 1.0)
            start = states[-1].response
            if len(states) > 1:
                last, before = states[-1].logarithm, states[-2].logarithm
                start = np.exp(np.clip(last + np.clip(last - before, -reach, reach), *bounds))
            state = replace(self, traction=stronger * self.traction).solve(gap, start)
            if state.change <= self.tolerance:
                states, strength = [states[-1], state], stronger
            else:
                growth = np.sqrt(growth)
        return states[-1] if strength == 1 else replace(states[-1], change=np.inf)

    def solve(self, gap: float, response: np.ndarray) -> Equilibrium:
        """The state at a mean gap, from a first response."""
        x, scales, options = self.gaps, self.scales, self.options
        bounds = options.least, options.largest
        start, right = np.zeros(x.size), min(max(int(np.searchsorted(x, gap)), 1), x.size - 1)
        share = (gap - x[right - 1]) / (x[right] - x[right - 1])
        start[right - 1], start[right] = 1 - share, share
        weights, gradients = np.empty((2, scales.steps.size + 1, x.size))
        answer, f, weight = (np.empty_like(response) for _ in range(3))
        factors = np.empty((scales.steps.size, 3, x.size))
        given = x, self._geometry, tuple(scales), self.kernel, self.traction, start, options.sharp_scales
        elastic = 0.0

        def update(logarithm: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
            nonlocal elastic
            np.exp(logarithm, out=f)
            elastic = sweep(*given, f, weights, gradients, answer, factors)
            change = compare(weights, f, answer, *bounds, options.unseen_area, weight)
            residual = np.log(answer)
            residual -= logarithm
            return residual, weight, change

        first, limits = np.log(np.clip(response, *bounds)), (np.log(options.least), np.log(options.largest))
        ends = self.tolerance, self.iterations
        logarithm, change, count = accelerated(
            update, first, limits, *ends, largest_step=options.step, restarts=options.restarts
        )
        found = np.exp(logarithm)
        bounded = float(bounded_area(self._geometry, scales.steps, options.sharp_scales, found, weights))
        return Equilibrium(gap, weights[0].copy(), elastic, change, count, found, bounded)


def curve(problem: Problem, far: float, near: float, highest: float, thorough: bool) -> tuple[tuple[Piece, ...], int]:
    """Pieces of the curve, from far to contact with falling mean gaps in each, and how many states were lost.

    The approach comes from ``far`` to a gap of ``near`` and a pressure of ``highest``; alone, it may hold states that
    are not converged. Where it ends early, nearer states are reached, if ``thorough``, by adhesion that grows at one
    mean gap, and from contact outward.
    """
    x, options = problem.gaps, problem.options
    pieces: list[Piece] = []

    def passed(state: Equilibrium) -> bool:
        return bool(state.gap <= near and -(state.weights @ problem.traction) >= highest)

    def solved(states: list[Equilibrium], tolerance: float = problem.tolerance) -> list[Equilibrium]:
        return [state for state in states if state.change <= tolerance]

    def keep(states: list[Equilibrium]) -> None:
        if len(states) >= options.fewest:
            pieces.append(tuple(states))

    first = min(int(np.searchsorted(x, far)), x.size - 2)
    approached, ended = _follow(problem, problem.solve(float(x[first]), problem.local()), -1, passed, options.lost)
    if not (ended and thorough):
        return (tuple(approached),), 0
    sound = solved(approached)
    keep(sound)
    lost = len(approached) - len(sound)
    last = sound[-1].gap if sound else float(x[first])
    for part in options.starts:
        node = max(int(np.searchsorted(x, x[0] + part * (last - x[0]))), 1)
        start = problem.grown(float(x[node]))
        if start.change > problem.tolerance:
            lost += 1
            continue
        above = last
        farther, _ = _follow(problem, start, 1, lambda state: state.gap >= above, 1)  # noqa: B023
        nearer, ended = _follow(problem, start, -1, passed, options.lost)
        both = [*reversed(solved(farther)[1:]), *solved(nearer)]
        both = [state for state in both if state.gap < above]
        lost += ended * options.lost
        keep(both)
        if len(both) >= options.fewest:
            last = both[-1].gap
        if not ended:
            break
    if ended:
        # From so deep in full contact that its curve has states enough. The law is stiff there, so that what responses
        # are off by has much energy.
        beyond = np.flatnonzero((x <= near) & (-problem.traction >= highest))
        deepest = x[0] + options.deepest * (x[beyond[-1]] - x[0]) if beyond.size else x[1]
        finer, longer = options.in_contact
        accurate = replace(problem, tolerance=finer * problem.tolerance, iterations=longer * problem.iterations)
        start = accurate.solve(float(x[max(int(np.searchsorted(x, deepest)), 1)]), problem.local())
        outward, _ = _follow(accurate, start, 1, lambda state: state.gap >= last, 1)
        keep([state for state in reversed(solved(outward, accurate.tolerance)) if state.gap < last])
    return (tuple(pieces), lost) if pieces else ((tuple(approached),), 0)


def _follow(
    problem: Problem, start: Equilibrium, way: int, passed: Callable[[Equilibrium], bool], patience: int
) -> tuple[list[Equilibrium], bool]:
    """States from one on towards contact (way −1) or away from it (1), and whether the last ones were lost.

    That is until two have passed or, in a row, as many as the patience were lost. States lie on nodes: between them
    the scatter of the mean gap has an energy that would be a ripple of the pressure.
    """
    x, options = problem.gaps, problem.options
    node = int(np.argmin(np.abs(x - start.gap)))
    found, sound = [start], [start]
    beyond = lost = 0
    while beyond < 2 and lost < patience and 1 < node + (way > 0) < x.size - 1:
        aim = int(np.searchsorted(x, x[0] + options.gap_ratio**-way * (x[node] - x[0])))
        step = abs(min(max(node + way * max(way * (aim - node), 1), 1), x.size - 2) - node)
        for halved in range(options.halvings + 1):
            gap = float(x[node + way * step])
            state = problem.solve(gap, problem.between(sound, gap))
            if state.change <= problem.tolerance or step == 1 or halved == options.halvings:
                break
            step //= 2
        node += way * step
        found.append(state)
        converged = state.change <= problem.tolerance
        sound, lost = ([sound[-1], state], 0) if converged else (sound, lost + 1)
        beyond += passed(state)
    return found, lost >= patience
