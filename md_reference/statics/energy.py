"""The energy of the bottom layer under load: ½ u·Su + E(u) + p a² Σu_z, its gradient, and steps that lower it.

In overdamped motion anchor springs of one stiffness tie every atom to its position before the time step, which adds
½ k |u − u_0|². Changes of the energy are summed from their parts: a difference of two totals would round away.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_study.numerics.balance import ROUNDING, Excess, excess
from contact_study.numerics.fourier import RealTransform
from contact_study.numerics.kernel import kernel
from md_reference.block.condensed import SurfaceStiffness
from md_reference.block.spectral import multiply
from md_reference.interface.cached import CachedInterface
from md_reference.interface.pairs import LennardJonesInterface
from md_reference.solution import Outcome, Solution
from md_reference.statics.atomwise import limit_step, raise_curvature
from md_reference.statics.linear import LinearSolver

# Line search; lengths in units of the interaction's length r0.
_LARGEST_STEP, _LARGEST_SLIDE = 10.0, 0.5  # of an atom, and of one along the surface
_VANISHING_STEP = 1e-9  # below which a step has no length
_BACKTRACK, _SHORTEST_FRACTION = 0.4, 1e-4  # factor between two trials of a step, smallest part of one that is tried
# Stiffness c of the preconditioner over √(strongest softening × stiffness of the surface's mean wave): the waves that
# soften with the interface. The strongest softening is in units of force_prefactor/r0.
_SHIFT_FRACTION, _SOFTENING = 0.22, 25 / 44
# At an equilibrium: conjugate-gradient iterations that search for negative curvature, and first step along it (r0).
_TEST_ITERATIONS, _TEST_STEP = 10, 0.03


@dataclass(frozen=True)
class Load:
    """Forces on the layer beside those of block and interface."""

    push: float  # on each atom toward the substrate (N); not used where the mean height is prescribed
    stiffness: float = 0.0  # of the anchor springs (N/m)
    anchor: np.ndarray | None = None  # their rest positions, shape (3, ny, nx) (m)


@dataclass
class MinimizerState:
    """A state u with its interaction energy, S u, gaps and tilt, and the progress of the steps to it."""

    displacement: np.ndarray
    energy: float
    stretch: np.ndarray
    gap: np.ndarray
    cosine: np.ndarray
    fresh: bool = True  # S u computed from u itself, not updated, and every atom evaluated here
    approaching: bool = False  # whether the surfaces had no contact at the start
    damping: float = 0.0  # share of negative curvature that is removed
    iteration: int = 0
    vanishing: int = 0  # consecutive steps of no length
    evaluations: float = 1.0  # of the interface, those of some atoms counted by their share


class BlockEnergy:
    """Energy (J), forces (N) and curvature of one block and one interface; residuals are over a² E*.

    ``fixed_mean`` keeps the mean of the normal component.
    ``force``, shape (3, ny, nx), is that of the interface on each atom at the last evaluated state (N).
    """

    def __init__(
        self,
        stiffness: SurfaceStiffness,
        interaction: LennardJonesInterface,
        contact_modulus: float,
        fixed_mean: bool,
        threads: int = 1,
    ):
        self.interaction = interaction
        self.area = stiffness.area_per_atom
        self.force_scale = contact_modulus * self.area
        self.fixed_mean = fixed_mean
        shape = (3, *stiffness.grid.shape)
        gap, cosine = interaction.gap_and_cosine(np.zeros(shape))
        self.mean_height = -float(np.mean(gap))  # of the surface under the atoms' rest positions (m)
        height, slope = float(np.std(gap)), float(np.sqrt(np.mean(1 / cosine**2 - 1)))
        longest = 2 * np.pi / max(stiffness.grid.size)
        softening = _SOFTENING * interaction.force_prefactor / interaction.length
        wave = 0.5 * self.force_scale * (max(slope / height, longest) if height > 0 else longest)
        self.newton = LinearSolver(stiffness, _SHIFT_FRACTION * (softening * wave) ** 0.5, fixed_mean, threads)
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

    def evaluate(self, displacement: np.ndarray) -> MinimizerState:
        """Evaluate a starting state; ValueError if an atom lies inside the substrate or is not finite."""
        u = displacement.copy()
        self._interface.forget()
        energy = self._interface.evaluate(u, self.force)
        if not np.isfinite(energy):
            raise ValueError("the starting state has atoms inside the substrate (or not finite): start it higher")
        return MinimizerState(u, energy, self.apply_stiffness(u).copy(), *self.interaction.gap_and_cosine(u))

    def gradient(self, state: MinimizerState, load: Load) -> np.ndarray:
        """Return the unbalanced force on each atom, negated (N)."""
        gradient = state.stretch - self.force
        gradient[2] += -np.mean(gradient[2]) if self.fixed_mean else load.push
        if load.anchor is not None:
            gradient += load.stiffness * (state.displacement - load.anchor)
        return gradient

    def residual(self, gradient: np.ndarray) -> float:
        """Return the largest component of a gradient over a² E*."""
        return float(np.max(np.abs(gradient))) / self.force_scale

    def excess(self, state: MinimizerState, gradient: np.ndarray, load: Load, tolerance: float) -> Excess:
        """Return how far a state is from balance, see :func:`contact_study.numerics.balance.excess`."""
        scale = self.force_scale
        push = 0.0 if self.fixed_mean else load.push / scale
        stress = float(np.abs(self.force[2]).max()) / scale
        missing = float(np.mean(gradient[2])) / scale
        rounding, points = self.rounding(state, load.stiffness), 1 if load.stiffness else gradient[2].size
        return excess(tolerance, self.residual(gradient), missing, push, stress, rounding, points)

    def rounding(self, state: MinimizerState, anchor_stiffness: float = 0.0) -> float:
        """Return the residual that the rounding of a displacement leaves."""
        stiffest = float(self._coefficients[2].max()) * self._transform.points + anchor_stiffness
        return ROUNDING * stiffest * float(np.abs(state.displacement).max()) / self.force_scale

    def set_curvature(
        self, state: MinimizerState, gradient: np.ndarray, damping: float, anchor_stiffness: float = 0.0
    ) -> None:
        """Give the linear solver the curvature of interface and springs; ``damping`` is removed of a negative one."""
        given = self._interface.hessian, gradient, state.gap, state.cosine
        raise_curvature(*given, damping, self.interaction.length, self.newton.diagonal)
        if anchor_stiffness:
            self.newton.diagonal[:3] += np.float32(anchor_stiffness)

    def search(self, state: MinimizerState, step: np.ndarray, load: Load, error: float = 0.0) -> float:
        """Take the part of a step by which the energy falls and return it; forces may be off by ``error`` then (N)."""
        length = self.interaction.length
        # Where forces nearly vanish, rounding alone would move a block for ever.
        excess = float(np.max(np.abs(step))) / (_LARGEST_STEP * length)
        if excess > 1:
            step /= excess
        noise = 1e-12 * abs(state.energy)  # rounding of the sum over pairs
        fraction = 1.0
        while fraction > _SHORTEST_FRACTION:
            trial, gap, cosine = self._trial(state, fraction * step)
            energy = self._evaluate(state, trial, self._trial_force, error)
            if np.isfinite(energy):
                move = trial - state.displacement
                stretch = self.apply_stiffness(move)
                change = _work_against(state.stretch, stretch, move, load.push)
                if load.anchor is not None:
                    change += load.stiffness * float(np.sum((state.displacement - load.anchor + 0.5 * move) * move))
                if change + energy - state.energy <= noise:
                    size = float(np.max(np.abs(move))) / length
                    state.vanishing = state.vanishing + 1 if size < _VANISHING_STEP else 0
                    state.displacement, state.energy, state.gap, state.cosine = trial, energy, gap, cosine
                    state.stretch += stretch
                    state.fresh = False
                    self.force, self._trial_force = self._trial_force, self.force
                    return fraction
            fraction *= _BACKTRACK
        state.vanishing += 1
        state.energy = self._evaluate(state, state.displacement, self.force, error)
        return 0.0

    def leave_saddle(self, state: MinimizerState) -> bool:
        """Move an equilibrium to lower energy along a direction of negative curvature; return whether it has any."""
        self.set_curvature(state, np.zeros_like(self.force), 0.0)
        direction = self.newton.unstable_direction(_TEST_ITERATIONS)
        if direction is None:
            return False
        stretch = self.apply_stiffness(direction).copy()
        elastic_slope = float(np.sum(self.force * direction))  # in balance the interface's slope is opposite
        elastic_curvature = float(np.sum(stretch * direction))
        length = _TEST_STEP * self.interaction.length
        while length > _VANISHING_STEP * self.interaction.length:
            for move in (length, -length):
                trial = state.displacement + move * direction
                energy = self._evaluate(state, trial, self.force)
                if move * elastic_slope + 0.5 * move**2 * elastic_curvature + energy < state.energy:
                    state.displacement, state.energy, state.vanishing = trial, energy, 0
                    state.gap, state.cosine = self.interaction.gap_and_cosine(trial)
                    self.refresh(state)
                    return True
            length *= _BACKTRACK
        self._evaluate(state, state.displacement, self.force)
        return False

    def refresh(self, state: MinimizerState) -> None:
        """Evaluate every expanded atom, and compute S u from u."""
        state.energy = self._evaluate(state, state.displacement, self.force)
        state.stretch = self.apply_stiffness(state.displacement).copy()
        state.fresh = True

    def apply_stiffness(self, u: np.ndarray) -> np.ndarray:
        """Return S u, in the transform's own buffer."""
        self._transform.field[...] = u
        multiply(self._transform.forward().view(np.float64), self._coefficients, self._multiplicity, 1.0)
        return self._transform.backward()

    def equilibrium(
        self, state: MinimizerState, residual: float, outcome: Outcome, iterations: int, pairs: float
    ) -> Solution:
        """Return the last evaluated state as a solution."""
        elastic = 0.5 * float(np.sum(state.displacement * state.stretch))
        work = {"iterations": iterations, "force_evaluations": round(state.evaluations), "fft_pairs": pairs}
        return self.solution(state.displacement, self.force, outcome, residual, elastic, state.energy, **work)

    def solution(
        self,
        displacement: np.ndarray,
        force: np.ndarray,
        outcome: Outcome,
        residual: float,
        elastic_energy: float,
        interaction_energy: float,
        **work: Any,
    ) -> Solution:
        """Return a state of the layer, with the interface's forces (N) and energies (J), as one of the contact."""
        apart, interface, atoms = outcome is Outcome.DETACHED, self.interaction, force[2].size
        # Atoms that slide to other heights change their mean gap, not the distance on which the load does work.
        separation = float(np.mean(displacement[2])) - self.mean_height - interface.length
        return Solution(
            displacement=displacement,
            residual=0.0 if apart else residual,
            outcome=outcome,
            elastic_energy=0.0 if apart else elastic_energy / (self.area * atoms),
            interaction_energy=interaction_energy / (self.area * atoms),
            # A detached block has no definite position: the next step starts from separation again.
            state=separated(interface) if apart else displacement,
            gap=np.full(force[2].shape, np.inf) if apart else interface.gap(displacement),
            pressure=force[2] / self.area,
            shear_stress=force[:2] / self.area,
            mean_separation=np.inf if apart else separation,
            length=interface.length,
            **work,
        )

    def _evaluate(self, state: MinimizerState, u: np.ndarray, force: np.ndarray, error: float = 0.0) -> float:
        """Write the forces near a state, whose work it counts as; return the energy (J)."""
        before = self._interface.evaluations
        energy = self._interface.evaluate(u, force, error)
        state.evaluations += self._interface.evaluations - before
        return energy

    def _trial(self, state: MinimizerState, step: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return displacement, gap and cosine of the tilt after a step, limited atom by atom."""
        length, trial = self.interaction.length, state.displacement + step
        slide = _LARGEST_SLIDE * length
        trial[:2] = state.displacement[:2] + np.clip(step[:2], -slide, slide)
        gap, cosine = self.interaction.gap_and_cosine(trial)
        before = state.gap, state.cosine, self.force[2], length, self.interaction.force_prefactor
        limit_step(*before, gap, cosine, trial[2])
        if self.fixed_mean:
            shift = np.mean(state.displacement[2]) - np.mean(trial[2])
            trial[2] += shift
            gap += shift
        return trial, gap, cosine


def separated(interface: LennardJonesInterface) -> np.ndarray:
    """Return a flat layer of atoms just beyond the cutoff from the highest site, shape (3, ny, nx) (m)."""
    displacement = np.zeros((3, *interface.shape))
    displacement[2] = np.max(interface.substrate.heights) + (1 + 1e-6) * interface.cutoff * interface.length
    return displacement


@kernel
def _work_against(stretch, change, move, push):
    """Return the work (S u + ½ S d)·d of a move d from u and that of the push, ``change`` being S d (J)."""
    total = 0.0
    for c in range(3):
        load = push if c == 2 else 0.0
        for j in range(move.shape[1]):
            row = 0.0
            for i in range(move.shape[2]):
                row += (stretch[c, j, i] + 0.5 * change[c, j, i] + load) * move[c, j, i]
            total += row
    return total
