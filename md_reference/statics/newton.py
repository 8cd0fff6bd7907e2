"""Mechanical equilibrium at zero temperature: minimise ½ u·Su + E(u) + p a² Σu_z over the bottom layer of atoms.

Newton's method with inexact linear solves in single precision (:mod:`md_reference.statics.linear`). Attracted atoms
have negative curvature; what :mod:`md_reference.statics.curvature` leaves of it is reduced by a factor 1 − damping when
a linear solve meets a descent of the whole quadratic model, and restored after successful steps. From the first contact
of a separated block it is removed altogether until the residual is small: approaching surfaces jump into contact
everywhere at once, and the descent then follows a slow gradient flow.
"""

from dataclasses import dataclass

import numpy as np

from contact_study.numerics.balance import Excess
from contact_study.numerics.inner_product import inner_product
from md_reference.block.condensed import SurfaceStiffness
from md_reference.interface.pairs import AtomwiseInteraction
from md_reference.solution import Equilibrium, Outcome
from md_reference.statics import energy
from md_reference.statics.energy import BlockEnergy, EnergyOptions, Load, MinimizerState


@dataclass(frozen=True)
class NewtonOptions:
    """Newton's method; lengths in units of r0, residuals in units of a² E*."""

    fall: float = 0.9  # step of a whole block out of reach
    vanishing_steps: int = 5  # so many in a row: the residual has reached its rounding
    # Reduction of the residual in a linear solve: with damped curvature, with all of it, at the end (single precision
    # loses more than it gains below).
    damped_reduction: float = 0.3
    reduction: float = 0.1
    smallest_reduction: float = 0.03
    close: float = 1e-3  # residual below which a linear solve may take many iterations
    few_iterations: int = 60
    many_iterations: int = 300
    # Damping of negative curvature: first value, growth on failure, decay on success.
    damping_start: float = 0.1
    damping_growth: float = 3.0
    damping_decay: float = 0.6
    # Below this residual a state with negative curvature is left along that direction, by this step; above it
    # approaching surfaces are still in motion.
    saddle_residual: float = 0.2
    saddle_step: float = 0.1
    # At an equilibrium: conjugate-gradient iterations that search for negative curvature, and first step along it.
    test_iterations: int = 10
    test_step: float = 0.03
    expansion: float = 0.003  # error of forces on atoms that moved little, over the residual
    refresh: int = 20  # steps after which S u is computed from u
    energy: EnergyOptions = energy.DEFAULTS


DEFAULTS = NewtonOptions()


@dataclass
class _Descent:
    """Progress of a solve; ``approaching`` surfaces had no contact at the start."""

    state: MinimizerState
    approaching: bool
    damping: float = 0.0
    iteration: int = 0


