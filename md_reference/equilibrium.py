"""Mechanical equilibrium at zero temperature: minimise ½ u·Su + E(u) + p a² Σu_z over the bottom layer of atoms.

Newton's method with inexact linear solves in single precision (:mod:`md_reference.newton_step`). Attracted atoms have
negative curvature; what :mod:`md_reference.snap_in` leaves of it is faded by a factor 1 − fading when a linear solve
meets a descent of the whole quadratic model, and restored after successful steps. From the first touch of a block that
was apart it is faded out altogether until the residual is small: surfaces that come together snap in everywhere at
once, and the descent then follows a slow gradient flow.
"""

from dataclasses import dataclass

import numpy as np

from contact_study.fields.fourier import RealTransform
from md_reference.block import SurfaceStiffness
from md_reference.interface import Interaction
from md_reference.newton_step import NewtonSolver
from md_reference.snap_in import land, raised_curvature
from md_reference.solution import Equilibrium, Outcome
from md_reference.stiffness_pass import multiply

# Lengths in units of the interaction's length r0, stresses in units of the contact modulus.
_LARGEST_STEP = 10.0
_LARGEST_SLIDE = 0.5  # of an atom along the surface in one step
_FALL = 0.9  # of a block out of reach, as a whole
_VANISHING_STEP = 1e-9
_VANISHING_STEPS = 5  # as many in a row mean that the residual has reached its rounding
# Stiffness c of the preconditioner, over √(strongest softening × stiffness of the surface's mean wave): the waves that
# soften with the interface. In units of force_prefactor/r0 the strongest softening is 25/44.
_SHIFT_FRACTION, _SOFTENING = 0.22, 25 / 44
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
_BACKTRACK, _SHORTEST_FRACTION = 0.4, 1e-4
_SADDLE_ITERATIONS = 10  # of conjugate gradients that look for negative curvature at an equilibrium
_SADDLE_STEP = 0.03
_REFRESH = 20  # accepted steps after which S u is computed anew from u


@dataclass
class _Iterate:
    """Where a solve stands: the state u, its interaction energy, S u, gaps and tilt, and what steps may rely on."""

    displacement: np.ndarray
    energy: float
    stretch: np.ndarray
    gap: np.ndarray
    cosine: np.ndarray
    approaching: bool  # surfaces come together from where nothing touched
    fresh: bool = True  # S u computed from u itself, not updated
    fading: float = 0.0
    vanishing: int = 0  # steps of no length in a row
    iteration: int = 0
    evaluations: int = 1

    def fade(self) -> None:
        """Take away more of the negative curvature."""
        self.fading = min(1.0, max(_FADING_GROWTH * self.fading, _FADING_START))

    def restore(self) -> None:
        """Take away less of it."""
        self.fading = self.fading * _FADING_DECAY if self.fading > 0.9 * _FADING_START else 0.0


