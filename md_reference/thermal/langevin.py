"""Newtonian motion of the explicit block over the substrate, with or without a thermostat.

Velocity Verlet; with friction the splitting of B. Leimkuhler and C. Matthews (J. Chem. Phys. 138, 174102 (2013)): half
a kick, half a drift, friction and noise, half a drift, half a kick, which is velocity Verlet without friction and whose
positions err little at any. The rigid plane that closes the block above moves up and down under the pressure and the
block's own force.
"""

from dataclasses import dataclass

import numpy as np
from scipy import constants

from md_reference.block.multiscale import MultiscaleBlock
from md_reference.block.verlet import Action
from md_reference.interface.pairs import Interaction

_BRILLOUIN_POINTS = 24  # along each axis, where the fastest wave of the lattice is looked for


@dataclass
class Motion:
    """Where all nodes are and how fast.

    Attributes
    ----------
    displacement, velocity : numpy.ndarray, shape (block.size,)
        Of every node, along z heights over the substrate (m, m/s).
    top, top_velocity : float
        Of the rigid plane (m, m/s).
    time : float
        Since the motion began (s).
    """

    displacement: np.ndarray
    velocity: np.ndarray
    top: float
    top_velocity: float
    time: float = 0.0


class MolecularDynamics:
    """The block and the interface in motion, owner of the forces.

    Parameters
    ----------
    block : MultiscaleBlock
        The nodes.
    interaction : Interaction
        Of its bottom layer.
    time_step : float
        Of velocity Verlet (s).
    friction : float
        Rate at which the thermostat takes momentum (1/s); zero for none.
    temperature : float
        That the thermostat's noise gives back (K).
    driven : bool
        Whether the rigid plane keeps the velocity that its motion is given, whatever pulls at it. Friction then acts
        on the motion against the plane: a bath that stays behind would drag at the whole block.

    Attributes
    ----------
    interface_force : numpy.ndarray, shape (3, ny, nx)
        Of the substrate on the surface's atoms, after a step (N).
    interaction_energy : float
        After a step (J).
    """

    def __init__(
        self,
        block: MultiscaleBlock,
        interaction: Interaction,
        time_step: float,
        friction: float = 0.0,
        temperature: float = 0.0,
        driven: bool = False,
    ):
        self.block = block
        self.interaction = interaction
        self.time_step = time_step
        self.driven = driven
        self.interaction_energy = 0.0
        self.interface_force = np.empty((3, *block.atoms))
        self._half_kick = 0.5 * time_step
        self._kept = float(np.exp(-friction * time_step))
        self._noise = constants.k * temperature * (1 - self._kept**2)
        # Where the nodes go in a step: neighbours need where they were.
        self._spare = np.empty(block.size)

    def start(self, displacement: np.ndarray, velocity: float = 0.0) -> Motion:
        """A block whose planes all have the height of its mean surface, moving as a whole.

        Parameters
        ----------
        displacement : numpy.ndarray, shape (3, ny, nx)
            Of the surface's atoms (m).
        velocity : float, optional
            Along z (m/s).
        """
        moving = np.zeros(self.block.size)
        nodes = np.zeros(self.block.size)
        height = float(np.mean(displacement[2]))
        for level, speed in zip(self.block.levels_of(nodes), self.block.levels_of(moving), strict=True):
            level[2] = height
            speed[2] = velocity
        moving *= self.block.mass > 0
        self.block.bottom_of(nodes)[...] = displacement
        return Motion(nodes, moving, height, velocity)

    def move(self, motion: Motion, pressure: float, generator: np.random.Generator, steps: int = 1) -> None:
        """Some time steps, in place, under a mean pressure (Pa), which a driven plane does not feel.

        From the end of a step to the middle of the next is one pass over the nodes, so that many steps at once take
        half the work of as many by themselves.

        Raises
        ------
        FloatingPointError
            If an atom came to lie inside the substrate.
        """
        half = 0.5 * self.time_step
        kick = half
        for _ in range(steps):
            self._act(motion, pressure, self._through(motion, kick, generator), generator)
            kick = self.time_step
        self._act(motion, pressure, Action(half), generator)
        motion.time += steps * self.time_step

    def kinetic_energy(self, motion: Motion) -> float:
        """Of all nodes and the rigid plane (J)."""
        return 0.5 * (self._mass_times_square(motion.velocity) + self.block.top_mass * motion.top_velocity**2)

    def elastic_energy(self, motion: Motion) -> float:
        """Of the block (J)."""
        force = np.zeros(self.block.size)
        self.block.force(motion.displacement, force)
        return self.block.elastic_energy(motion.displacement, force)

    def temperature(self, motion: Motion) -> float:
        """Kinetic temperature of the nodes, against a driven plane (K).

        Of the velocities half a kick before and after the step's end: a thermostat gives these the mean square of
        equilibrium at any time step, where forces are linear. Those of the step's end itself lack (ω dt)²/4 of it.
        """
        velocity = motion.velocity
        if self.driven:
            velocity = velocity.copy()
            for nodes in self.block.levels_of(velocity):
                nodes[2, :-1, 1:-1, 1:-1] -= motion.top_velocity
        twice = self._mass_times_square(velocity) + self._square_over_mass(self._forces(motion)) * self._half_kick**2
        return twice / (constants.k * self.block.freedoms)

    def temperature_of_whole(self, motion: Motion) -> float:
        """Square of the momentum along z over k_B and all mass (K): in equilibrium the temperature on average.

        The slowest waves along z, in which a block rings after an impact, make nearly all of it.
        """
        return self.momentum(motion) ** 2 / (constants.k * self.block.total_mass)

    def momentum(self, motion: Motion) -> float:
        """Along z, of everything that moves (kg m/s)."""
        pairs = zip(self.block.plane_mass, self.block.levels_of(motion.velocity), strict=True)
        total = sum(np.dot(mass, v[2].sum(axis=(1, 2))) for mass, v in pairs)
        return float(total) + self.block.top_mass * motion.top_velocity

    def _mass_times_square(self, velocity: np.ndarray) -> float:
        pairs = zip(self.block.plane_mass, self.block.levels_of(velocity), strict=True)
        return sum(float(np.dot(mass, np.einsum("ckji,ckji->k", v, v))) for mass, v in pairs)

    def _square_over_mass(self, force: np.ndarray) -> float:
        """Σ f²/m over the nodes that move on their own."""
        inside = np.s_[:, :, 1:-1, 1:-1]
        total = 0.0
        for mass, nodes in zip(self.block.plane_mass, self.block.levels_of(force), strict=True):
            own = nodes[inside][:, mass > 0]
            total += float(np.dot(1 / mass[mass > 0], np.einsum("ckji,ckji->k", own, own)))
        return total

    def unbalanced(self, motion: Motion) -> float:
        """Largest force left on an atom of the surface (N)."""
        return float(np.max(np.abs(self.block.bottom_of(self._forces(motion)))))

    def _forces(self, motion: Motion) -> np.ndarray:
        """Of block and substrate on all nodes, after a step (N)."""
        force = np.zeros(self.block.size)
        self.block.force(motion.displacement, force)
        self.block.bottom_of(force)[...] += self.interface_force
        return force

    def _through(self, motion: Motion, kick: float, generator: np.random.Generator) -> Action:
        """From a kick to the end of the way, with friction and noise in its middle, on all nodes.

        A thermostat of the coarse levels alone would not reach the surface: its fast waves do not run there.
        """
        wind = (1 - self._kept) * motion.top_velocity if self.driven else 0.0
        key = int(generator.integers(2**63)) if self._noise else 0
        return Action(kick, self._kept, wind, 0.5 * self.time_step, self._noise, key)

    def _act(self, motion: Motion, pressure: float, action: Action, generator: np.random.Generator) -> None:
        """Let the forces of where all nodes are act on them and on the rigid plane."""
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
    """Largest angular frequency of the unbounded lattice (1/s), from its element matrix.

    Parameters
    ----------
    element : numpy.ndarray, shape (24, 24)
        Stiffness of a cell (N/m), see :func:`md_reference.block.condensed.isotropic_element`.
    atom_mass : float
        Of an atom (kg).
    """
    corners = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    # Frequencies are symmetric in every component of the wavevector.
    phase = np.linspace(0, np.pi, _BRILLOUIN_POINTS + 1)
    waves = np.stack(np.meshgrid(phase, phase, phase, indexing="ij"), axis=-1).reshape(-1, 3)
    shift = np.exp(1j * waves @ corners.T)  # (waves, 8)
    blocks = element.reshape(8, 3, 8, 3)
    dynamical = np.einsum("wp,pcqd,wq->wcd", shift.conj(), blocks, shift)
    return float(np.sqrt(np.max(np.linalg.eigvalsh(dynamical)) / atom_mass))
