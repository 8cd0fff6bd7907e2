"""The fixed point of the detachment stress σ_a(q): an accelerated iteration, and a damped one that keeps its branch.

Under compression there is one state, and Anderson's acceleration finds it. It may fail where γ_eff passes through zero
at some magnification. At zero pressure and under tension a detached state exists as well, and the acceleration would
change branches. The damped iteration then follows the branch of its start.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from theory.numerics.fixed_point import accelerated
from theory.persson.diffusion import StressDistribution


@dataclass(frozen=True)
class IterationOptions:
    """Constants of the iteration."""

    tolerance: float = 1e-7  # largest change of σ_a over the stress scale, four digits below the error of the nodes
    max_iterations: int = 400  # diffusions at most
    accelerated: int = 40  # diffusions after which the acceleration is given up
    memory: int = 3  # states that it uses; with more it fails near the sticking threshold
    relaxation: float = 0.8  # largest share of the change that the damped iteration takes
    patience: int = 200  # diffusions in which the smallest change of the damped iteration has to halve


@dataclass(frozen=True)
class FixedPoint:
    """The last σ_a (Pa), its distribution, its change over the stress scale, diffusions, and whether progress ended."""

    stress: np.ndarray
    distribution: StressDistribution
    change: float
    iterations: int
    stalled: bool = False


Response = Callable[[np.ndarray], tuple[StressDistribution, np.ndarray]]
Root = Callable[[np.ndarray], np.ndarray]


def iterate(
    respond: Response, root: Root, stress: np.ndarray, scale: float, one_state: bool, options: IterationOptions
) -> FixedPoint:
    """The σ_a that the distribution under it asks for; FloatingPointError if an iterate is not finite.

    ``respond`` gives the distribution under a σ_a (Pa) and the square of the σ_a that follows from it (Pa²), which may
    be negative; ``root`` makes σ_a of that. Where there is ``one_state`` only, any way to it will do.
    """
    used, spent = stress, 0
    distribution: StressDistribution

    def update(square: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        nonlocal used, distribution
        used = root(scale**2 * square)
        distribution, found = respond(used)
        found = found / scale**2
        change = float(np.max(np.abs(root(scale**2 * found) - used))) / scale
        # A magnification without detachment stress, before and after, has no effect.
        weight = ((square > 0) | (found > 0)).astype(float)
        return found - square, weight, change

    if one_state:
        # σ_a² is smooth, continued below zero, where σ_a is not.
        limit = min(options.max_iterations, options.accelerated)
        start, bounds = (stress / scale) ** 2, (-np.inf, np.inf)
        _, change, spent = accelerated(update, start, bounds, options.tolerance, limit, 1.0, options.memory)
        if change <= options.tolerance or spent >= options.max_iterations:
            return FixedPoint(used, distribution, change, spent)
    return _damp(respond, root, used, scale, spent, options)


def _damp(
    respond: Response, root: Root, stress: np.ndarray, scale: float, spent: int, options: IterationOptions
) -> FixedPoint:
    """Iterate σ_a with less relaxation at magnifications where the change alternates.

    σ_a is the root of γ_eff, whose slope has no bound where γ_eff passes through zero: each node needs its own damping.
    """
    relaxation, previous = np.full(stress.size, options.relaxation), np.zeros(stress.size)
    iterations = since = spent
    best = np.inf
    while True:
        distribution, square = respond(stress)
        iterations += 1
        difference = root(square) - stress
        change = float(np.max(np.abs(difference))) / scale
        if not np.isfinite(change):
            raise FloatingPointError(f"σ_a is not finite after {iterations - spent} diffusions")
        if change < 0.5 * best:
            best, since = change, iterations
        converged = change <= options.tolerance
        stalled = not converged and iterations - since == options.patience
        if converged or stalled or iterations >= options.max_iterations:
            return FixedPoint(stress, distribution, change, iterations, stalled)
        alternates = difference * previous < 0
        relaxation = np.where(alternates, 0.7 * relaxation, np.minimum(1.1 * relaxation, options.relaxation))
        stress, previous = stress + relaxation * difference, difference
