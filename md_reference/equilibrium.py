"""Mechanical equilibrium at zero temperature: minimise ½ u·Su + E(u) + p a² Σu_z over the bottom layer of atoms.

A truncated Newton method. Where an attracted atom is still on its way to the surface its interaction has negative
curvature and Newton's model is useless; there each atom is given at least the curvature k|F_z|/(gap − r0), a spring
that ends at contact, until a full step becomes small. Then the exact Hessian takes over.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from contact_study.fields.fourier import RealTransform
from md_reference.block import SurfaceStiffness
from md_reference.interface import Interaction
from md_reference.newton_step import NewtonSolver, NewtonStep
from md_reference.snap_in import raised_curvature
from md_reference.solution import Equilibrium, Outcome

# Lengths in units of the interaction's length r0, stresses in units of the contact modulus.
_FIRST_STEP = 0.3
_LARGEST_STEP = 0.9
_SMALL_STEP = 0.3  # a full step below this hands over to the exact Hessian
_SMALLEST_GAP = 0.03  # bounds the snap-in curvature where the gap is close to r0
_VANISHING_STEP = 1e-9
_VANISHING_STEPS = 5  # as many in a row mean that the residual has reached its rounding
_SNAP_IN_FACTOR = 2.0
_SHIFT_FRACTION = 0.1  # c of the preconditioner, in units of the mean normal curvature of the interface
_SMALLEST_SHIFT = 4e-5  # the same in units of E* a, where nothing touches
_SNAP_IN_ITERATIONS = 15
_EXACT_ITERATIONS = 300
_LARGEST_REDUCTION = 0.3
_SMALLEST_REDUCTION = 0.03  # single precision loses more than it gains below
_OVERSHOOT = 3.0  # a linear solve ends where its step exceeds the trusted one by this factor
_BACKTRACK = 0.4
_SADDLE_ITERATIONS = 20  # of conjugate gradients that look for negative curvature at an equilibrium
_SADDLE_STEP = 0.03
_REFRESH = 20  # accepted steps after which S u is computed anew from u


@dataclass
class _Iterate:
    """Where a solve stands: the state u, its interaction energy, S u and what the next step may rely on."""

    displacement: np.ndarray
    energy: float
    stretch: np.ndarray
    fresh: bool = True  # S u computed from u itself, not updated
    trust: float = _FIRST_STEP
    exact: bool = False  # Newton's own model instead of the snap-in springs
    snap_in_until: int = 0  # iteration before which the springs stay
    vanishing: int = 0  # steps of no length in a row
    iteration: int = 0
    evaluations: int = 1


@dataclass(frozen=True)
class _Taken:
    """A step taken: fraction of Newton's, largest component over r0, and how well the model foretold the energy."""

    fraction: float
    size: float
    shortened: bool
    foretold: bool


