"""Contact with a hardness: steps of a contact whose surface each step indents permanently."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from bem_adhesion.solution import Solution, require_solution
from contact_study.numerics.arguments import step_arguments


class PlasticContact:
    """One rough surface against an elastic solid with a hardness H, for loading and unloading.

    Points under H keep their indentation w; the rigid surface of the next step is h − w, and unloading is elastic
    (B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001)). ``make`` makes the contact of given heights, whose steps find
    what yields in them.
    """

    def __init__(self, height: np.ndarray, make: Callable[[np.ndarray], Any], hardness: float):
        self.height, self.hardness = height, hardness
        self._make = make
        self._inside = tuple(map(slice, height.shape))  # without the padding of free boundaries
        untouched = make(height)
        self._control = untouched.control
        self._separated = untouched.separated()

    def separated(self) -> np.ndarray:
        """Return the state without contact and without indentation, shape (2, …)."""
        return np.stack([self._separated, np.zeros(self._separated.shape)])

    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """Find the contact at a load; the state is that of the contact and the indentation so far (m).

        An approach counts from first touch of the surface before it yielded.
        """
        state, target = step_arguments(self._control, target, state, (2, *self._separated.shape))
        if self._control == "pressure" and target >= self.hardness:
            raise ValueError(f"target = {target:g}: no state carries the hardness, {self.hardness:g} Pa, or more")
        before = state[1][self._inside]
        if before.min() < 0:
            raise ValueError("the state to start from has an indentation < 0")
        if self._control == "approach":
            target -= float(self.height.max() - (self.height - before).max())
        found = self._make(self.height - before).step(state[0], target)
        indentation = before if found.plastic_indentation is None else before + found.plastic_indentation
        kept = np.zeros(self._separated.shape)
        kept[self._inside] = indentation
        work = self.hardness * float(np.mean(indentation))
        return replace(found, state=np.stack([found.state, kept]), plastic_indentation=indentation, plastic_work=work)

    def stiffness(self, solution: Solution) -> float:
        """Return −dp/dū of a state on unloading (Pa/m), during which no point yields."""
        require_solution(solution)
        state, indentation = solution.state
        contact = self._make(self.height - indentation[self._inside])
        return contact.stiffness(replace(solution, state=state))
