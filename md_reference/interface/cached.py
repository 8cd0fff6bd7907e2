"""An interface followed from state to state: an atom that has moved little is not evaluated again.

While a front advances all but some tens of atoms stand nearly still, and the interface is most of a step's work. Energy
and force of an atom are therefore expanded to second order about where it was last evaluated,

    E = E₀ − F₀·d + ½ d·H₀d,    F = F₀ − H₀ d,

as long as the next term of the force, ½ T d², is below an error that the caller allows, and |d| below a tenth of r0.
With no error allowed only atoms that have not moved at all are left as they are.

T is bounded by stiffness k and force F that the atom had there. For a layer's law P (s¹¹ − s⁵), s = r0/distance, in
units of P/r0 and P/r0²: k = 11 s¹² − 5 s⁶, and T = 132 s¹³ − 30 s⁷ stays below 17 k⁺ + 60 |F| for s < 1.6.
Where the pairs are taken to zero over the last tenth of the cutoff r_c it is some (r0/r_c)⁵ / (0.1 r_c/r0)².
"""

import math

import numpy as np
from numba import njit

from md_reference.interface.pairs import AtomwiseInteraction

_OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}

_HARD, _SOFT = 17.0, 60.0  # T over k/r0, and over F/r0²
_SWITCHED = 1500.0  # T over P/r0² (r0/r_c)⁷
_FARTHEST = 0.1  # an atom is followed, in units of r0


class CachedInterface:
    """An interface and where each of its atoms was last evaluated.

    Parameters
    ----------
    interaction : AtomwiseInteraction
        The interface.
    shape : tuple of int
        Atoms along y and x.

    Attributes
    ----------
    hessian : numpy.ndarray of float32, shape (6, ny, nx)
        Second derivatives there (N/m), as of :meth:`Interaction.evaluate`.
    evaluations : float
        Done so far, of some atoms counted by their share of all.
    """

    def __init__(self, interaction: AtomwiseInteraction, shape: tuple[int, int]):
        self.hessian = np.zeros((6, *shape), np.float32)
        self.evaluations = 0.0
        self._interaction = interaction
        self._place = np.full((3, *shape), np.inf)  # nowhere
        self._force = np.zeros((3, *shape))
        self._energy = np.zeros(shape)
        self._due = np.empty(shape, dtype=np.bool_)

    def forget(self) -> None:
        """Evaluate every atom next time."""
        self._place.fill(np.inf)

    def evaluate(self, displacement: np.ndarray, force: np.ndarray, error: float = 0.0) -> float:
        """Energy (J), infinite if an atom is inside the substrate.

        Parameters
        ----------
        displacement : numpy.ndarray, shape (3, ny, nx)
            As of :meth:`Interaction.evaluate` (m).
        force : numpy.ndarray, shape (3, ny, nx)
            On each atom, written here (N).
        error : float, optional
            Allowed to a force (N).
        """
        length, cutoff = self._interaction.length, self._interaction.cutoff
        least = _SWITCHED * self._interaction.force_prefactor / length**2 / cutoff**7
        there = self._place, self._force, self.hessian
        count = _mark(displacement, *there, length, least, 2 * error, self._due)
        self.evaluations += count / self._due.size
        results = self._force, self.hessian, self._energy
        if count and not self._interaction.evaluate_some(displacement, self._due, *results):
            self._place[:, self._due] = np.inf
            return math.inf
        return _expand(displacement, *there, self._energy, force)


@njit(**_OPTIONS)
def _mark(displacement, place, force, hessian, length, least, allowed, due):
    """Write which atoms have left where they were evaluated, and put them where they are; returns how many."""
    hardness = _HARD / length
    softness = _SOFT / length**2
    farthest = (_FARTHEST * length) ** 2
    count = 0
    for j in range(due.shape[0]):
        for i in range(due.shape[1]):
            x = displacement[0, j, i] - place[0, j, i]
            y = displacement[1, j, i] - place[1, j, i]
            z = displacement[2, j, i] - place[2, j, i]
            stiffness = hessian[0, j, i] + hessian[1, j, i] + hessian[2, j, i]
            f_x = force[0, j, i]
            f_y = force[1, j, i]
            f_z = force[2, j, i]
            growth = hardness * max(stiffness, 0.0) + softness * np.sqrt(f_x * f_x + f_y * f_y + f_z * f_z) + least
            squared = x * x + y * y + z * z
            left = not (growth * squared <= allowed and squared <= farthest)
            due[j, i] = left
            if left:
                count += 1
                for c in range(3):
                    place[c, j, i] = displacement[c, j, i]
    return count


@njit(**_OPTIONS)
def _expand(displacement, place, force_there, hessian, energy_there, force):
    """Forces by their expansion; returns the energy."""
    total = 0.0
    for j in range(place.shape[1]):
        row = 0.0
        for i in range(place.shape[2]):
            x = displacement[0, j, i] - place[0, j, i]
            y = displacement[1, j, i] - place[1, j, i]
            z = displacement[2, j, i] - place[2, j, i]
            xy = hessian[3, j, i]
            xz = hessian[4, j, i]
            yz = hessian[5, j, i]
            h_x = hessian[0, j, i] * x + xy * y + xz * z
            h_y = xy * x + hessian[1, j, i] * y + yz * z
            h_z = xz * x + yz * y + hessian[2, j, i] * z
            f_x = force_there[0, j, i]
            f_y = force_there[1, j, i]
            f_z = force_there[2, j, i]
            force[0, j, i] = f_x - h_x
            force[1, j, i] = f_y - h_y
            force[2, j, i] = f_z - h_z
            row += energy_there[j, i] - (f_x - 0.5 * h_x) * x - (f_y - 0.5 * h_y) * y - (f_z - 0.5 * h_z) * z
        total += row
    return total
