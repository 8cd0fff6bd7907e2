"""Mechanical equilibrium at zero temperature: minimise ½ u·Su + E(u) + p a² Σu_z over the bottom layer of atoms.

A truncated Newton method. Where an attracted atom is still on its way to the surface its interaction has negative
curvature and Newton's model is useless; there each atom is given at least the curvature k|F_z|/(gap − r0), a spring
that ends at contact, until a full step becomes small. Then the exact Hessian takes over.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numba import njit

from contact_study.fields.fourier import RealTransform
from md_reference.block import SurfaceStiffness
from md_reference.interface import Interaction
from md_reference.newton_step import NewtonSolver

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
_REFRESH = 20  # accepted steps after which S u is computed anew from u


class Outcome(Enum):
    """How a solve ended; the value is the sentence for the user."""

    CONVERGED = "converged"
    DETACHED = "detached: no atom is within reach of the substrate and no pressure drives the block towards it"
    ITERATION_LIMIT = (
        "the iteration limit was reached before the tolerance: take smaller loading steps or raise "
        "solver.max_iterations"
    )
    STALLED = "no step lowers the energy although the residual is above the tolerance: raise solver.tolerance"


@dataclass(frozen=True)
class Equilibrium:
    """A state and how it was reached.

    Attributes
    ----------
    displacement : numpy.ndarray, shape (3, ny, nx)
        Lateral moves along x and y from the rest positions, and height over the mean plane of the substrate (m).
    force : numpy.ndarray, shape (3, ny, nx)
        Force of the interface on each atom (N).
    residual : float
        Largest force component left on an atom, over a² E*.
    outcome : Outcome
        How the solve ended.
    iterations, evaluations : int
        Newton steps and evaluations of the interface.
    fft_pairs : float
        Transform pairs of three components, a single-precision pair counted one half.
    elastic_energy, interaction_energy : float
        ½ u·Su and E(u) (J).
    """

    displacement: np.ndarray
    force: np.ndarray
    residual: float
    outcome: Outcome
    iterations: int
    evaluations: int
    fft_pairs: float
    elastic_energy: float
    interaction_energy: float

    @property
    def converged(self) -> bool:
        """Whether the residual is within the tolerance and the surfaces have not come apart."""
        return self.outcome is Outcome.CONVERGED


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
        u = start.copy()
        energy = self._evaluate(u)
        evaluations = 1
        if not np.isfinite(energy):
            raise ValueError("the starting state has atoms inside the substrate (or not finite): start it higher")
        push = 0.0 if self._fixed_mean else pressure * self._area
        stretch = self._apply_stiffness(u).copy()
        trust = _FIRST_STEP
        exact = False
        hold = 0
        fresh = True
        vanishing = 0
        iteration = 0
        while True:
            gradient = self._gradient(stretch, push)
            residual = float(np.max(np.abs(gradient))) / self._force_scale
            if not self._fixed_mean and pressure <= 0 and not self._force.any():
                outcome = Outcome.DETACHED
                break
            if residual <= self.tolerance:
                if fresh:
                    outcome = Outcome.CONVERGED
                    break
                stretch = self._apply_stiffness(u).copy()
                fresh = True
                continue
            if iteration >= self.max_iterations:
                outcome = Outcome.ITERATION_LIMIT
                break
            if vanishing >= _VANISHING_STEPS:
                outcome = Outcome.STALLED
                break
            iteration += 1
            shift = self._set_curvature(u, exact)
            if exact:
                # The forcing term falls with the residual (in units of E*/100) for fast final convergence.
                reduction = min(_LARGEST_REDUCTION, max(_SMALLEST_REDUCTION, (100 * residual) ** 0.5))
                inner = _EXACT_ITERATIONS
            else:
                reduction = _LARGEST_REDUCTION
                inner = _SNAP_IN_ITERATIONS
            reach = _OVERSHOOT * trust * self.interaction.length if exact else np.inf
            newton = self._newton.solve(gradient, shift, reduction, inner, reach)
            if newton.indefinite and exact:
                exact = False
                hold = iteration + 1
                if newton.iterations == 1:
                    continue
            step = newton.step
            size = float(np.max(np.abs(step))) / self.interaction.length
            scale = min(1.0, trust / size)
            stretch_step = self._apply_stiffness(step)
            slope = float(np.sum(gradient * step))
            elastic_slope = float(np.sum(stretch * step)) + push * float(np.sum(step[2]))
            elastic_curvature = float(np.sum(stretch_step * step))
            shortened = False
            while True:
                trial = u + scale * step
                trial_energy = self._evaluate(trial)
                evaluations += 1
                change = scale * elastic_slope + 0.5 * scale**2 * elastic_curvature + trial_energy - energy
                model = scale * slope + 0.5 * scale**2 * newton.curvature
                noise = 1e-12 * abs(energy)  # rounding of the sum over pairs
                if change <= 0.1 * model + noise:
                    break
                if scale * size < _VANISHING_STEP and np.isfinite(trial_energy):
                    break
                scale *= _BACKTRACK
                trust = scale * size
                shortened = True
            vanishing = vanishing + 1 if scale * size < _VANISHING_STEP else 0
            if shortened:
                trust = max(1.2 * trust, 0.01 * _FIRST_STEP)
            elif scale * size > 0.9 * trust and change <= 0.6 * model + noise:
                trust = min(2 * trust, _LARGEST_STEP)
            if not exact and iteration >= hold and scale == 1.0 and size < _SMALL_STEP:
                exact = True
            u = trial
            energy = trial_energy
            fresh = iteration % _REFRESH == 0
            if fresh:
                stretch = self._apply_stiffness(u).copy()
            else:
                stretch += scale * stretch_step
        return Equilibrium(
            displacement=u,
            force=self._force.copy(),
            residual=residual,
            outcome=outcome,
            iterations=iteration,
            evaluations=evaluations,
            fft_pairs=self._pairs() - transforms,
            elastic_energy=0.5 * float(np.sum(u * stretch)),
            interaction_energy=energy,
        )

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
        stiff = _curvature(
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


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _curvature(hessian, force, gap, factor, length, smallest_gap, diagonal):
    """Hessian of each atom, raised by a multiple of 1 so that its lowest eigenvalue reaches the snap-in spring.

    With ``factor`` zero the Hessian is copied. Returns the sum over atoms of the positive part of the zz component.
    """
    stiff = 0.0
    for j in range(gap.shape[0]):
        for i in range(gap.shape[1]):
            xx = hessian[0, j, i]
            yy = hessian[1, j, i]
            zz = hessian[2, j, i]
            xy = hessian[3, j, i]
            xz = hessian[4, j, i]
            yz = hessian[5, j, i]
            lift = 0.0
            if factor > 0.0:
                wanted = 0.0
                if force[2, j, i] < 0.0:
                    wanted = factor * -force[2, j, i] / max(gap[j, i] - length, smallest_gap)
                lift = max(0.0, wanted - _lowest_eigenvalue(xx, yy, zz, xy, xz, yz))
            diagonal[0, j, i] = xx + lift
            diagonal[1, j, i] = yy + lift
            diagonal[2, j, i] = zz + lift
            diagonal[3, j, i] = xy
            diagonal[4, j, i] = xz
            diagonal[5, j, i] = yz
            stiff += max(zz + lift, 0.0)
    return stiff


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _lowest_eigenvalue(xx, yy, zz, xy, xz, yz):
    """Of a symmetric 3×3 matrix, by the trigonometric solution of its characteristic equation."""
    mean = (xx + yy + zz) / 3.0
    off = xy * xy + xz * xz + yz * yz
    spread = (xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2.0 * off
    if spread == 0.0:
        return mean
    p = np.sqrt(spread / 6.0)
    a = (xx - mean) / p
    b = (yy - mean) / p
    c = (zz - mean) / p
    d = xy / p
    e = xz / p
    f = yz / p
    r = 0.5 * (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e))
    return mean + 2.0 * p * np.cos(np.arccos(min(1.0, max(-1.0, r))) / 3.0 + 2.0 * np.pi / 3.0)