class EquilibriumSolver:
    """Minimiser for one block and one interface, owner of all work arrays.

    Parameters
    ----------
    stiffness : SurfaceStiffness
        The condensed block.
    interaction : Interaction
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
    """

    def __init__(
        self,
        stiffness: SurfaceStiffness,
        interaction: Interaction,
        contact_modulus: float,
        control: str = "pressure",
        tolerance: float = 1e-8,
        max_iterations: int = 2000,
        threads: int = 1,
    ):
        self.interaction = interaction
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self._area = stiffness.area_per_atom
        self._force_scale = contact_modulus * self._area
        self._fixed_mean = control == "gap"
        shape = (3, *stiffness.grid.shape)
        softening = _SOFTENING * interaction.force_prefactor / interaction.length
        wave = 0.5 * self._force_scale * self._mean_wavenumber(stiffness)
        self._newton = NewtonSolver(stiffness, _SHIFT_FRACTION * (softening * wave) ** 0.5, self._fixed_mean, threads)
        self._transform = RealTransform(shape, np.float64, threads)
        self._coefficients = stiffness.coefficients / self._transform.points
        self._coefficients[2, 0, 0] = 0.0
        self._multiplicity = stiffness.grid.multiplicity[0]
        self._force = np.empty(shape)
        self._trial_force = np.empty(shape)
        self._hessian = np.empty((6, *shape[1:]))

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
        transforms = self._pairs()
        push = 0.0 if self._fixed_mean else pressure * self._area
        at = self._begin(start)
        while True:
            gradient = self._gradient(at.stretch, push)
            residual = float(np.max(np.abs(gradient))) / self._force_scale
            outcome = self._outcome(at, residual, pressure)
            if outcome is Outcome.CONVERGED and self._leave_saddle(at):
                at.iteration += 1  # there may be one saddle after the other
                continue
            if outcome is not None:
                break
            if residual <= self.tolerance:
                self._refresh(at)
                continue
            at.iteration += 1
            self._advance(at, gradient, residual, push)
        return Equilibrium(
            displacement=at.displacement,
            force=self._force.copy(),
            residual=residual,
            outcome=outcome,
            iterations=at.iteration,
            evaluations=at.evaluations,
            fft_pairs=self._pairs() - transforms,
            elastic_energy=0.5 * float(np.sum(at.displacement * at.stretch)),
            interaction_energy=at.energy,
        )

    def _begin(self, start: np.ndarray) -> _Iterate:
        """The starting state with its energy and forces."""
        u = start.copy()
        energy = self._evaluate(u)
        if not np.isfinite(energy):
            raise ValueError("the starting state has atoms inside the substrate (or not finite): start it higher")
        apart = not np.any(self._force[2] > 0)
        return _Iterate(u, energy, self._apply_stiffness(u).copy(), *self.interaction.gap_and_cosine(u), apart)

    def _outcome(self, at: _Iterate, residual: float, pressure: float) -> Outcome | None:
        """How the solve has ended, None while it goes on."""
        if not self._fixed_mean and pressure <= 0 and not self._force.any():
            return Outcome.DETACHED
        if at.iteration > self.max_iterations:  # by leaving a saddle
            return Outcome.ITERATION_LIMIT
        if residual <= self.tolerance:
            return Outcome.CONVERGED if at.fresh else None
        if at.iteration >= self.max_iterations:
            return Outcome.ITERATION_LIMIT
        return Outcome.STALLED if at.vanishing >= _VANISHING_STEPS else None

    def _leave_saddle(self, at: _Iterate) -> bool:
        """Move to lower energy where an equilibrium has a direction of negative curvature; whether it had."""
        self._set_curvature(at, np.zeros_like(self._force), 0.0)
        direction = self._newton.unstable_direction(_SADDLE_ITERATIONS)
        if direction is None:
            return False
        stretch = self._apply_stiffness(direction).copy()
        elastic_slope = float(np.sum(self._force * direction))  # in balance: what the interface holds
        elastic_curvature = float(np.sum(stretch * direction))
        length = _SADDLE_STEP * self.interaction.length
        while length > _VANISHING_STEP * self.interaction.length:
            for move in (length, -length):
                trial = at.displacement + move * direction
                energy = self._evaluate(trial)
                at.evaluations += 1
                if move * elastic_slope + 0.5 * move**2 * elastic_curvature + energy < at.energy:
                    at.displacement, at.energy, at.vanishing = trial, energy, 0
                    at.gap, at.cosine = self.interaction.gap_and_cosine(trial)
                    self._refresh(at)
                    return True
            length *= _BACKTRACK
        self._evaluate(at.displacement)
        return False

    def _newton_step(self, at: _Iterate, gradient: np.ndarray, residual: float) -> tuple[np.ndarray, bool]:
        """A step by the linear model of the energy, and whether more negative curvature had to be faded for it."""
        if at.approaching:
            coming = not self._fixed_mean and not np.any(self._force[2] > 0)
            if coming or residual > _SADDLE_RESIDUAL:
                at.fading = 1.0
        raised = False
        while True:
            self._set_curvature(at, gradient, at.fading)
            # The forcing term falls with the residual (in units of E*/100) for fast final convergence.
            full = max(_SMALLEST_REDUCTION, min(_REDUCTION, (100 * residual) ** 0.5))
            iterations = _FEW_ITERATIONS if residual > _CLOSE else _MANY_ITERATIONS
            newton = self._newton.solve(gradient, _FADED_REDUCTION if at.fading > 0 else full, iterations)
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
        direction = self._newton.direction
        sign = -1.0 if np.vdot(gradient, direction) >= 0 else 1.0
        return sign * _ALONG_SADDLE * self.interaction.length / np.abs(direction).max() * direction

    def _advance(self, at: _Iterate, gradient: np.ndarray, residual: float, push: float) -> None:
        """Take a step as far as the energy follows it, and adapt what the next one may rely on."""
        step, raised = self._newton_step(at, gradient, residual)
        # Where next to nothing acts, rounding is all that keeps a block from moving for ever.
        excess = float(np.max(np.abs(step))) / (_LARGEST_STEP * self.interaction.length)
        if excess > 1:
            step /= excess
        fraction = self._search(at, step, push)
        if fraction < 1:
            at.fade()
        elif not raised:
            at.restore()
        if at.iteration % _REFRESH == 0:
            self._refresh(at)

    def _search(self, at: _Iterate, step: np.ndarray, push: float) -> float:
        """Shorten the step until the energy falls, and move there; the fraction taken, zero if it never falls.

        The change of energy is summed from its parts, never a difference of two totals, which would round away.
        """
        noise = 1e-12 * abs(at.energy)  # rounding of the sum over pairs
        fraction = 1.0
        while fraction > _SHORTEST_FRACTION:
            trial, gap, cosine = self._trial(at, fraction * step)
            energy = self.interaction.evaluate(trial, self._trial_force, self._hessian)
            at.evaluations += 1
            if np.isfinite(energy):
                move = trial - at.displacement
                stretch = self._apply_stiffness(move)
                change = float(np.sum((at.stretch + 0.5 * stretch) * move)) + push * float(np.sum(move[2]))
                if change + energy - at.energy <= noise:
                    size = float(np.max(np.abs(move))) / self.interaction.length
                    at.vanishing = at.vanishing + 1 if size < _VANISHING_STEP else 0
                    at.displacement, at.energy, at.gap, at.cosine = trial, energy, gap, cosine
                    at.stretch += stretch
                    at.fresh = False
                    self._force, self._trial_force = self._trial_force, self._force
                    return fraction
            fraction *= _BACKTRACK
        at.vanishing += 1
        self._evaluate(at.displacement)
        return 0.0

    def _trial(self, at: _Iterate, step: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Displacement, gap and cosine of the tilt after a step in which every atom lands softly."""
        length = self.interaction.length
        trial = at.displacement + step
        slide = _LARGEST_SLIDE * length
        trial[:2] = at.displacement[:2] + np.clip(step[:2], -slide, slide)
        gap, cosine = self.interaction.gap_and_cosine(trial)
        land(at.gap, at.cosine, self._force[2], length, self.interaction.force_prefactor, gap, cosine, trial[2])
        if self._fixed_mean:
            shift = np.mean(at.displacement[2]) - np.mean(trial[2])
            trial[2] += shift
            gap += shift
        return trial, gap, cosine

    def _refresh(self, at: _Iterate) -> None:
        """Compute S u anew, free of the rounding of its updates."""
        at.stretch = self._apply_stiffness(at.displacement).copy()
        at.fresh = True

    def _evaluate(self, u: np.ndarray) -> float:
        return self.interaction.evaluate(u, self._force, self._hessian)

    def _pairs(self) -> float:
        return self._transform.pairs + 0.5 * self._newton.transform.pairs

    def _gradient(self, stretch: np.ndarray, push: float) -> np.ndarray:
        gradient = stretch - self._force
        gradient[2] += -np.mean(gradient[2]) if self._fixed_mean else push
        return gradient

    def _apply_stiffness(self, u: np.ndarray) -> np.ndarray:
        """S u, in the transform's own buffer."""
        self._transform.field[...] = u
        multiply(self._transform.forward().view(np.float64), self._coefficients, self._multiplicity, 1.0)
        return self._transform.backward()

    def _set_curvature(self, at: _Iterate, gradient: np.ndarray, fading: float) -> None:
        """Put the interface's curvature of this step into the linear solver."""
        length, diagonal = self.interaction.length, self._newton.diagonal
        raised_curvature(self._hessian, gradient, at.gap, at.cosine, fading, length, diagonal)

    def _mean_wavenumber(self, stiffness: SurfaceStiffness) -> float:
        """Rms slope over rms height of the surface (1/m), at least the longest wave's."""
        gap, cosine = self.interaction.gap_and_cosine(np.zeros((3, *stiffness.grid.shape)))
        longest = 2 * np.pi / max(stiffness.grid.size)
        height = float(np.std(gap))
        slope = float(np.sqrt(np.mean(1 / cosine**2 - 1)))
        return max(slope / height, longest) if height > 0 else longest
