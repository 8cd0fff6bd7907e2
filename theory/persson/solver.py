"""The state of contact at one pressure: A(q) and σ_a(q), which depend on each other at all magnifications.

A diffusion turns σ_a(q) into A(q), from which γ_eff(q) and σ_a(q) follow. Under compression the state is one, and
Anderson's acceleration finds it; where γ_eff passes through zero at some magnification it may fail, and at zero
pressure and under tension, where detachment is another solution, it would change branches. There, a damped iteration of
σ_a follows the branch of its start.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contact_study.numerics.arguments import finite
from theory.numerics.fixed_point import accelerated
from theory.persson.contact import PerssonContact
from theory.persson.diffusion import StressDistribution, diffuse

if TYPE_CHECKING:
    from theory.persson.theory import PerssonTheory

# Largest change of σ_a over the stress scale at which the iteration ends: four digits below the error of the nodes.
TOLERANCE = 1e-7
MAX_ITERATIONS = 400

# Diffusions after which the accelerated iteration is given up, and states that it remembers: with more of them it is
# lost near the sticking threshold.
_ACCELERATED, _REMEMBERED = 40, 3

# Iterations in which the smallest change of the damped iteration so far must halve: at a slower pace a state takes over
# four thousand. States near the sticking threshold with an α several times the paper's circle without end.
_PATIENCE = 200


def solve(
    theory: "PerssonTheory",
    pressure: float,
    start: np.ndarray | str = "adhered",
    tolerance: float = TOLERANCE,
    max_iterations: int = MAX_ITERATIONS,
) -> PerssonContact:
    """Contact at one pressure, on the branch that ``start`` leads to.

    Parameters
    ----------
    theory : PerssonTheory
        Interface and choices.
    pressure : float
        p, compression positive (Pa).
    start : numpy.ndarray or str, optional
        First σ_a at the magnifications (Pa), such as that of a neighbouring pressure; or ``"adhered"``, σ_a of
        conformal contact √(2α K Δγ); or ``"detached"``, zero. They differ where both states are stable.
    tolerance : float, optional
        Largest change of σ_a over the stress scale at which the iteration ends.
    max_iterations : int, optional
        Diffusions after which it ends unconverged; it does so earlier where the change no longer falls.

    Raises
    ------
    ValueError
        If the pressure is not finite.
    FloatingPointError
        If the contact area or the detachment stress is not a finite number.
    """
    finite("pressure", pressure, "Pa")
    stress = _first_detachment_stress(theory, start)
    if theory.work_of_adhesion == 0:
        distribution = _diffused(theory, pressure, np.zeros_like(stress))
        contact = PerssonContact(theory, pressure, stress, distribution, True, False, 0.0, 1)
    else:
        contact = _iterated(theory, pressure, stress, tolerance, max_iterations)
    return contact if contact.balanced else replace(contact, converged=False)


def _iterated(
    theory: "PerssonTheory", pressure: float, stress: np.ndarray, tolerance: float, max_iterations: int
) -> PerssonContact:
    spent = 0
    if pressure > 0:
        contact = _accelerated(theory, pressure, stress, tolerance, min(max_iterations, _ACCELERATED))
        if contact.converged or contact.iterations >= max_iterations:
            return contact
        spent = contact.iterations
    return _damped(theory, pressure, stress, tolerance, max_iterations, spent)


def _first_detachment_stress(theory: "PerssonTheory", start: np.ndarray | str) -> np.ndarray:
    if isinstance(start, np.ndarray):
        return start.copy()
    if start == "adhered":
        return theory.detachment_stress(np.full(theory.nodes + 1, theory.work_of_adhesion))
    if start == "detached":
        return np.zeros(theory.nodes + 1)
    raise ValueError(f"start = {start!r}: expected an array, 'adhered' or 'detached'")


def _diffused(theory: "PerssonTheory", pressure: float, stress: np.ndarray) -> StressDistribution:
    scale = theory.stress_scale
    return diffuse(pressure / scale, theory.stress_variance / scale**2, stress / scale, theory.cells)


def _accelerated(
    theory: "PerssonTheory", pressure: float, stress: np.ndarray, tolerance: float, iterations: int
) -> PerssonContact:
    """Anderson's acceleration of σ_a², which is smooth where σ_a, its root, is not, and goes on below zero."""
    scale, used = theory.stress_scale, stress
    distribution: StressDistribution

    def update(square: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        nonlocal used, distribution
        used = theory.stress_of_square(scale**2 * square)
        distribution = _diffused(theory, pressure, used)
        found = theory.stress_square(theory.effective_work_of_adhesion(distribution.contact)) / scale**2
        change = float(np.max(np.abs(theory.stress_of_square(scale**2 * found) - used))) / scale
        # What has no detachment stress, before and after, acts on nothing.
        weight = ((square > 0) | (found > 0)).astype(float)
        return found - square, weight, change

    everything = (-np.inf, np.inf)
    _, change, count = accelerated(
        update, (stress / scale) ** 2, everything, tolerance, iterations, mixing=1.0, memory=_REMEMBERED
    )
    return PerssonContact(theory, pressure, used, distribution, change <= tolerance, False, change, count)


def _damped(
    theory: "PerssonTheory", pressure: float, stress: np.ndarray, tolerance: float, max_iterations: int, spent: int
) -> PerssonContact:
    """Iterate σ_a with a relaxation of 0.8, less at magnifications where the change alternates.

    Where γ_eff passes through zero σ_a, its square root, answers without bound: a node there must be damped more than
    the others, and each by what it needs.
    """
    relaxation, previous = np.full(stress.size, 0.8), np.zeros(stress.size)
    iterations = since = spent
    best = np.inf
    while True:
        distribution = _diffused(theory, pressure, stress)
        target = theory.detachment_stress(theory.effective_work_of_adhesion(distribution.contact))
        iterations += 1
        difference = target - stress
        change = float(np.max(np.abs(difference))) / theory.stress_scale
        if not np.isfinite(change):
            raise FloatingPointError(f"p = {pressure:g} Pa: σ_a is not finite after {iterations - spent} diffusions")
        if change < 0.5 * best:
            best, since = change, iterations
        converged = change <= tolerance
        stalled = not converged and iterations - since == _PATIENCE
        if converged or stalled or iterations >= max_iterations:
            return PerssonContact(theory, pressure, stress, distribution, converged, stalled, change, iterations)
        alternates = difference * previous < 0
        relaxation = np.where(alternates, 0.7 * relaxation, np.minimum(1.1 * relaxation, 0.8))
        stress, previous = stress + relaxation * difference, difference
