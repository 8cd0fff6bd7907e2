"""An interface evaluated again only where atoms have moved: all but some tens while a contact edge advances.

The others are expanded to second order about their last evaluation, as long as the next term of the force, ½ T d², is
below an error that the caller allows, and |d| below a tenth of r0. Stiffness k and force F of the atom bound T: for a
layer's law F = P (s¹¹ − s⁵), s = r0/distance, k = 11 s¹² − 5 s⁶ and T = 132 s¹³ − 30 s⁷ in units of P/r0 and P/r0², and
T stays below 17 k⁺ + 60 |F| for s < 1.6. Where the pairs are taken to zero over the last tenth of the cutoff r_c it is
some (r0/r_c)⁵ / (0.1 r_c/r0)².
"""

import math

import numpy as np

from contact_study.numerics.kernel import kernel
from md_reference.interface.pairs import LennardJonesInterface

# Bounds of T, see above: over k/r0, over F/r0², and over P/r0² (r0/r_c)⁷; and the largest move that is expanded (r0).
_HARD, _SOFT, _SWITCHED, _FARTHEST = 17.0, 60.0, 1500.0, 0.1


class CachedInterface:
    """An interface with the last evaluation of each of its atoms.

    ``hessian``, float32, has the second derivatives there (N/m); ``evaluations`` counts those of some atoms by share.
    """

    def __init__(self, interaction: LennardJonesInterface, shape: tuple[int, int]):
        self.hessian = np.zeros((6, *shape), np.float32)
        self.evaluations = 0.0
        self._interaction = interaction
        self._position = np.full((3, *shape), np.inf)  # of no evaluation yet
        self._force = np.zeros((3, *shape))
        self._energy = np.zeros(shape)
        self._due = np.empty(shape, dtype=np.bool_)

    def forget(self) -> None:
        """Evaluate every atom next time."""
        self._position.fill(np.inf)

    def evaluate(self, displacement: np.ndarray, force: np.ndarray, error: float = 0.0) -> float:
        """Write the force on each atom, off by at most ``error`` (N); return the energy (J), infinite inside."""
        length, cutoff = self._interaction.length, self._interaction.cutoff
        least = _SWITCHED * self._interaction.force_prefactor / length**2 / cutoff**7
        there = self._position, self._force, self.hessian
        limits = _HARD / length, _SOFT / length**2, least, (_FARTHEST * length) ** 2
        count = _mark(displacement, *there, *limits, 2 * error, self._due)
        self.evaluations += count / self._due.size
        results = self._force, self.hessian, self._energy
        if count and not self._interaction.evaluate_some(displacement, self._due, *results):
            self._position[:, self._due] = np.inf
            return math.inf
        return _expand(displacement, *there, self._energy, force)


@kernel
def _mark(displacement, position, force, hessian, hardness, softness, least, farthest, allowed, due):
    """Write which atoms are too far from their last evaluation, and update its position; return how many."""
    count = 0
    for j in range(due.shape[0]):
        for i in range(due.shape[1]):
            x = displacement[0, j, i] - position[0, j, i]
            y = displacement[1, j, i] - position[1, j, i]
            z = displacement[2, j, i] - position[2, j, i]
            stiffness = hessian[0, j, i] + hessian[1, j, i] + hessian[2, j, i]
            f_x, f_y, f_z = force[0, j, i], force[1, j, i], force[2, j, i]
            growth = hardness * max(stiffness, 0.0) + softness * np.sqrt(f_x * f_x + f_y * f_y + f_z * f_z) + least
            squared = x * x + y * y + z * z
            left = not (growth * squared <= allowed and squared <= farthest)
            due[j, i] = left
            if left:
                count += 1
                for c in range(3):
                    position[c, j, i] = displacement[c, j, i]
    return count


@kernel
def _expand(displacement, position, force_there, hessian, energy_there, force):
    """Write the forces by their expansion; return the energy."""
    total = 0.0
    for j in range(position.shape[1]):
        row = 0.0
        for i in range(position.shape[2]):
            x = displacement[0, j, i] - position[0, j, i]
            y = displacement[1, j, i] - position[1, j, i]
            z = displacement[2, j, i] - position[2, j, i]
            xy, xz, yz = hessian[3, j, i], hessian[4, j, i], hessian[5, j, i]
            h_x = hessian[0, j, i] * x + xy * y + xz * z
            h_y = xy * x + hessian[1, j, i] * y + yz * z
            h_z = xz * x + yz * y + hessian[2, j, i] * z
            f_x, f_y, f_z = force_there[0, j, i], force_there[1, j, i], force_there[2, j, i]
            force[0, j, i] = f_x - h_x
            force[1, j, i] = f_y - h_y
            force[2, j, i] = f_z - h_z
            row += energy_there[j, i] - (f_x - 0.5 * h_x) * x - (f_y - 0.5 * h_y) * y - (f_z - 0.5 * h_z) * z
        total += row
    return total
