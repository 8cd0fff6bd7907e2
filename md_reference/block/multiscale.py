"""The block with explicit nodes, coarser by factors of two away from its surface.

Level l is a slab of cells of edge 2^l a (C. Yang, U. Tartaglino, B. N. J. Persson, Eur. Phys. J. E 19, 47 (2006)). The
top plane of a level hangs on the lowest plane of the next: its displacements are bilinear in those (the prolongation
P), and its forces go back by Pᵀ, so that the whole is one symmetric stiffness. The highest plane is rigid.
"""

import math
from collections.abc import Callable, Sequence
from functools import partial
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from md_reference.block.nonlinear_slab import move_rotating_slab, rotating_slab_force
from md_reference.block.slab import fill_ghosts, move_slab, prolong, restrict, slab_force
from md_reference.block.verlet import Action, move_plane
from md_reference.parallel_rows import share_rows

# Layers of the finest level and of the coarser ones below the last, fewest nodes of a level along an axis: E*(q) is
# within 0.2 % of the full lattice's.
_FINEST_LAYERS, _LAYERS, _FEWEST_NODES = 12, 8, 4
# Nodes of a plane per task, whose three planes of displacements and the forces stay in the cache, and fewest rows.
_TASK_NODES, _TASK_ROWS = 8192, 8


