"""The block with explicit nodes, coarser by factors of two away from its surface.

Level l is a slab of cells of edge 2^l a with the element of level 0: near the surface every atom, further up what long
waves need (C. Yang, U. Tartaglino, B. N. J. Persson, Eur. Phys. J. E 19, 47 (2006)). The top plane of a level hangs on
the lowest plane of the next: its displacements are bilinear in those (the prolongation P), and its forces go back by
Pᵀ, so that the whole is one symmetric stiffness. The highest plane is rigid.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import accumulate

import numpy as np

from md_reference.block.level_coupling import prolong, restrict
from md_reference.block.nonlinear_slab import move_rotating_slab, rotating_slab_force
from md_reference.block.slab import fill_ghosts, move_slab, slab_constants, slab_force
from md_reference.block.verlet import Action, move_planes
from md_reference.parallel_rows import ParallelRows

# Layers of the finest level and of the coarser ones below the last: E*(q) within 0.2 % of the full lattice's.
_FINEST_LAYERS = 12
_LAYERS = 8
_FEWEST_NODES = 4  # of a level along an axis
_NODES_OF_A_BLOCK = 8192  # of a plane, done in one go: three planes of displacements and the forces stay in the cache
_FEWEST_ROWS = 8


def level_layers(atoms: tuple[int, int], layers: int) -> tuple[int, ...]:
    """Layers of cells of each level, from the surface up, that together are as thick as ``layers`` of atoms.

    Parameters
    ----------
    atoms : tuple of int
        Atoms of the surface along y and x; a level has half as many nodes as the one below, where that is a number.
    layers : int
        Thickness of the block over the lattice constant.
    """
    counts = [min(layers, _FINEST_LAYERS)]
    left = layers - counts[0]
    while left:
        level = len(counts)
        size = 2**level
        possible = all(n % size == 0 and n // size >= _FEWEST_NODES for n in atoms)
        if not possible or left < size:
            # What is left goes to the levels that are there, in whole layers, the coarsest first.
            for lower in reversed(range(level)):
                counts[lower] += left // 2**lower
                left %= 2**lower
        else:
            counts.append(min(_LAYERS, left // size))
            left -= counts[-1] * size
    return tuple(counts)


def node_count(atoms: tuple[int, int], layers: Sequence[int]) -> int:
    """Nodes of a block with these layers on each level, ghosts and hanging planes among them."""
    rows, columns = atoms
    return sum((count + 1) * ((rows >> n) + 2) * ((columns >> n) + 2) for n, count in enumerate(layers))


@dataclass(frozen=True)
class Level:
    """One slab of a block: its cells' edge over a, and the shape of its nodes with ghosts."""

    size: int
    shape: tuple[int, int, int, int]
    constants: tuple[float, float, float]