def _trusted(trust: float, taken: _Taken) -> float:
    """Largest step to try next: cut after a failure, doubled where a step of nearly that size went as foretold."""
    if taken.shortened:
        return max(1.2 * taken.size, 0.01 * _FIRST_STEP)
    if taken.size > 0.9 * trust and taken.foretold:
        return min(2 * trust, _LARGEST_STEP)
    return trust


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
        self._smallest_shift = _SMALLEST_SHIFT * contact_modulus * stiffness.lattice_constant
        self._fixed_mean = control == "gap"
        self._newton = NewtonSolver(stiffness, self._fixed_mean, threads)
        shape = (3, *stiffness.grid.shape)
        self._transform = RealTransform(shape, np.float64, threads)
        self._coefficients = stiffness.coefficients / self._transform.points
        self._coefficients[2, 0, 0] = 0.0
        self._force = np.empty(shape)
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
            newton = self._newton_step(at, gradient, residual)
            if newton is not None:
                self._advance(at, newton, gradient, push)
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
        return _Iterate(u, energy, self._apply_stiffness(u).copy())

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
        direction = self._newton.unstable_direction(self._set_curvature(at.displacement, True), _SADDLE_ITERATIONS)
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
                    at.displacement, at.energy, at.exact, at.vanishing = trial, energy, False, 0
                    self._refresh(at)
                    return True
            length *= _BACKTRACK
        self._evaluate(at.displacement)
        return False

    def _newton_step(self, at: _Iterate, gradient: np.ndarray, residual: float) -> NewtonStep | None:
        """Solve the linear model of the energy; None if its first direction already has negative curvature."""
        shift = self._set_curvature(at.displacement, at.exact)
        if not at.exact:
            newton = self._newton.solve(gradient, shift, _LARGEST_REDUCTION, _SNAP_IN_ITERATIONS, np.inf)
            # With its springs nothing is indefinite: where the first direction has no curvature, nothing acts yet.
            falls = newton.indefinite and newton.iterations == 1 and not self._fixed_mean
            return self._fall(gradient) if falls else newton
        # The forcing term falls with the residual (in units of E*/100) for fast final convergence.
        reduction = min(_LARGEST_REDUCTION, max(_SMALLEST_REDUCTION, (100 * residual) ** 0.5))
        reach = _OVERSHOOT * at.trust * self.interaction.length
        newton = self._newton.solve(gradient, shift, reduction, _EXACT_ITERATIONS, reach)
        if newton.indefinite:
            at.exact = False
            at.snap_in_until = at.iteration + 1
            if newton.iterations == 1:
                return None
        return newton

    def _fall(self, gradient: np.ndarray) -> NewtonStep:
        """A block out of reach of the substrate comes down as a whole."""
        step = np.zeros_like(gradient)
        step[2] = -_LARGEST_STEP * self.interaction.length
        return NewtonStep(step, 0.0, 1, False)

    def _advance(self, at: _Iterate, newton: NewtonStep, gradient: np.ndarray, push: float) -> None:
        """Take the step as far as the energy follows it, and adapt what the next one may rely on."""
        stretch_step = self._apply_stiffness(newton.step)
        taken = self._search(at, newton, stretch_step, gradient, push)
        at.vanishing = at.vanishing + 1 if taken.size < _VANISHING_STEP else 0
        at.trust = _trusted(at.trust, taken)
        if at.iteration >= at.snap_in_until and taken.fraction == 1.0 and taken.size < _SMALL_STEP:
            at.exact = True
        if at.iteration % _REFRESH == 0:
            self._refresh(at)
        else:
            at.stretch += taken.fraction * stretch_step
            at.fresh = False

    def _search(
        self, at: _Iterate, newton: NewtonStep, stretch_step: np.ndarray, gradient: np.ndarray, push: float
    ) -> _Taken:
        """Shorten the step until the energy falls by a tenth of what the linear model says, and move there.

        The change of energy is summed from its parts, never a difference of two totals, which would round away.
        """
        step = newton.step
        length = float(np.max(np.abs(step))) / self.interaction.length
        fraction = min(1.0, at.trust / length)
        slope = float(np.sum(gradient * step))
        elastic_slope = float(np.sum(at.stretch * step)) + push * float(np.sum(step[2]))
        elastic_curvature = float(np.sum(stretch_step * step))
        noise = 1e-12 * abs(at.energy)  # rounding of the sum over pairs
        shortened = False
        while True:
            trial = at.displacement + fraction * step
            energy = self._evaluate(trial)
            at.evaluations += 1
            change = fraction * elastic_slope + 0.5 * fraction**2 * elastic_curvature + energy - at.energy
            model = fraction * slope + 0.5 * fraction**2 * newton.curvature
            if change <= 0.1 * model + noise or (fraction * length < _VANISHING_STEP and np.isfinite(energy)):
                break
            fraction *= _BACKTRACK
            shortened = True
        at.displacement, at.energy = trial, energy
        return _Taken(fraction, fraction * length, shortened, change <= 0.6 * model + noise)

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
        _multiply(self._transform.forward().view(np.float64), self._coefficients)
        return self._transform.backward()

    def _set_curvature(self, u: np.ndarray, exact: bool) -> float:
        """Put the interface's curvature of this step into the linear solver; returns the preconditioner's shift."""
        length = self.interaction.length
        gap = u[2] if exact else self.interaction.gap(u)
        factor = 0.0 if exact else _SNAP_IN_FACTOR
        stiff = raised_curvature(
            self._hessian, self._force, gap, factor, length, _SMALLEST_GAP * length, self._newton.diagonal
        )
        return max(_SHIFT_FRACTION * stiff / gap.size, self._smallest_shift)


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _multiply(spectrum, coefficients):
    """Spectrum of S u in place; see the module ``block`` for the real form of S."""
    for j in range(coefficients.shape[1]):
        for i in range(coefficients.shape[2]):
            xx = coefficients[0, j, i]
            yy = coefficients[1, j, i]
            zz = coefficients[2, j, i]
            xy = coefficients[3, j, i]
            xz = coefficients[4, j, i]
            yz = coefficients[5, j, i]
            x_re = spectrum[0, j, 2 * i]
            x_im = spectrum[0, j, 2 * i + 1]
            y_re = spectrum[1, j, 2 * i]
            y_im = spectrum[1, j, 2 * i + 1]
            z_re = -spectrum[2, j, 2 * i + 1]
            z_im = spectrum[2, j, 2 * i]
            spectrum[0, j, 2 * i] = xx * x_re + xy * y_re + xz * z_re
            spectrum[0, j, 2 * i + 1] = xx * x_im + xy * y_im + xz * z_im
            spectrum[1, j, 2 * i] = xy * x_re + yy * y_re + yz * z_re
            spectrum[1, j, 2 * i + 1] = xy * x_im + yy * y_im + yz * z_im
            spectrum[2, j, 2 * i] = xz * x_im + yz * y_im + zz * z_im
            spectrum[2, j, 2 * i + 1] = -(xz * x_re + yz * y_re + zz * z_re)