class EquilibriumSolver:
    """Minimiser for one block and one interface.

    ``contact_modulus`` is E*, the scale of the residual (Pa). Under control of the "gap" the mean of the normal
    component keeps its starting value. A solve ends at a residual of ``tolerance``, in units of E*, or after
    ``max_iterations`` Newton steps.
    """

    def __init__(
        self,
        stiffness: SurfaceStiffness,
        interaction: AtomwiseInteraction,
        contact_modulus: float,
        control: str = "pressure",
        tolerance: float = 1e-8,
        max_iterations: int = 2000,
        threads: int = 1,
        options: NewtonOptions = DEFAULTS,
    ):
        self.interaction = interaction
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self.options = options
        self._fixed_mean = control == "gap"
        self.energy = BlockEnergy(stiffness, interaction, contact_modulus, self._fixed_mean, threads, options.energy)

    def solve(self, start: np.ndarray, pressure: float = 0.0) -> Equilibrium:
        """Find the equilibrium reached from a starting displacement (m, shape (3, ny, nx)).

        ``pressure`` is the mean pressure (Pa), not used under gap control. ValueError if an atom of the starting state
        lies inside the substrate or is not finite.
        """
        energy = self.energy
        transforms = energy.pairs
        load = Load(0.0 if self._fixed_mean else pressure * energy.area)
        state = energy.evaluate(start)
        at = _Descent(state, approaching=not np.any(energy.force[2] > 0))
        while True:
            gradient = energy.gradient(state, load)
            residual = energy.residual(gradient)
            excess = energy.excess(state, gradient, load, self.tolerance)
            outcome = self._outcome(at, excess, pressure)
            if outcome is Outcome.CONVERGED and leave_saddle(energy, state, self.options):
                at.iteration += 1  # one saddle may follow another
                continue
            if outcome is not None:
                break
            if excess.balanced:
                energy.refresh(state)
                continue
            at.iteration += 1
            light = excess.load > excess.residual and residual < self.options.close
            self._advance(at, gradient, residual, load, light)
        if not state.fresh:
            energy.refresh(state)
            residual = energy.residual(energy.gradient(state, load))
        return energy.equilibrium(state, residual, outcome, at.iteration, energy.pairs - transforms)

    def _outcome(self, at: _Descent, excess: Excess, pressure: float) -> Outcome | None:
        """Return how the solve has ended, None while it continues."""
        if not self._fixed_mean and pressure <= 0 and not self.energy.force.any():
            return Outcome.DETACHED
        if at.iteration > self.max_iterations:  # by leaving a saddle
            return Outcome.ITERATION_LIMIT
        if excess.balanced:
            return Outcome.CONVERGED if at.state.fresh else None
        if at.iteration >= self.max_iterations:
            return Outcome.ITERATION_LIMIT
        return Outcome.STALLED if at.state.vanishing >= self.options.vanishing_steps else None

    def _newton_step(self, at: _Descent, gradient: np.ndarray, residual: float, light: bool) -> tuple[np.ndarray, bool]:
        """Return a step by the linear model of the energy, and whether it needed more damping.

        Under a ``light`` load the missing load is reduced as well as the residual.
        """
        energy, options = self.energy, self.options
        if at.approaching:
            out_of_reach = not self._fixed_mean and not np.any(energy.force[2] > 0)
            if out_of_reach or residual > options.saddle_residual:
                at.damping = 1.0
        raised = False
        while True:
            energy.set_curvature(at.state, gradient, at.damping)
            # The forcing term falls with the residual (in units of E*/100) for fast final convergence.
            full = max(options.smallest_reduction, min(options.reduction, (100 * residual) ** 0.5))
            iterations = options.few_iterations if residual > options.close else options.many_iterations
            reduction = options.damped_reduction if at.damping > 0 else full
            total = reduction * abs(float(np.sum(gradient[2]))) if light else np.inf
            newton = energy.newton.solve(gradient, reduction, iterations, total)
            if not newton.indefinite:
                return newton.step, raised
            if at.damping == 1:
                # Nothing is indefinite: if the first direction has no curvature, forces nearly vanish.
                falls = newton.iterations == 1 and not self._fixed_mean
                return self._fall(gradient) if falls else newton.step, raised
            if at.damping == 0 and not raised and residual < options.saddle_residual:
                return newton.step + self._downhill(gradient), raised
            self._raise_damping(at)
            raised = True

    def _raise_damping(self, at: _Descent) -> None:
        """Remove more of the negative curvature."""
        at.damping = min(1.0, max(self.options.damping_growth * at.damping, self.options.damping_start))

    def _fall(self, gradient: np.ndarray) -> np.ndarray:
        """Return a step that moves a block out of reach of the substrate as a whole."""
        step = np.zeros_like(gradient)
        step[2] = -np.sign(np.sum(gradient[2])) * self.options.fall * self.interaction.length
        return step

    def _downhill(self, gradient: np.ndarray) -> np.ndarray:
        """Return a step along the last direction of the linear solver, which has negative curvature."""
        direction = self.energy.newton.direction
        sign = -1.0 if inner_product(gradient, direction) >= 0 else 1.0
        return sign * self.options.saddle_step * self.interaction.length / np.abs(direction).max() * direction

    def _advance(self, at: _Descent, gradient: np.ndarray, residual: float, load: Load, light: bool) -> None:
        """Take a step as far as the energy falls, and adapt the damping."""
        options = self.options
        step, raised = self._newton_step(at, gradient, residual, light)
        error = options.expansion * residual * self.energy.force_scale
        fraction = self.energy.search(at.state, step, load, error)
        if fraction < 1:
            self._raise_damping(at)
        elif not raised:
            at.damping = at.damping * options.damping_decay if at.damping > 0.9 * options.damping_start else 0.0
        if at.iteration % options.refresh == 0:
            self.energy.refresh_stretch(at.state)


def leave_saddle(energy: BlockEnergy, state: MinimizerState, options: NewtonOptions = DEFAULTS) -> bool:
    """Move an equilibrium to lower energy along a direction of negative curvature; return whether it has any."""
    energy.set_curvature(state, np.zeros_like(energy.force), 0.0)
    direction = energy.newton.unstable_direction(options.test_iterations)
    if direction is None:
        return False
    return energy.step_downhill(state, direction, options.test_step * energy.interaction.length)
