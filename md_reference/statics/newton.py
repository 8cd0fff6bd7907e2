"""Mechanical equilibrium at zero temperature: minimise ½ u·Su + E(u) + p a² Σu_z over the bottom layer of atoms.

Newton's method with inexact linear solves in single precision (:mod:`md_reference.statics.linear`). Attracted atoms
have negative curvature; what :mod:`md_reference.statics.step_limiter` leaves of it is faded by a factor 1 − fading when
a linear solve meets a descent of the whole quadratic model, and restored after successful steps. From the first touch
of a block that was apart it is faded out altogether until the residual is small: surfaces that come together snap in
everywhere at once, and the descent then follows a slow gradient flow.
"""

from dataclasses import dataclass

import numpy as np

from contact_study.numerics.balance import Excess
from contact_study.numerics.inner_product import inner_product
from md_reference.block.condensed import SurfaceStiffness
from md_reference.interface.pairs import AtomwiseInteraction
from md_reference.solution import Equilibrium, Outcome
from md_reference.statics.energy import Landscape, Load, MinimizerState

# Lengths in units of the interaction's length r0, stresses in units of the contact modulus.
_FALL = 0.9  # of a block out of reach, as a whole
_VANISHING_STEPS = 5  # as many in a row mean that the residual has reached its rounding
# Reduction of the residual that a linear solve is asked for: while curvature is faded, with all of it, at the end.
_FADED_REDUCTION = 0.3
_REDUCTION = 0.1
_SMALLEST_REDUCTION = 0.03  # single precision loses more than it gains below
_CLOSE = 1e-3  # residual below which a linear solve may take all the iterations it needs
_FEW_ITERATIONS, _MANY_ITERATIONS = 60, 300
# Fading of negative curvature: first value, growth on failure, decay on success.
_FADING_START, _FADING_GROWTH, _FADING_DECAY = 0.1, 3.0, 0.6
# Below this residual a state with negative curvature is left along that direction, by this step; above it surfaces that
# come together from separation are still coming.
_SADDLE_RESIDUAL, _ALONG_SADDLE = 0.2, 0.1
_SADDLE_ITERATIONS = 10  # of conjugate gradients that look for negative curvature at an equilibrium
_SADDLE_STEP = 0.03
_EXPANSION = 0.003  # of the residual: error allowed to forces of atoms that have moved little
_REFRESH = 20  # accepted steps after which S u is computed anew from u


@dataclass
class _Descent:
    """Where a solve stands, and what its steps may rely on."""

    place: MinimizerState
    approaching: bool  # surfaces come together from where nothing touched
    fading: float = 0.0
    iteration: int = 0

    def fade(self) -> None:
        """Take away more of the negative curvature."""
        self.fading = min(1.0, max(_FADING_GROWTH * self.fading, _FADING_START))

    def restore(self) -> None:
        """Take away less of it."""
        self.fading = self.fading * _FADING_DECAY if self.fading > 0.9 * _FADING_START else 0.0


