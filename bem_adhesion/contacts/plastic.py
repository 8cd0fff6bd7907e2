"""Contact with a hard wall that yields: the pressure cannot exceed a hardness, and what has given way stays.

Points under the hardness H are indented by whatever the load asks for and keep the indentation w, no matter which of
the two bodies it is in; the rigid surface of the next step is h − w. Within a step w grows only where p = H, so that
the step is one convex problem, see :mod:`bem_adhesion.hard_wall.plastic_active_set`, and its solution the only one: an
elastic-perfectly plastic contact, as in Persson's theory of elastoplastic contact (B. N. J. Persson, J. Chem. Phys.
115, 3840 (2001)). Unloading is elastic, and so is loading again up to the same load. The work done on the plastic layer
is H <w>: a point yields at the pressure H from beginning to end.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bem_adhesion.contacts.free_boundary import FreeBoundaryContact
from bem_adhesion.hard_wall.contact import HardWallContact
from bem_adhesion.solution import Solution
from contact_study.numerics.arguments import step_arguments

MakeWall = Callable[..., HardWallContact | FreeBoundaryContact]


class PlasticContact:
    """One rough surface against an elastic solid with a hardness, to be loaded and unloaded.

    Parameters
    ----------
    height : numpy.ndarray, shape (y, x)
        Heights of the undeformed rigid surface, toward the solid (m).
    make_wall : callable
        The hard wall of given heights, with the hardness as its bound; takes the keyword ``unit`` of
        :class:`HardWallContact`.
    """

    def __init__(self, height: np.ndarray, make_wall: MakeWall):
        self.height = height
        self._make_wall = make_wall
        self._unit = float(height.std()) or None
        wall = make_wall(height)
        self._control = wall.control
        self._untouched = wall.separated()

    def separated(self) -> np.ndarray:
        """The state without contact and without indentation, shape (2, …)."""
        return np.broadcast_to(0.0, (2, *self._untouched.shape))

    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """The contact at a load that follows a state.

        Parameters
        ----------
        state : numpy.ndarray, shape (2, …), or Solution
            The solution of the step before, its ``state``, or :meth:`separated`: its pressure (Pa) and the indentation
            that it leaves (m), the second deciding, the first a matter of work alone.
        target : float
            Mean pressure, mean gap or approach, as the hard wall takes it; the approach from first touch of the
            surface before it yielded.

        Returns
        -------
        Solution
            ``plastic_indentation`` is that of all steps so far.

        Raises
        ------
        ValueError
            As the hard wall's; also if an indentation of the state is negative.
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
        """−dp/dū of a state when it is unloaded (Pa/m): no touching point gives way for good."""
        wall = self._wall(self._indentation(solution.state))
        return wall.stiffness(replace(solution, state=solution.state[0]))

    def _wall(self, indentation: np.ndarray) -> HardWallContact | FreeBoundaryContact:
        # Of a surface that is flattened all over the rms height would be no unit to measure errors in.
        return self._make_wall(self.height - indentation, unit=self._unit)

    def _indentation(self, state: np.ndarray) -> np.ndarray:
        """What a state says of the surface, without the padding of free boundaries."""
        return state[1][tuple(map(slice, self.height.shape))]
