"""Contact with a hard wall that yields: the pressure cannot exceed a hardness, and the indentation is permanent.

Points under the hardness H keep their indentation w; the rigid surface of the next step is h − w. A step is that of
:mod:`bem_adhesion.hard_wall.active_set`, unloading is elastic (B. N. J. Persson, J. Chem. Phys. 115, 3840
(2001)), and the work done on the plastic layer is H <w>.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bem_adhesion.contacts.free_boundary import FreeBoundaryContact
from bem_adhesion.hard_wall.contact import HardWallContact
from bem_adhesion.solution import Solution, require_solution
from contact_study.numerics.arguments import step_arguments

MakeWall = Callable[..., HardWallContact | FreeBoundaryContact]


class PlasticContact:
    """One rough surface against an elastic solid with a hardness, for loading and unloading.

    ``make_wall`` makes the hard wall of given heights (m), with the hardness as its bound and the given ``unit``.
    """

    def __init__(self, height: np.ndarray, make_wall: MakeWall):
        self.height = height
        self._make_wall = make_wall
        self._unit = float(height.std()) or None
        wall = make_wall(height)
        self._control = wall.control
        self._untouched = wall.separated()

    def separated(self) -> np.ndarray:
        """Return the state without contact and without indentation, shape (2, …)."""
        return np.broadcast_to(0.0, (2, *self._untouched.shape))

    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """Find the contact at a load, see :meth:`Contact.step`.

        The state, shape (2, …), is the pressure (Pa), which only changes the work, and the indentation so far (m). An
        approach counts from first touch of the surface before it yielded. ``plastic_indentation`` of the solution is
        that of all steps so far. An indentation below zero raises ValueError.
        """
        state, target = step_arguments(self._control, target, state, (2, *self._untouched.shape))
        before = self._indentation(state)
        if before.min() < 0:
            raise ValueError("the state to start from has an indentation < 0")
        wall = self._wall(before)
        if wall.control == "approach":
            target -= float(self.height.max() - (self.height - before).max())
        found = wall.step(state[0], target)
        indentation = before if found.plastic_indentation is None else before + found.plastic_indentation
        kept = np.zeros(self._untouched.shape)
        kept[tuple(map(slice, self.height.shape))] = indentation
        return replace(found, state=np.stack([found.state, kept]), plastic_indentation=indentation)

    def stiffness(self, solution: Solution) -> float:
        """Return −dp/dū of a state on unloading (Pa/m), during which no point yields."""
        require_solution(solution)
        wall = self._wall(self._indentation(solution.state))
        return wall.stiffness(replace(solution, state=solution.state[0]))

    def _wall(self, indentation: np.ndarray) -> HardWallContact | FreeBoundaryContact:
        # The rms height of a surface that is flattened everywhere would be no unit of errors.
        return self._make_wall(self.height - indentation, unit=self._unit)

    def _indentation(self, state: np.ndarray) -> np.ndarray:
        """Return the indentation in a state, without the padding of free boundaries."""
        return state[1][tuple(map(slice, self.height.shape))]
