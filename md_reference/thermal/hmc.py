"""Canonical distribution of the bottom layer at a temperature, by Fourier-accelerated hybrid Monte Carlo.

The interior of a harmonic block integrates out: P(u) ∝ exp(−V(u)/k_BT), V = ½ u·Su + E(u) + p a² Σu_z, exactly so for
any time step (S. Duane, A. D. Kennedy, B. J. Pendleton, D. Roweth, Phys. Lett. B 195, 216 (1987)). With each wave's
stiffness as its mass all waves oscillate at one frequency (G. G. Batrouni et al., Phys. Rev. D 32, 2736 (1985)), and
time is counted in √(mass/stiffness), without a unit.

The scheme has two stages, kicks of b, 1 − 2b and b of a step h and drifts of half a step between them (S. Blanes,
F. Casas, J. M. Sanz-Serna, SIAM J. Sci. Comput. 36, A1556 (2014), doi:10.1137/130932740). On a harmonic wave it
conserves ½v² + ½(1 + (b² − 3b/2 + ¼)h² + …)u², whose bracket vanishes with b = (3 − √5)/4.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy import constants

from contact_study.numerics.fourier import RealTransform
from md_reference.block.condensed import SurfaceStiffness
from md_reference.block.spectral import accelerate, quadratic
from md_reference.interface.pairs import LennardJonesInterface

# Times in units of √(mass/stiffness).
_OUTER_KICK = (3 - 5**0.5) / 4  # b
_TRAJECTORY = 3.2  # mean length of a trajectory: half a period of a wave
_FIRST_STEP, _SMALLEST_STEP = 0.4, 0.4 / 64
# Aimed share of accepted proposals: above 0.65, the optimum of second order (A. Beskos, Bernoulli 19, 1501 (2013)).
_ACCEPTANCE = 0.85
_GAIN = 0.7  # of ln(time step) per proposal, over the root of their number
_RELAXING = 0.25  # share of the equilibration that brings the state to its temperature
_UNSTABLE = 0.2  # ΔH over the thermal energy of all freedoms at which a step counts as unstable there
_SMALLEST_SHIFT = 1e-3  # c without contact, over E* a
_SMALLEST_SHARE = 1 / 16  # of c for the longest waves: at first they meet all of c


@dataclass(frozen=True)
class SamplerState:
    """State of a Markov chain; spectra have shape (3, ny, nx // 2 + 1), and ``evaluations`` counts all."""

    displacement: np.ndarray  # spectrum, Σ u exp(−i q·x) (m)
    time_step: float  # of the scheme's two stages together, in units of √(mass/stiffness)
    mass: np.ndarray  # of every wave along x, y and z (N/m)
    trajectories: int = 0
    accepted: int = 0
    evaluations: int = 0  # of the interface


class ThermalSampler:
    """Sampler for one block and one interface; ``fixed_mean`` keeps the normal mean and ignores the pressure (Pa)."""

    def __init__(
        self,
        stiffness: SurfaceStiffness,
        interaction: LennardJonesInterface,
        contact_modulus: float,
        temperature: float,
        pressure: float = 0.0,
        fixed_mean: bool = False,
    ):
        self.interaction = interaction
        self.thermal_energy = constants.k * temperature
        grid = stiffness.grid
        self._fixed_mean = fixed_mean
        self._push = 0.0 if fixed_mean else pressure * stiffness.area_per_atom
        self._wave_stiffness = 0.5 * contact_modulus * stiffness.area_per_atom * grid.wavenumber
        self._smallest_shift = _SMALLEST_SHIFT * contact_modulus * stiffness.lattice_constant
        self._coefficients = stiffness.coefficients.copy()
        self._coefficients[2, 0, 0] = 0.0  # a load prescribes the block's uniform compression
        self._transform = RealTransform((3, *grid.shape), np.float64)
        self._multiplicity = grid.multiplicity
        self.force = np.empty((3, *grid.shape))

    def start(self, displacement: np.ndarray) -> SamplerState:
        """Begin a chain at a state, best an equilibrium at zero temperature, shape (3, ny, nx) (m)."""
        mass = self.masses(displacement)
        self._transform.field[...] = displacement
        return SamplerState(self._transform.forward().copy(), _FIRST_STEP, mass, evaluations=1)

    def masses(self, displacement: np.ndarray) -> np.ndarray:
        """Return the stiffness of every wave at a state as its mass, shape (3, ny, nx // 2 + 1) (N/m).

        m(q) = ½E*q a² + c, c the interface's mean curvature, positive values only. Along z, where only a share f of the
        surface is in contact, a wave bends between contacts, and c is in series with ½E*q a²/(1 − f).
        """
        hessian = np.empty((6, *displacement.shape[1:]))
        self.interaction.evaluate(displacement, self.force, hessian)
        shift = np.maximum(np.mean(np.maximum(hessian[:3], 0.0), axis=(1, 2)), self._smallest_shift)
        wave = self._wave_stiffness
        free = 1 - float(np.mean(hessian[2] > 0))
        in_series = wave * shift[2] / (wave + free * shift[2] + self._smallest_shift)
        return np.stack([wave + shift[0], wave + shift[1], wave + np.maximum(in_series, _SMALLEST_SHARE * shift[2])])

    def equilibrated(self, state: SamplerState, trajectories: int, generator: np.random.Generator) -> SamplerState:
        """Equilibrate a chain and find its time step.

        From a minimum every trajectory gains energy: the first ones are accepted if their step is stable. Then the step
        follows the acceptance (C. Andrieu, J. Thoms, Stat. Comput. 18, 343 (2008), doi:10.1007/s11222-008-9110-y).
        """
        relaxing = math.ceil(_RELAXING * trajectories)
        unstable = _UNSTABLE * 0.5 * self.thermal_energy * self.force.size
        for _ in range(relaxing):
            found, error = self._trajectory(state, generator)
            finer = max(0.5 * state.time_step, _SMALLEST_STEP)
            state = found if error < unstable else replace(state, time_step=finer, evaluations=found.evaluations)
        logarithms: list[float] = []
        for number in range(1, trajectories - relaxing + 1):
            found, error = self._trajectory(state, generator)
            probability = self._acceptance(error)
            factor = math.exp(_GAIN / math.sqrt(number) * (probability - _ACCEPTANCE))
            accepted = found if generator.random() < probability else state
            time_step = max(factor * state.time_step, _SMALLEST_STEP)
            state = replace(accepted, time_step=time_step, evaluations=found.evaluations)
            logarithms.append(math.log(state.time_step))
        if logarithms:
            time_step = math.exp(float(np.mean(logarithms[len(logarithms) // 2 :])))
            state = replace(state, time_step=max(time_step, _SMALLEST_STEP))
        return state

    def next(self, state: SamplerState, generator: np.random.Generator) -> SamplerState:
        """Return the chain after one trajectory, at the same displacement where the proposal is rejected."""
        found, error = self._trajectory(state, generator)
        accept = generator.random() < self._acceptance(error)
        return replace(
            found if accept else state,
            trajectories=state.trajectories + 1,
            accepted=state.accepted + int(accept),
            evaluations=found.evaluations,
        )

    def displacement(self, state: SamplerState) -> np.ndarray:
        """Return the displacement of every atom (m), shape (3, ny, nx)."""
        return self._real(state.displacement).copy()

    def elastic_energy(self, state: SamplerState) -> float:
        """Return ½ u·Su (J)."""
        return 0.5 * quadratic(state.displacement, self._coefficients, self._multiplicity) / self._transform.points

    def potential_energy(self, state: SamplerState) -> float:
        """Write the forces and return V (J), infinite if an atom is inside the substrate."""
        interaction = self.interaction.evaluate(self._real(state.displacement), self.force)
        return self.elastic_energy(state) + interaction + self._push * float(state.displacement[2, 0, 0].real)

    def velocities(self, state: SamplerState, generator: np.random.Generator) -> np.ndarray:
        """Return the spectrum of velocities drawn from exp(−½ v·Mv/k_BT) (m per unit of time)."""
        self._transform.field[...] = generator.standard_normal(self._transform.shape)
        drawn = self._transform.forward() * np.sqrt(self.thermal_energy / state.mass)
        if self._fixed_mean:
            drawn[2, 0, 0] = 0.0
        return drawn

    def kinetic_energy(self, state: SamplerState, velocity: np.ndarray) -> float:
        """Return ½ v·Mv (J)."""
        weight = self._multiplicity * state.mass
        return 0.5 * float(np.sum(weight * (velocity.real**2 + velocity.imag**2))) / self._transform.points

    def follow(self, state: SamplerState, velocity: np.ndarray, steps: int) -> tuple[SamplerState, np.ndarray, float]:
        """Integrate some steps; return the end's state and velocity and the change of V (J), infinite inside."""
        u, v = state.displacement.copy(), velocity.copy()
        over_mass, kick = 1 / state.mass, _OUTER_KICK
        dt, stages = state.time_step, 2 * steps
        before = self.potential_energy(state)
        for stage in range(stages):
            # Of a step's middle, or of its end and the next one's beginning together.
            inner = 1 - 2 * kick if stage % 2 else 2 * kick
            self._kick(v, u, over_mass, dt * (inner if stage else kick))
            u += 0.5 * dt * v
            if stage + 1 < stages and not np.isfinite(self.interaction.evaluate(self._real(u), self.force)):
                return replace(state, evaluations=state.evaluations + stage + 2), v, np.inf
        found = replace(state, displacement=u, evaluations=state.evaluations + stages + 1)
        after = self.potential_energy(found)
        self._kick(v, u, over_mass, dt * kick)
        return found, v, after - before

    def _trajectory(self, state: SamplerState, generator: np.random.Generator) -> tuple[SamplerState, float]:
        """Return the end of a trajectory of random length with random velocities, and ΔH (J)."""
        velocity = self.velocities(state, generator)
        steps = max(1, round(_TRAJECTORY / state.time_step * generator.uniform(0.5, 1.5)))
        found, reached, change = self.follow(state, velocity, steps)
        return found, change + self.kinetic_energy(state, reached) - self.kinetic_energy(state, velocity)

    def _acceptance(self, error: float) -> float:
        """Return the acceptance probability of a trajectory of ΔH = ``error`` (J)."""
        return math.exp(-max(error, 0.0) / self.thermal_energy) if math.isfinite(error) else 0.0

    def _real(self, spectrum: np.ndarray) -> np.ndarray:
        """Return the field of a spectrum, in the transform's own buffer."""
        np.multiply(spectrum, 1 / self._transform.points, out=self._transform.spectrum)
        return self._transform.backward()

    def _kick(self, velocity: np.ndarray, displacement: np.ndarray, over_mass: np.ndarray, dt: float) -> None:
        """Change a velocity by the forces at a displacement, those of the interface being in ``force``."""
        self._transform.field[...] = self.force
        self._transform.field[2] -= self._push
        force = self._transform.forward()
        if self._fixed_mean:
            force[2, 0, 0] = 0.0
        accelerate(velocity, displacement, force, self._coefficients, over_mass, dt)
