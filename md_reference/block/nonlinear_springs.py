"""The explicit block with springs that turn with their atoms: what the linear block is the first order of."""

import math
from functools import partial

import numpy as np

from md_reference.block.multiscale import Level, MultiscaleBlock
from md_reference.block.nonlinear_slab import move_rotating_slab, rotating_slab_force
from md_reference.block.verlet import Action


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
