"""Mechanical equilibrium at zero temperature: minimise ½ u·Su + E(u) + p a² Σu_z over the bottom layer of atoms.

Newton's method with inexact linear solves in single precision (:mod:`md_reference.statics.linear`). Attracted atoms
have negative curvature; what :mod:`md_reference.statics.atomwise` leaves of it is reduced by a factor 1 − damping when
a linear solve meets a descent of the whole quadratic model, and restored after successful steps. It is removed
altogether while surfaces approach: they jump into contact everywhere at once, in a slow gradient flow.
"""

import numpy as np

from contact_study.numerics import life
from contact_study.numerics.kernel import inner_product
from md_reference.solution import Outcome, Solution
from md_reference.statics.energy import BlockEnergy, Load, MinimizerState

# Residuals in units of a² E*, lengths in units of r0.
_FALL = 0.9  # step of a whole block out of reach
_VANISHING_STEPS = 5  # so many in a row: the residual has reached its rounding
# Reduction of the residual in a linear solve: with damped curvature, with all of it, at the end (single precision).
_DAMPED_REDUCTION, _REDUCTION, _SMALLEST_REDUCTION = 0.3, 0.1, 0.03
# Iterations of a linear solve, and of one below the residual "close".
_FEW_ITERATIONS, _MANY_ITERATIONS, _CLOSE = 60, 300, 1e-3
# Damping of negative curvature: first value, growth on failure, decay on success.
_DAMPING_START, _DAMPING_GROWTH, _DAMPING_DECAY = 0.1, 3.0, 0.6
# Below this residual a state with negative curvature is left along that direction, by this step; above it approaching
# surfaces are still in motion.
_SADDLE_RESIDUAL, _SADDLE_STEP = 0.2, 0.1
_EXPANSION = 0.003  # error of forces on atoms that moved little, over the residual
_REFRESH = 20  # steps after which S u is computed from u


def solve(energy: BlockEnergy, start: np.ndarray, pressure: float, tolerance: float, max_iterations: int) -> Solution:
    """Find the equilibrium reached from a starting displacement (m) under a mean pressure (Pa).

    The pressure is not used where the mean of the normal component is kept; ``tolerance`` is in units of E*. ValueError
    if an atom of the start lies inside the substrate or is not finite.
    """
    transforms = energy.pairs
    load = Load(0.0 if energy.fixed_mean else pressure * energy.area)
    at = energy.evaluate(start)
    at.approaching = not np.any(energy.force[2] > 0)
    while True:
        gradient = energy.gradient(at, load)
        residual = energy.residual(gradient)
        excess = energy.excess(at, gradient, load, tolerance)
        outcome = None
        if not energy.fixed_mean and pressure <= 0 and not energy.force.any():
            outcome = Outcome.DETACHED
        elif at.iteration > max_iterations:  # by leaving a saddle
            outcome = Outcome.ITERATION_LIMIT
        elif excess.balanced:
            outcome = Outcome.CONVERGED if at.fresh else None
        elif at.iteration >= max_iterations:
            outcome = Outcome.ITERATION_LIMIT
        elif at.vanishing >= _VANISHING_STEPS:
            outcome = Outcome.STALLED
        if outcome is Outcome.CONVERGED and energy.leave_saddle(at):
            at.iteration += 1  # one saddle may follow another
            continue
        if outcome is not None:
            break
        if excess.balanced:
            energy.refresh(at)
            continue
        at.iteration += 1
        life.beat(residual)
        light = excess.load > excess.residual and residual < _CLOSE
        step, raised = _newton_step(energy, at, gradient, residual, light)
        if energy.search(at, step, load, _EXPANSION * residual * energy.force_scale) < 1:
            _raise_damping(at)
        elif not raised:
            at.damping = at.damping * _DAMPING_DECAY if at.damping > 0.9 * _DAMPING_START else 0.0
        if at.iteration % _REFRESH == 0:
            at.stretch = energy.apply_stiffness(at.displacement).copy()
    if not at.fresh:
        energy.refresh(at)
        residual = energy.residual(energy.gradient(at, load))
    return energy.equilibrium(at, residual, outcome, at.iteration, energy.pairs - transforms)


def _newton_step(
    energy: BlockEnergy, at: MinimizerState, gradient: np.ndarray, residual: float, light: bool
) -> tuple[np.ndarray, bool]:
    """Return a step that reduces the residual, and a ``light`` load's rest, and whether it needed more damping."""
    length = energy.interaction.length
    if at.approaching:
        out_of_reach = not energy.fixed_mean and not np.any(energy.force[2] > 0)
        if out_of_reach or residual > _SADDLE_RESIDUAL:
            at.damping = 1.0
    raised = False
    while True:
        energy.set_curvature(at, gradient, at.damping)
        # The forcing term falls with the residual (in units of E*/100) for fast final convergence.
        full = max(_SMALLEST_REDUCTION, min(_REDUCTION, (100 * residual) ** 0.5))
        reduction = _DAMPED_REDUCTION if at.damping > 0 else full
        total = reduction * abs(float(np.sum(gradient[2]))) if light else np.inf
        iterations = _FEW_ITERATIONS if residual > _CLOSE else _MANY_ITERATIONS
        newton = energy.newton.solve(gradient, reduction, iterations, total)
        step = newton.step
        if newton.indefinite and at.damping == 1 and newton.iterations == 1 and not energy.fixed_mean:
            # Nothing is indefinite: the first direction has no curvature, forces nearly vanish, and the block moves out
            # of reach of the substrate as a whole.
            step = np.zeros_like(gradient)
            step[2] = -np.sign(np.sum(gradient[2])) * _FALL * length
        if not newton.indefinite or at.damping == 1:
            return step, raised
        if at.damping == 0 and not raised and residual < _SADDLE_RESIDUAL:
            # The last direction of the linear solver has negative curvature.
            direction = energy.newton.direction
            sign = -1.0 if inner_product(gradient, direction) >= 0 else 1.0
            return step + sign * _SADDLE_STEP * length / np.abs(direction).max() * direction, raised
        _raise_damping(at)
        raised = True


def _raise_damping(at: MinimizerState) -> None:
    at.damping = min(1.0, max(_DAMPING_GROWTH * at.damping, _DAMPING_START))
