"""The energy of the bottom layer under load: ½ u·Su + E(u) + p a² Σu_z, its slope, and steps that lower it.

Where the layer is dragged, springs of one stiffness tie every atom to where it was, ½ k |u − u_0|² more. Changes of the
energy are summed from their parts, never a difference of two totals, which would round away.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from contact_study.numerics.balance import ROUNDING, Excess, excess
from contact_study.numerics.fourier import RealTransform
from md_reference.block.condensed import SurfaceStiffness
from md_reference.block.spectral import multiply
from md_reference.interface.cached import CachedInterface
from md_reference.interface.pairs import AtomwiseInteraction
from md_reference.statics.curvature import raised_curvature
from md_reference.statics.linear import NewtonSolver
from md_reference.statics.step_limiter import land

# Lengths in units of the interaction's length r0.
_LARGEST_STEP = 10.0
_LARGEST_SLIDE = 0.5  # of an atom along the surface in one step
_VANISHING_STEP = 1e-9
_BACKTRACK, _SHORTEST_FRACTION = 0.4, 1e-4
# Stiffness c of the preconditioner, over √(strongest softening × stiffness of the surface's mean wave): the waves that
# soften with the interface. In units of force_prefactor/r0 the strongest softening is 25/44.
_SHIFT_FRACTION, _SOFTENING = 0.22, 25 / 44


@dataclass(frozen=True)
class Load:
    """What acts on the layer besides block and interface.

    Attributes
    ----------
    push : float
        Force on each atom toward the substrate (N); without meaning where the mean height is held.
    drag : float
        Stiffness of the springs that tie each atom to where it was (N/m).
    anchor : numpy.ndarray or None
        Where that is, shape (3, ny, nx) (m).
    """

    push: float
    drag: float = 0.0
    anchor: np.ndarray | None = None


@dataclass
class MinimizerState:
    """A state u with its interaction energy, S u, gaps and tilt, and the steps that led there."""

    displacement: np.ndarray
    energy: float
    stretch: np.ndarray
    gap: np.ndarray
    cosine: np.ndarray
    fresh: bool = True  # S u computed from u itself, not updated, and every atom evaluated here
    vanishing: int = 0  # steps of no length in a row
    evaluations: float = 1.0  # of the interface, those of some atoms counted by their share


class Landscape:
    """Energy, forces and curvature of one block and one interface, owner of all work arrays.

    Parameters
    ----------
    stiffness : SurfaceStiffness
        The condensed block.
    interaction : AtomwiseInteraction
        The interface.
    contact_modulus : float
        E*, the scale of forces (Pa).
    fixed_mean : bool
        Whether the mean of the normal component keeps its value.
    threads : int, optional
        Threads of FFTW.

    Attributes
    ----------
    force : numpy.ndarray, shape (3, ny, nx)
        Of the interface on each atom where it was last evaluated or moved to (N).
    newton : NewtonSolver
        Of the linear problems.
    """

    def __init__(
        self,
        stiffness: SurfaceStiffness,
        interaction: AtomwiseInteraction,
        contact_modulus: float,
        fixed_mean: bool,
        threads: int = 1,
    ):
        self.interaction = interaction
        self.area = stiffness.area_per_atom
        self.force_scale = contact_modulus * self.area
        self.fixed_mean = fixed_mean
        shape = (3, *stiffness.grid.shape)
        softening = _SOFTENING * interaction.force_prefactor / interaction.length
        wave = 0.5 * self.force_scale * self._mean_wavenumber(stiffness)
        self.newton = NewtonSolver(stiffness, _SHIFT_FRACTION * (softening * wave) ** 0.5, fixed_mean, threads)
        self._transform = RealTransform(shape, np.float64, threads)
        self._coefficients = stiffness.coefficients / self._transform.points
        self._coefficients[2, 0, 0] = 0.0
        self._multiplicity = stiffness.grid.multiplicity[0]
        self.force = np.empty(shape)
        self._trial_force = np.empty(shape)
        self._interface = CachedInterface(interaction, shape[1:])

    @property
    def pairs(self) -> float:
        """Transform pairs of three components so far, a single-precision pair counted one half."""
        return self._transform.pairs + 0.5 * self.newton.pairs

    def place(self, displacement: np.ndarray) -> MinimizerState:
        """A state to start from.

        Raises
        ------
        ValueError
            If an atom lies inside the substrate or is not finite.
        """
        u = displacement.copy()
        self._interface.forget()
        energy = self._interface.evaluate(u, self.force)
        if not np.isfinite(energy):
            raise ValueError("the starting state has atoms inside the substrate (or not finite): start it higher")
        return MinimizerState(u, energy, self.apply_stiffness(u).copy(), *self.interaction.gap_and_cosine(u))

    def gradient(self, at: MinimizerState, load: Load) -> np.ndarray:
        """Force out of balance on each atom, negated (N)."""
        gradient = at.stretch - self.force
        gradient[2] += -np.mean(gradient[2]) if self.fixed_mean else load.push
        if load.anchor is not None:
            gradient += load.drag * (at.displacement - load.anchor)
        return gradient

    def residual(self, gradient: np.ndarray) -> float:
        """Its largest component, over a² E*."""
        return float(np.max(np.abs(gradient))) / self.force_scale

    def excess(self, at: MinimizerState, gradient: np.ndarray, load: Load, tolerance: float) -> Excess:
        """Return how far a state is from balance, without the springs of a drag: see :func:`excess`."""
        scale = self.force_scale
        push = 0.0 if self.fixed_mean else load.push / scale
        stress = float(np.abs(self.force[2]).max()) / scale
        missing = float(np.mean(gradient[2])) / scale
        rounding, points = self.rounding(at, load.drag), 1 if load.drag else gradient[2].size
        return excess(tolerance, self.residual(gradient), missing, push, stress, rounding, points)

    def rounding(self, at: MinimizerState, drag: float = 0.0) -> float:
        """Residual that the rounding of a displacement leaves."""
        stiffest = float(self._coefficients[2].max()) * self._transform.points + drag
        return ROUNDING * stiffest * float(np.abs(at.displacement).max()) / self.force_scale

    def set_curvature(self, at: MinimizerState, gradient: np.ndarray, fading: float, drag: float = 0.0) -> None:
        """Put the curvature of interface and drag into the linear solver."""
        length, diagonal = self.interaction.length, self.newton.diagonal
        raised_curvature(self._interface.hessian, gradient, at.gap, at.cosine, fading, length, diagonal)
        if drag:
            diagonal[:3] += np.float32(drag)

    def search(self, at: MinimizerState, step: np.ndarray, load: Load, error: float = 0.0) -> float:
        """Shorten the step until the energy falls, and move there; the fraction taken, zero if it never falls.

        Forces there may be off by ``error`` (N), see :mod:`md_reference.interface.cached`.
        """
        # Where next to nothing acts, rounding is all that keeps a block from moving for ever.
        excess = float(np.max(np.abs(step))) / (_LARGEST_STEP * self.interaction.length)
        if excess > 1:
            step /= excess
        noise = 1e-12 * abs(at.energy)  # rounding of the sum over pairs
        fraction = 1.0
        while fraction > _SHORTEST_FRACTION:
            trial, gap, cosine = self._trial(at, fraction * step)
            energy = self._evaluate(at, trial, self._trial_force, error)
            if np.isfinite(energy):
                move = trial - at.displacement
                stretch = self.apply_stiffness(move)
                change = _work_against(at.stretch, stretch, move, load.push)
                if load.anchor is not None:
                    change += load.drag * float(np.sum((at.displacement - load.anchor + 0.5 * move) * move))
                if change + energy - at.energy <= noise:
                    size = float(np.max(np.abs(move))) / self.interaction.length
                    at.vanishing = at.vanishing + 1 if size < _VANISHING_STEP else 0
                    at.displacement, at.energy, at.gap, at.cosine = trial, energy, gap, cosine
                    at.stretch += stretch
                    at.fresh = False
                    self.force, self._trial_force = self._trial_force, self.force
                    return fraction
            fraction *= _BACKTRACK
        at.vanishing += 1
        at.energy = self._evaluate(at, at.displacement, self.force, error)
        return 0.0

    def step_downhill(self, at: MinimizerState, direction: np.ndarray, length: float) -> bool:
        """Move along a direction, to either side, to where the energy of a balanced state falls; whether it does.

        Parameters
        ----------
        direction : numpy.ndarray, shape (3, ny, nx)
            Its largest component is one.
        length : float
            Of the first try (m).
        """
        stretch = self.apply_stiffness(direction).copy()
        elastic_slope = float(np.sum(self.force * direction))  # in balance: what the interface holds
        elastic_curvature = float(np.sum(stretch * direction))
        while length > _VANISHING_STEP * self.interaction.length:
            for move in (length, -length):
                trial = at.displacement + move * direction
                energy = self._evaluate(at, trial, self.force)
                if move * elastic_slope + 0.5 * move**2 * elastic_curvature + energy < at.energy:
                    at.displacement, at.energy, at.vanishing = trial, energy, 0
                    at.gap, at.cosine = self.interaction.gap_and_cosine(trial)
                    self.refresh(at)
                    return True
            length *= _BACKTRACK
        self._evaluate(at, at.displacement, self.force)
        return False

    def refresh(self, at: MinimizerState) -> None:
        """Evaluate the interface wherever it is expanded, and compute S u anew."""
        at.energy = self._evaluate(at, at.displacement, self.force)
        self.stretch_anew(at)
        at.fresh = True

    def stretch_anew(self, at: MinimizerState) -> None:
        """Compute S u free of the rounding of its updates."""
        at.stretch = self.apply_stiffness(at.displacement).copy()

    def apply_stiffness(self, u: np.ndarray) -> np.ndarray:
        """S u, in the transform's own buffer."""
        self._transform.field[...] = u
        multiply(self._transform.forward().view(np.float64), self._coefficients, self._multiplicity, 1.0)
        return self._transform.backward()

    def _evaluate(self, at: MinimizerState, u: np.ndarray, force: np.ndarray, error: float = 0.0) -> float:
        """Energy of the interface at a state near a place (J), whose work it counts as; writes the forces."""
        before = self._interface.evaluations
        energy = self._interface.evaluate(u, force, error)
        at.evaluations += self._interface.evaluations - before
        return energy

    def _trial(self, at: MinimizerState, step: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Displacement, gap and cosine of the tilt after a step in which every atom lands softly."""
        length = self.interaction.length
        trial = at.displacement + step
        slide = _LARGEST_SLIDE * length
        trial[:2] = at.displacement[:2] + np.clip(step[:2], -slide, slide)
        gap, cosine = self.interaction.gap_and_cosine(trial)
        land(at.gap, at.cosine, self.force[2], length, self.interaction.force_prefactor, gap, cosine, trial[2])
        if self.fixed_mean:
            shift = np.mean(at.displacement[2]) - np.mean(trial[2])
            trial[2] += shift
            gap += shift
        return trial, gap, cosine

    def _mean_wavenumber(self, stiffness: SurfaceStiffness) -> float:
        """Rms slope over rms height of the surface (1/m), at least the longest wave's."""
        gap, cosine = self.interaction.gap_and_cosine(np.zeros((3, *stiffness.grid.shape)))
        longest = 2 * np.pi / max(stiffness.grid.size)
        height = float(np.std(gap))
        slope = float(np.sqrt(np.mean(1 / cosine**2 - 1)))
        return max(slope / height, longest) if height > 0 else longest


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _work_against(stretch, change, move, push):
    """Sum of (S u + ½ S d)·d and of the push on d_z: what a move d from u takes, S d being ``change`` (J)."""
    total = 0.0
    for c in range(3):
        load = push if c == 2 else 0.0
        for j in range(move.shape[1]):
            row = 0.0
            for i in range(move.shape[2]):
                row += (stretch[c, j, i] + 0.5 * change[c, j, i] + load) * move[c, j, i]
            total += row
    return total