class MultiscaleBlock:
    """Forces and masses of the explicit block.

    All nodes stand in one vector, level after level; :meth:`levels_of` gives the views of shape (3, planes, ny + 2,
    nx + 2). Displacements along z are heights: only differences count.

    Parameters
    ----------
    atoms : tuple of int
        Atoms of the surface along y and x.
    lattice_constant : float
        a (m).
    first_lame, shear_modulus : float
        λ and μ (Pa).
    layers : sequence of int
        Layers of cells of each level, see :func:`level_layers`.
    atom_mass : float
        Of an atom (kg).
    threads : int, optional
        That share the rows.

    Attributes
    ----------
    plane_mass : list of numpy.ndarray, each of shape (planes,)
        Of a node of each plane of each level (kg); zero for planes that do not move on their own.
    """

    def __init__(
        self,
        atoms: tuple[int, int],
        lattice_constant: float,
        first_lame: float,
        shear_modulus: float,
        layers: Sequence[int],
        atom_mass: float,
        threads: int = 1,
    ):
        self.atoms = atoms
        self.lattice_constant = lattice_constant
        self.lame = first_lame, shear_modulus
        self.thickness = lattice_constant * sum(count * 2**number for number, count in enumerate(layers))
        self.levels = [
            Level(
                2**number,
                (3, count + 1, (atoms[0] >> number) + 2, (atoms[1] >> number) + 2),
                slab_constants(2**number * lattice_constant, first_lame, shear_modulus),
            )
            for number, count in enumerate(layers)
        ]
        self._ends = [0, *accumulate(math.prod(level.shape) for level in self.levels)]
        self._rows = ParallelRows(threads)
        self.plane_mass = [self._plane_mass(number, atom_mass) for number in range(len(self.levels))]
        with np.errstate(divide="ignore"):
            self._inverse_mass = [np.where(mass > 0, 1 / mass, 0.0) for mass in self.plane_mass]
        # Forces on the lowest and highest plane of each level.
        self._faces = [np.zeros((3, min(level.shape[1], 2), *level.shape[2:])) for level in self.levels]
        last = self.levels[-1]
        # Half of the highest layer of cells moves with the rigid plane.
        self.top_mass = 0.5 * last.size**3 * atom_mass * (last.shape[2] - 2) * (last.shape[3] - 2)

    @property
    def size(self) -> int:
        """Length of a vector of all nodes."""
        return self._ends[-1]

    @property
    def freedoms(self) -> int:
        """Nodes that move on their own, times three."""
        total = 0
        for level, mass in zip(self.levels, self.plane_mass, strict=True):
            _, _, rows, columns = level.shape
            total += 3 * int(np.count_nonzero(mass)) * (rows - 2) * (columns - 2)
        return total

    @property
    def total_mass(self) -> float:
        """Of all nodes and the rigid plane (kg)."""
        pairs = zip(self.levels, self.plane_mass, strict=True)
        nodes = sum(float(mass.sum()) * (level.shape[2] - 2) * (level.shape[3] - 2) for level, mass in pairs)
        return nodes + self.top_mass

    @property
    def mass(self) -> np.ndarray:
        """Mass of every node for each component (kg), shape (size,); zero for ghosts too, see :attr:`plane_mass`."""
        vector = np.zeros(self.size)
        for nodes, mass in zip(self.levels_of(vector), self.plane_mass, strict=True):
            nodes[:, :, 1:-1, 1:-1] = mass[:, None, None]
        return vector

    def levels_of(self, vector: np.ndarray) -> list[np.ndarray]:
        """The nodes of each level in a vector, with ghosts, shape (3, planes, ny + 2, nx + 2)."""
        return [self._level(vector, number) for number in range(len(self.levels))]

    def bottom_of(self, vector: np.ndarray) -> np.ndarray:
        """The atoms of the surface in a vector, shape (3, ny, nx)."""
        return self._level(vector, 0)[:, 0, 1:-1, 1:-1]

    def top_of(self, vector: np.ndarray) -> np.ndarray:
        """The rigid plane in a vector, shape (3, ny, nx)."""
        return self._level(vector, len(self.levels) - 1)[:, -1, 1:-1, 1:-1]

    def nodes_of(self, vector: np.ndarray) -> np.ndarray:
        """All nodes of a vector without ghosts and hanging planes, shape (3, nodes): the atoms of the surface first."""
        *lower, last = self.levels_of(vector)
        own = [*(nodes[:, :-1] for nodes in lower), last]
        return np.concatenate([nodes[:, :, 1:-1, 1:-1].reshape(3, -1) for nodes in own], axis=1)

    @property
    def node_levels(self) -> np.ndarray:
        """Level of each node of :meth:`nodes_of`, shape (nodes,)."""
        vector = np.zeros(self.size)
        for number, nodes in enumerate(self.levels_of(vector)):
            nodes[...] = number
        return self.nodes_of(vector)[0].astype(np.int32)

    @property
    def node_masses(self) -> np.ndarray:
        """Mass of each node of :meth:`nodes_of`, the rigid plane shared by its own (kg), shape (nodes,)."""
        vector = self.mass
        plane = self.top_of(vector)
        plane[...] = self.top_mass / plane[0].size
        return self.nodes_of(vector)[0]

    @property
    def rest_positions(self) -> np.ndarray:
        """Where the nodes of :meth:`nodes_of` stand over a surface at height zero, shape (3, nodes) (m)."""
        vector = np.zeros(self.size)
        floor = 0.0
        for level, nodes in zip(self.levels, self.levels_of(vector), strict=True):
            edge = level.size * self.lattice_constant
            _, planes, rows, columns = level.shape
            nodes[0] = edge * (np.arange(columns) - 1)
            nodes[1] = edge * (np.arange(rows) - 1)[:, None]
            nodes[2] = floor + edge * np.arange(planes)[:, None, None]
            floor += edge * (planes - 1)
        return self.nodes_of(vector)

    def force(self, displacement: np.ndarray, force: np.ndarray) -> None:
        """Write the block's forces on its nodes (N); those of the rigid plane are what it has to carry.

        Parameters
        ----------
        displacement, force : numpy.ndarray, shape (size,)
            Ghosts and hanging planes of ``displacement`` are filled; those of ``force`` mean nothing.
        """
        u, f = self.levels_of(displacement), self.levels_of(force)
        for number in reversed(range(len(u))):
            self._hang(u, number)
            self._slab_force(number, u[number], f[number])
        for number in range(len(u) - 1):
            self.on_rows(number + 1, partial(restrict, f[number], f[number + 1]))
            f[number][:, -1] = 0.0

    def move(
        self,
        displacement: np.ndarray,
        moved: np.ndarray,
        velocity: np.ndarray,
        surface_force: np.ndarray,
        action: Action,
    ) -> float:
        """Let the forces act on all nodes but the rigid plane, in one pass over them.

        Parameters
        ----------
        displacement, moved : numpy.ndarray, shape (size,)
            Before and after (m); ghosts and hanging planes of the first are filled, the rigid plane is copied.
        velocity : numpy.ndarray, shape (size,)
            In m/s, in place.
        surface_force : numpy.ndarray, shape (3, ny, nx)
            From outside on the atoms of the surface (N).
        action : Action
            What a force does.

        Returns
        -------
        float
            Force of the block on the rigid plane along z (N).
        """
        u, new, v = map(self.levels_of, (displacement, moved, velocity))
        for number in reversed(range(len(u))):
            self._hang(u, number)
            self._move_inside(number, u[number], new[number], v[number], action)
        faces = self._faces
        for number in range(len(u) - 1):
            self.on_rows(number + 1, partial(restrict, faces[number], faces[number + 1]))
        faces[0][:, 0, 1:-1, 1:-1] += surface_force
        for number, mass in enumerate(self._inverse_mass):
            if mass[0]:
                nodes = u[number], new[number], v[number], faces[number]
                self.on_rows(number, partial(move_planes, *nodes, mass, action, self._first_node(number), 0, 1))
        new[-1][:, -1] = u[-1][:, -1]
        return float(faces[-1][2, -1, 1:-1, 1:-1].sum())

    def elastic_energy(self, displacement: np.ndarray, force: np.ndarray) -> float:
        """½ u·Ku (J) of a displacement and its forces; the rigid plane's part is exact for any height of the whole."""
        height = float(np.mean(self.top_of(displacement)[2]))
        total = 0.0
        for u, f in zip(self.levels_of(displacement), self.levels_of(force), strict=True):
            inside = np.s_[:, 1:-1, 1:-1]
            total -= float(np.sum(u[0][inside] * f[0][inside]) + np.sum(u[1][inside] * f[1][inside]))
            total -= float(np.sum((u[2][inside] - height) * f[2][inside]))
        return 0.5 * total

    def compression_energy(self, displacement: np.ndarray) -> float:
        """Energy of the mean strain of every layer along z, per area (J/m²); of a displacement with hanging planes."""
        total = 0.0
        for level, u in zip(self.levels, self.levels_of(displacement), strict=True):
            edge = level.size * self.lattice_constant
            strain = np.diff(u[2, :, 1:-1, 1:-1].mean(axis=(1, 2))) / edge
            total += edge * float(np.sum(self._compression_density(strain)))
        return total

    def _compression_density(self, strain: np.ndarray) -> np.ndarray:
        """Energy of a uniform strain along z, per volume (J/m³)."""
        first, shear = self.lame
        return 0.5 * (first + 2 * shear) * strain**2

    def on_rows(self, number: int, kernel: Callable[[int, int], object]) -> None:
        """Call ``kernel(first, end)`` for all blocks of rows of a level, see :class:`ParallelRows`."""
        _, _, rows, columns = self.levels[number].shape
        self._rows.run(kernel, rows - 2, max(_FEWEST_ROWS, _NODES_OF_A_BLOCK // columns))

    def _level(self, vector: np.ndarray, number: int) -> np.ndarray:
        return vector[self._ends[number] : self._ends[number + 1]].reshape(self.levels[number].shape)

    def _hang(self, levels: list[np.ndarray], number: int) -> None:
        """Fill a level's hanging plane from the next one and its ghosts."""
        if number + 1 < len(levels):
            self.on_rows(number + 1, partial(prolong, levels[number + 1], levels[number]))
        fill_ghosts(levels[number])

    def _first_node(self, number: int) -> int:
        """Number of a level's first node, ghosts counted."""
        return self._ends[number] // 3

    def _move_inside(
        self, number: int, displacement: np.ndarray, moved: np.ndarray, velocity: np.ndarray, action: Action
    ) -> None:
        """Move the planes of one level but the lowest and highest, whose forces go to :attr:`_faces`."""
        nodes = displacement, moved, velocity, self._faces[number], self._inverse_mass[number]
        constants = self.levels[number].constants
        self.on_rows(number, partial(move_slab, *nodes, action, *constants, self._first_node(number)))

    def _slab_force(self, number: int, displacement: np.ndarray, force: np.ndarray) -> None:
        """Write the forces of one level's cells on its nodes, ghosts filled."""
        self.on_rows(number, partial(slab_force, displacement, force, *self.levels[number].constants))

    def _plane_mass(self, number: int, atom_mass: float) -> np.ndarray:
        """Mass of a node of each plane of a level (kg).

        A node stands for its share of the cells above and below; where two levels meet for half a layer of each. An
        atom of the surface is a whole one. Hanging planes and the rigid one have none.
        """
        level = self.levels[number]
        mass = np.full(level.shape[1], level.size**3 * atom_mass)
        mass[-1] = 0.0
        if number:
            mass[0] *= 0.75
        return mass


class NonlinearSpringBlock(MultiscaleBlock):
    """As :class:`MultiscaleBlock`, of central springs and cell volumes at any displacement.

    The levels, their masses and how they hang together are those of the linear block: a plane's bilinear values are
    exact for what is turned as a whole.
    """

    def elastic_energy(self, displacement: np.ndarray, force: np.ndarray) -> float:
        """Elastic energy (J) of a displacement; ``force`` is not needed, see the base class."""
        scratch = np.empty(self.size)
        pairs = zip(self.levels, self.levels_of(displacement), self.levels_of(scratch), strict=True)
        return sum(rotating_slab_force(u, f, *self._constants(level), 0, u.shape[2] - 2) for level, u, f in pairs)

    def _compression_density(self, strain: np.ndarray) -> np.ndarray:
        first, shear = self.lame
        longer = np.hypot(1, 1 + strain) - math.sqrt(2)  # of the springs across a face that stands upright
        return 0.5 * first * strain**2 + 2 * shear * longer**2

    def _move_inside(
        self, number: int, displacement: np.ndarray, moved: np.ndarray, velocity: np.ndarray, action: Action
    ) -> None:
        nodes = displacement, moved, velocity, self._faces[number], self._inverse_mass[number]
        constants = self._constants(self.levels[number])
        self.on_rows(number, partial(move_rotating_slab, *nodes, action, *constants, self._first_node(number)))

    def _slab_force(self, number: int, displacement: np.ndarray, force: np.ndarray) -> None:
        constants = self._constants(self.levels[number])
        self.on_rows(number, partial(rotating_slab_force, displacement, force, *constants))

    def _constants(self, level: Level) -> tuple[float, float, float]:
        """Edge of a cell (m), μ and λ − μ (Pa)."""
        first, shear = self.lame
        return level.size * self.lattice_constant, shear, first - shear