def level_layers(atoms: tuple[int, int], layers: int) -> tuple[int, ...]:
    """Return the layers of cells of each level, from the surface up, each with half the nodes where it can."""
    counts = [min(layers, _FINEST_LAYERS)]
    left, size = layers - counts[0], 2
    while left >= size and all(n % size == 0 and n // size >= _FEWEST_NODES for n in atoms):
        counts.append(min(_LAYERS, left // size))
        left -= counts[-1] * size
        size *= 2
    for level in reversed(range(len(counts))):  # the rest, in whole layers
        counts[level] += left // 2**level
        left %= 2**level
    return tuple(counts)


def node_count(atoms: tuple[int, int], layers: Sequence[int]) -> int:
    """Return the nodes of a block with these layers on each level, including ghosts and hanging planes."""
    return sum((count + 1) * ((atoms[0] >> n) + 2) * ((atoms[1] >> n) + 2) for n, count in enumerate(layers))


class Level(NamedTuple):
    """One slab of a block: its cells' edge over a, and the shape of its nodes with ghosts."""

    size: int
    shape: tuple[int, int, int, int]


class MultiscaleBlock:
    """Forces and masses of the explicit block; one vector contains all nodes, level after level, with heights along z.

    ``atoms`` are those of the surface along y and x, ``layers`` those of :func:`level_layers`. ``plane_mass`` lists the
    mass of a node of each plane, level by level (kg): its share of the cells above and below, a whole atom at the
    surface. Hanging planes and the rigid one have zero.
    """

    _force_kernel, _move_kernel = staticmethod(slab_force), staticmethod(move_slab)

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
            Level(2**number, (3, count + 1, (atoms[0] >> number) + 2, (atoms[1] >> number) + 2))
            for number, count in enumerate(layers)
        ]
        self._ends = [0, *accumulate(math.prod(level.shape) for level in self.levels)]
        self.size = self._ends[-1]  # of a vector of all nodes
        self._threads = threads
        self.plane_mass = [np.full(level.shape[1], level.size**3 * atom_mass) for level in self.levels]
        for number, mass in enumerate(self.plane_mass):
            mass[-1] = 0.0
            if number:
                mass[0] *= 0.75
        self._inverse_mass = [np.divide(1, mass, np.zeros_like(mass), where=mass > 0) for mass in self.plane_mass]
        # Forces on the lowest and highest plane of each level.
        self._faces = [np.zeros((3, min(level.shape[1], 2), *level.shape[2:])) for level in self.levels]
        size, (_, _, rows, columns) = self.levels[-1]
        # Half of the highest layer of cells moves with the rigid plane.
        self.top_mass = 0.5 * size**3 * atom_mass * ((rows - 2) * (columns - 2))
        self.freedoms = int(np.count_nonzero(self.mass))  # three of every node that moves independently

    @property
    def total_mass(self) -> float:
        """Mass of all nodes and the rigid plane (kg)."""
        pairs = zip(self.levels, self.plane_mass, strict=True)
        return self.top_mass + sum(float(m.sum()) * (at.shape[2] - 2) * (at.shape[3] - 2) for at, m in pairs)

    @property
    def mass(self) -> np.ndarray:
        """Mass of every node for each component (kg), shape (size,); zero for ghosts too."""
        vector = np.zeros(self.size)
        for nodes, mass in zip(self.levels_of(vector), self.plane_mass, strict=True):
            nodes[:, :, 1:-1, 1:-1] = mass[:, None, None]
        return vector

    def levels_of(self, vector: np.ndarray) -> list[np.ndarray]:
        """Return views of each level's nodes, with ghosts, shape (3, planes, ny + 2, nx + 2)."""
        parts = zip(self.levels, self._ends[:-1], self._ends[1:], strict=True)
        return [vector[start:end].reshape(level.shape) for level, start, end in parts]

    def bottom_of(self, vector: np.ndarray) -> np.ndarray:
        """Return a view of the surface's atoms, shape (3, ny, nx)."""
        return self.levels_of(vector)[0][:, 0, 1:-1, 1:-1]

    def top_of(self, vector: np.ndarray) -> np.ndarray:
        """Return a view of the rigid plane, shape (3, ny, nx)."""
        return self.levels_of(vector)[-1][:, -1, 1:-1, 1:-1]

    def nodes_of(self, vector: np.ndarray) -> np.ndarray:
        """Return all nodes without ghosts and hanging planes, shape (3, nodes): the atoms of the surface first."""
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
        """Positions of the nodes of :meth:`nodes_of` over a surface at height zero, shape (3, nodes) (m)."""
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
        """Write the forces on the nodes (N), on the rigid plane its load; fill displaced ghosts and hanging planes."""
        u, f = self.levels_of(displacement), self.levels_of(force)
        for number in reversed(range(len(u))):
            self._fill_level(u, number)
            self._on_rows(number, partial(self._force_kernel, u[number], f[number], *self._constants(number)))
        for number in range(len(u) - 1):
            self._on_rows(number + 1, partial(restrict, f[number], f[number + 1]))
            f[number][:, -1] = 0.0

    def move(
        self, displacement: np.ndarray, moved: np.ndarray, velocity: np.ndarray, surface: np.ndarray, action: Action
    ) -> float:
        """Apply the forces to all nodes but the rigid plane, in one pass over them; return the pull on that plane (N).

        ``displacement`` and ``moved`` are before and after (m); ghosts and hanging planes of the first are filled, the
        rigid plane is copied. ``surface`` are forces from outside on its atoms (N, shape (3, ny, nx)).
        """
        u, new, v = map(self.levels_of, (displacement, moved, velocity))
        faces, mass = self._faces, self._inverse_mass
        first_node = [end // 3 for end in self._ends]
        for number in reversed(range(len(u))):
            self._fill_level(u, number)
            nodes = u[number], new[number], v[number], faces[number], mass[number]
            constants = self._constants(number)
            self._on_rows(number, partial(self._move_kernel, *nodes, action, *constants, first_node[number]))
        for number in range(len(u) - 1):
            self._on_rows(number + 1, partial(restrict, faces[number], faces[number + 1]))
        faces[0][:, 0, 1:-1, 1:-1] += surface
        for number in range(len(u)):
            nodes = u[number], new[number], v[number], faces[number], 0
            given = mass[number][0], action, first_node[number], 0
            self._on_rows(number, lambda first, end: move_plane(*nodes, first + 1, *given, first, end))  # noqa: B023
        new[-1][:, -1] = u[-1][:, -1]
        return float(faces[-1][2, -1, 1:-1, 1:-1].sum())

    def elastic_energy(self, displacement: np.ndarray, force: np.ndarray) -> float:
        """Return ½ u·Ku (J) of a displacement and its forces, for any height of the rigid plane."""
        height = float(np.mean(self.top_of(displacement)[2]))
        total = 0.0
        for u, f in zip(self.levels_of(displacement), self.levels_of(force), strict=True):
            inside = np.s_[:, 1:-1, 1:-1]
            total -= float(np.sum(u[0][inside] * f[0][inside]) + np.sum(u[1][inside] * f[1][inside]))
            total -= float(np.sum((u[2][inside] - height) * f[2][inside]))
        return 0.5 * total

    def compression_energy(self, displacement: np.ndarray) -> float:
        """Return the energy of every layer's mean strain along z, per area (J/m²); hanging planes must be filled."""
        total = 0.0
        for level, u in zip(self.levels, self.levels_of(displacement), strict=True):
            edge = level.size * self.lattice_constant
            strain = np.diff(u[2, :, 1:-1, 1:-1].mean(axis=(1, 2))) / edge
            total += edge * float(np.sum(self._compression_density(strain)))
        return total

    def _compression_density(self, strain: np.ndarray) -> np.ndarray:
        """Return the energy of uniform strain along z, per volume (J/m³)."""
        first, shear = self.lame
        return 0.5 * (first + 2 * shear) * strain**2

    def _constants(self, number: int) -> tuple[float, float, float]:
        """Return the kernels' constants of a level."""
        first, shear = self.lame
        size = 2**number * self.lattice_constant
        # A diagonal spring acts along (1, 1)/√2; a cell's dilatation is a sum of differences over 4a, in force and
        # energy.
        return shear * size, shear * size / 2, (first - shear) * size / 16

    def _on_rows(self, number: int, kernel: Callable[[int, int], object]) -> None:
        """Call ``kernel(first, end)`` for all blocks of rows of a level."""
        _, _, rows, columns = self.levels[number].shape
        share_rows(kernel, rows - 2, max(_TASK_ROWS, _TASK_NODES // columns), self._threads)

    def _fill_level(self, levels: list[np.ndarray], number: int) -> None:
        """Fill a level's hanging plane from the next one and its ghosts."""
        if number + 1 < len(levels):
            self._on_rows(number + 1, partial(prolong, levels[number + 1], levels[number]))
        fill_ghosts(levels[number])


class NonlinearSpringBlock(MultiscaleBlock):
    """A block of central springs and cell volumes at any displacement, whose first order is the linear one."""

    _force_kernel, _move_kernel = staticmethod(rotating_slab_force), staticmethod(move_rotating_slab)

    def elastic_energy(self, displacement: np.ndarray, force: np.ndarray) -> float:
        """Return the elastic energy (J) of a displacement; ``force`` is not read."""
        scratch = np.empty(self.size)
        pairs = zip(self.levels_of(displacement), self.levels_of(scratch), strict=True)
        given = ((u, f, *self._constants(number), 0, u.shape[2] - 2) for number, (u, f) in enumerate(pairs))
        return sum(rotating_slab_force(*each) for each in given)

    def _compression_density(self, strain: np.ndarray) -> np.ndarray:
        first, shear = self.lame
        longer = np.hypot(1, 1 + strain) - math.sqrt(2)  # of the springs across an upright face
        return 0.5 * first * strain**2 + 2 * shear * longer**2

    def _constants(self, number: int) -> tuple[float, float, float]:
        first, shear = self.lame
        return 2**number * self.lattice_constant, shear, first - shear
