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
    """Constants of the iteration.

    Attributes
    ----------
    tolerance : float
        Largest change of σ_a over the stress scale at the end, four digits below the error of the nodes.
    max_iterations : int
        Largest number of diffusions.
    accelerated, memory : int
        Diffusions after which the acceleration is given up, and states that it uses. With more states it fails near
        the sticking threshold.
    relaxation : float
        Largest share of the change that the damped iteration takes.
    patience : int
        Diffusions in which the smallest change of the damped iteration has to halve.
    """

    tolerance: float = 1e-7
    max_iterations: int = 400
    accelerated: int = 40
    memory: int = 3
    relaxation: float = 0.8
    patience: int = 200


@dataclass(frozen=True)
class FixedPoint:
    """The last σ_a (Pa), its distribution, its change over the stress scale, diffusions, and whether progress ended."""

    stress: np.ndarray
    distribution: StressDistribution
    change: float
    iterations: int
    stalled: bool = False


Response = Callable[[np.ndarray], tuple[StressDistribution, np.ndarray]]


def iterate(
    respond: Response,
    root: Callable[[np.ndarray], np.ndarray],
    stress: np.ndarray,
    scale: float,
    one_state: bool,
    options: IterationOptions,
) -> FixedPoint:
    """Find the σ_a that the distribution under it asks for.

    Parameters
    ----------
    respond : callable
        The distribution under a σ_a (Pa), and the square of σ_a that follows from it (Pa²).
    root : callable
        σ_a from its square, which may be negative.
    stress : numpy.ndarray
        First σ_a at the magnifications (Pa).
    scale : float
        Stress scale (Pa).
    one_state : bool
        Whether there is one state only, so that any way to it will do.
    options : IterationOptions
        Constants.

    Raises
    ------
    FloatingPointError
        If an iterate is not finite.
    """
    spent = 0
    if one_state:
        found = _accelerate(respond, root, stress, scale, options)
        if found.change <= options.tolerance or found.iterations >= options.max_iterations:
            return found
        stress, spent = found.stress, found.iterations
    return _damp(respond, root, stress, scale, spent, options)


def _accelerate(
    respond: Response,
    root: Callable[[np.ndarray], np.ndarray],
    stress: np.ndarray,
    scale: float,
    options: IterationOptions,
) -> FixedPoint:
    """Anderson's acceleration of σ_a², which is smooth, continued below zero, where σ_a is not."""
    used = stress
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

    limit = min(options.max_iterations, options.accelerated)
    bounds = (-np.inf, np.inf)
    start = (stress / scale) ** 2
    _, change, count = accelerated(update, start, bounds, options.tolerance, limit, mixing=1.0, memory=options.memory)
    return FixedPoint(used, distribution, change, count)


def _damp(
    respond: Response,
    root: Callable[[np.ndarray], np.ndarray],
    stress: np.ndarray,
    scale: float,
    spent: int,
    options: IterationOptions,
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