class EquilibriumSolver:
    """Minimiser for one block and one interface.

    Parameters
    ----------
    stiffness : SurfaceStiffness
        The condensed block.
    interaction : AtomwiseInteraction
        The interface.
    contact_modulus : float
        E*, the scale of the residual (Pa).
    control : str
        "pressure", or "gap": the mean of the normal component keeps its starting value.
    tolerance : float
        On the residual, in units of E*.
    max_iterations : int
        Newton steps before giving up.
    threads : int, optional
        Threads of FFTW.

    Attributes
    ----------
    landscape : Landscape
        What is minimised.
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
    ):
        self.interaction = interaction
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self._fixed_mean = control == "gap"
        self.landscape = Landscape(stiffness, interaction, contact_modulus, self._fixed_mean, threads)

    def solve(self, start: np.ndarray, pressure: float = 0.0) -> Equilibrium:
        """Equilibrium reached from a starting state.

        Parameters
        ----------
        start : numpy.ndarray, shape (3, ny, nx)
            Starting displacement (m).
        pressure : float, optional
            Mean pressure, positive in compression (Pa); without meaning under gap control.

        Raises
        ------
        ValueError
            If an atom of the starting state lies inside the substrate or is not finite.
        """
        landscape = self.landscape
        transforms = landscape.pairs
        load = Load(0.0 if self._fixed_mean else pressure * landscape.area)
        place = landscape.place(start)
        at = _Descent(place, approaching=not np.any(landscape.force[2] > 0))
        while True:
            gradient = landscape.gradient(place, load)
            residual = landscape.residual(gradient)
            excess = landscape.excess(place, gradient, load, self.tolerance)
            outcome = self._outcome(at, excess, pressure)
            if outcome is Outcome.CONVERGED and leave_saddle(landscape, place):
                at.iteration += 1  # there may be one saddle after the other
                continue
            if outcome is not None:
                break
            if excess.balanced:
                landscape.refresh(place)
                continue
            at.iteration += 1
            self._advance(at, gradient, residual, load, excess.load > excess.residual and residual < _CLOSE)
        if not place.fresh:
            landscape.refresh(place)
            residual = landscape.residual(landscape.gradient(place, load))
        return equilibrium_of(landscape, place, residual, outcome, at.iteration, landscape.pairs - transforms)

    def _outcome(self, at: _Descent, excess: Excess, pressure: float) -> Outcome | None:
        """How the solve has ended, None while it goes on."""
        if not self._fixed_mean and pressure <= 0 and not self.landscape.force.any():
            return Outcome.DETACHED
        if at.iteration > self.max_iterations:  # by leaving a saddle
            return Outcome.ITERATION_LIMIT
        if excess.balanced:
            return Outcome.CONVERGED if at.place.fresh else None
        if at.iteration >= self.max_iterations:
            return Outcome.ITERATION_LIMIT
        return Outcome.STALLED if at.place.vanishing >= _VANISHING_STEPS else None

    def _newton_step(self, at: _Descent, gradient: np.ndarray, residual: float, light: bool) -> tuple[np.ndarray, bool]:
        """A step by the linear model of the energy, and whether more negative curvature had to be faded for it.

        Where the load is light what is missing of it is reduced as well as the residual.
        """
        landscape = self.landscape
        if at.approaching:
            coming = not self._fixed_mean and not np.any(landscape.force[2] > 0)
            if coming or residual > _SADDLE_RESIDUAL:
                at.fading = 1.0
        raised = False
        while True:
            landscape.set_curvature(at.place, gradient, at.fading)
            # The forcing term falls with the residual (in units of E*/100) for fast final convergence.
            full = max(_SMALLEST_REDUCTION, min(_REDUCTION, (100 * residual) ** 0.5))
            iterations = _FEW_ITERATIONS if residual > _CLOSE else _MANY_ITERATIONS
            reduction = _FADED_REDUCTION if at.fading > 0 else full
            total = reduction * abs(float(np.sum(gradient[2]))) if light else np.inf
            newton = landscape.newton.solve(gradient, reduction, iterations, total)
            if not newton.indefinite:
                return newton.step, raised
            if at.fading == 1:
                # Nothing is indefinite: where the first direction has no curvature, next to nothing acts yet.
                falls = newton.iterations == 1 and not self._fixed_mean
                return self._fall(gradient) if falls else newton.step, raised
            if at.fading == 0 and not raised and residual < _SADDLE_RESIDUAL:
                return newton.step + self._downhill(gradient), raised
            at.fade()
            raised = True

    def _fall(self, gradient: np.ndarray) -> np.ndarray:
        """A block out of reach of the substrate moves as a whole."""
        step = np.zeros_like(gradient)
        step[2] = -np.sign(np.sum(gradient[2])) * _FALL * self.interaction.length
        return step

    def _downhill(self, gradient: np.ndarray) -> np.ndarray:
        """A step along the last direction of the linear solver, which has negative curvature."""
        direction = self.landscape.newton.direction
        sign = -1.0 if inner_product(gradient, direction) >= 0 else 1.0
        return sign * _ALONG_SADDLE * self.interaction.length / np.abs(direction).max() * direction

    def _advance(self, at: _Descent, gradient: np.ndarray, residual: float, load: Load, light: bool) -> None:
        """Take a step as far as the energy follows it, and adapt what the next one may rely on."""
        step, raised = self._newton_step(at, gradient, residual, light)
        fraction = self.landscape.search(at.place, step, load, _EXPANSION * residual * self.landscape.force_scale)
        if fraction < 1:
            at.fade()
        elif not raised:
            at.restore()
        if at.iteration % _REFRESH == 0:
            self.landscape.stretch_anew(at.place)


def leave_saddle(landscape: Landscape, place: MinimizerState) -> bool:
    """Move to lower energy where an equilibrium has a direction of negative curvature; whether it had."""
    landscape.set_curvature(place, np.zeros_like(landscape.force), 0.0)
    direction = landscape.newton.unstable_direction(_SADDLE_ITERATIONS)
    if direction is None:
        return False
    return landscape.step_downhill(place, direction, _SADDLE_STEP * landscape.interaction.length)


def equilibrium_of(
    landscape: Landscape, place: MinimizerState, residual: float, outcome: Outcome, iterations: int, pairs: float
) -> Equilibrium:
    """A place of the landscape, where it was last evaluated, as a result."""
    return Equilibrium(
        displacement=place.displacement,
        force=landscape.force.copy(),
        residual=residual,
        outcome=outcome,
        iterations=iterations,
        evaluations=round(place.evaluations),
        fft_pairs=pairs,
        elastic_energy=0.5 * float(np.sum(place.displacement * place.stretch)),
        interaction_energy=place.energy,
    )
