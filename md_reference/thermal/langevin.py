"""Molecular dynamics of the explicit block over the substrate, with or without a thermostat.

Half a kick, half a drift, damping and noise, half a drift, half a kick (B. Leimkuhler and C. Matthews, J. Chem. Phys.
138, 174102 (2013)): velocity Verlet without damping. The rigid plane that closes the block above moves, too.
"""

from dataclasses import dataclass

import numpy as np
from scipy import constants

from md_reference.block.condensed import CORNERS
from md_reference.block.multiscale import MultiscaleBlock
from md_reference.block.verlet import Action
from md_reference.interface.pairs import LennardJonesInterface

_BRILLOUIN_POINTS = 24  # along each axis, in the search for the fastest wave of the lattice


@dataclass
class Motion:
    """Heights over the substrate, lateral displacements and velocities of all nodes, and the rigid plane."""

    displacement: np.ndarray  # shape (block.size,) (m)
    velocity: np.ndarray  # shape (block.size,) (m/s)
    top: float  # height of the rigid plane (m)
    top_velocity: float  # (m/s)
    time: float = 0.0  # since the motion began (s)


class MolecularDynamics:
    """Block and interface in motion, with a thermostat of a rate of ``damping`` (1/s) and a ``temperature`` (K).

    A ``driven`` rigid plane keeps its velocity; damping then acts on the motion relative to it. After a step
    ``interface_force``, shape (3, ny, nx), is that on the surface's atoms (N).
    """

    def __init__(
        self,
        block: MultiscaleBlock,
        interaction: LennardJonesInterface,
        time_step: float,
        damping: float = 0.0,
        temperature: float = 0.0,
        driven: bool = False,
    ):
        self.block = block
        self.interaction = interaction
        self.time_step = time_step
        self.driven = driven
        self.interaction_energy = 0.0
        self.interface_force = np.empty((3, *block.atoms))
        self._kept = float(np.exp(-damping * time_step))
        self._noise = constants.k * temperature * (1 - self._kept**2)
        self._spare = np.empty(block.size)  # receives the next displacement: neighbours need the former one

    def start(self, displacement: np.ndarray, velocity: float = 0.0) -> Motion:
        """Return a block moving along z (m/s), all planes at the mean height of the surface's atoms (m)."""
        moving, nodes = np.zeros(self.block.size), np.zeros(self.block.size)
        height = float(np.mean(displacement[2]))
        for level, speed in zip(self.block.levels_of(nodes), self.block.levels_of(moving), strict=True):
            level[2] = height
            speed[2] = velocity
        moving *= self.block.mass > 0
        self.block.bottom_of(nodes)[...] = displacement
        return Motion(nodes, moving, height, velocity)

    def move(self, motion: Motion, pressure: float, generator: np.random.Generator, steps: int = 1) -> None:
        """Integrate some time steps, in place, under a mean pressure (Pa), which a driven plane ignores.

        Many steps in one call take half the work of single calls. FloatingPointError if an atom enters the substrate.
        """
        kick = half = 0.5 * self.time_step
        for _ in range(steps):
            # Damping and noise act on all nodes: fast waves of the surface do not reach the coarse levels.
            wind = (1 - self._kept) * motion.top_velocity if self.driven else 0.0
            key = int(generator.integers(2**63)) if self._noise else 0
            self._act(motion, pressure, Action(kick, self._kept, wind, half, self._noise, key), generator)
            kick = self.time_step
        self._act(motion, pressure, Action(half), generator)
        motion.time += steps * self.time_step

    def kinetic_energy(self, motion: Motion) -> float:
        """Return the kinetic energy of all nodes and the rigid plane (J)."""
        return 0.5 * (self._mass_times_square(motion.velocity) + self.block.top_mass * motion.top_velocity**2)

    def elastic_energy(self, motion: Motion) -> float:
        """Return the energy of the block (J)."""
        force = np.zeros(self.block.size)
        self.block.force(motion.displacement, force)
        return self.block.elastic_energy(motion.displacement, force)

    def temperature(self, motion: Motion) -> float:
        """Return the kinetic temperature of the nodes relative to a driven plane (K), by velocities half a kick away.

        Where forces are linear, their mean square is that of equilibrium at any time step; that of velocities at the
        end of a step lacks (ω dt)²/4 of it.
        """
        velocity = motion.velocity
        if self.driven:
            velocity = velocity.copy()
            for nodes in self.block.levels_of(velocity):
                nodes[2, :-1, 1:-1, 1:-1] -= motion.top_velocity
        square_over_mass = 0.0
        for mass, nodes in zip(self.block.plane_mass, self.block.levels_of(self._forces(motion)), strict=True):
            own = nodes[:, mass > 0, 1:-1, 1:-1]
            square_over_mass += float(np.dot(1 / mass[mass > 0], np.einsum("ckji,ckji->k", own, own)))
        twice = self._mass_times_square(velocity) + square_over_mass * (0.5 * self.time_step) ** 2
        return twice / (constants.k * self.block.freedoms)

    def temperature_of_whole(self, motion: Motion) -> float:
        """Return the squared momentum along z over k_B and all mass (K), which the slowest waves along z dominate."""
        return self.momentum(motion) ** 2 / (constants.k * self.block.total_mass)

    def momentum(self, motion: Motion) -> float:
        """Return the momentum along z of all nodes and the rigid plane (kg m/s)."""
        pairs = zip(self.block.plane_mass, self.block.levels_of(motion.velocity), strict=True)
        total = sum(np.dot(mass, v[2].sum(axis=(1, 2))) for mass, v in pairs)
        return float(total) + self.block.top_mass * motion.top_velocity

    def unbalanced(self, motion: Motion) -> float:
        """Return the largest force component on an atom of the surface (N)."""
        return float(np.max(np.abs(self.block.bottom_of(self._forces(motion)))))

    def _mass_times_square(self, velocity: np.ndarray) -> float:
        pairs = zip(self.block.plane_mass, self.block.levels_of(velocity), strict=True)
        return sum(float(np.dot(mass, np.einsum("ckji,ckji->k", v, v))) for mass, v in pairs)

    def _forces(self, motion: Motion) -> np.ndarray:
        """Return the forces of block and substrate on all nodes, after a step (N)."""
        force = np.zeros(self.block.size)
        self.block.force(motion.displacement, force)
        self.block.bottom_of(force)[...] += self.interface_force
        return force

    def _act(self, motion: Motion, pressure: float, action: Action, generator: np.random.Generator) -> None:
        """Apply the forces to all nodes and to the rigid plane."""
        block = self.block
        block.top_of(motion.displacement)[2] = motion.top
        surface = np.ascontiguousarray(block.bottom_of(motion.displacement))
        self.interaction_energy = self.interaction.evaluate(surface, self.interface_force, None)
        if not np.isfinite(self.interaction_energy):
            raise FloatingPointError("an atom ran into the substrate")
        moved = self._spare if action.half else motion.displacement
        pull = block.move(motion.displacement, moved, motion.velocity, self.interface_force, action)
        if action.half:
            motion.displacement, self._spare = moved, motion.displacement
        before = after = motion.top_velocity
        if not self.driven:
            rows, columns = block.atoms
            load = pressure * rows * columns * block.lattice_constant**2
            before += action.kick * (pull - load) / block.top_mass
            after = action.kept * before
            if action.noise:
                after += float(generator.standard_normal()) * np.sqrt(action.noise / block.top_mass)
        motion.top_velocity = after
        motion.top += action.half * (before + after)


def fastest_wave(element: np.ndarray, atom_mass: float) -> float:
    """Return the largest angular frequency of the unbounded lattice (1/s), from its element matrix (N/m) and kg."""
    # Frequencies are symmetric in every component of the wavevector.
    phase = np.linspace(0, np.pi, _BRILLOUIN_POINTS + 1)
    waves = np.stack(np.meshgrid(phase, phase, phase, indexing="ij"), axis=-1).reshape(-1, 3)
    shift = np.exp(1j * waves @ CORNERS.T)  # (waves, 8)
    blocks = element.reshape(8, 3, 8, 3)
    dynamical = np.einsum("wp,pcqd,wq->wcd", shift.conj(), blocks, shift)
    return float(np.sqrt(np.max(np.linalg.eigvalsh(dynamical)) / atom_mass))
