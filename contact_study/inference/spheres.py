"""Theories of a smooth sphere as models of a measured curve."""

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from contact_study.inference.branches import Branch, split
from contact_study.inference.parameters import MODULUS, RADIUS, RANGE, WORK
from contact_study.physics.spheres import DMT, JKR, Hertz, MaugisDugdale, SphereTheory
from contact_study.physics.spheres.hertz import hertz_contact_radius
from contact_study.physics.spheres.jkr import jkr_contact_radius

_STATES, _BEFORE, _DENSE = 250, 40, 400  # vertices in contact, before it, and of a first, uneven line
_BEYOND = 1.2  # of the measured force: states reach further, as offsets shift them


class SphereModel:
    """States of a smooth sphere on a half-space, by constants of one theory.

    Parameters
    ----------
    theory : type
        Class of ``contact_study.physics.spheres``.
    names : tuple of str
        Parameters that the theory has.

    Examples
    --------
    >>> constants = {"work_of_adhesion": 0.05, "contact_modulus": 1e9, "radius": 1e-6}
    >>> f"{MODELS['jkr'].branches(constants, 1e-6, -1e-8, 0.0)[1].after[1].min():.3g}"
    '-2.36e-07'
    """

    def __init__(self, theory: type[SphereTheory], names: tuple[str, ...]):
        self.theory, self.names = theory, names

    def branches(
        self, constants: Mapping[str, float], largest_force: float, start: float, compliance: float
    ) -> tuple[Branch, Branch]:
        """States of approach and retraction, which are alike.

        Parameters
        ----------
        constants : mapping
            Values of the model's parameters (SI).
        largest_force : float
            Force up to which states are needed (N).
        start : float
            Displacement of the first state (m), before contact.
        compliance : float
            Compliance of a spring in series (m/N).

        Returns
        -------
        tuple of Branch
            Approach and retraction.
        """
        radius, modulus = constants[RADIUS], constants[MODULUS]
        push = max(largest_force, 0.0) * _BEYOND
        if self.theory is MaugisDugdale:
            states = self._maugis(constants, push)
        elif self.theory is JKR:
            end = float(jkr_contact_radius(push, radius, modulus, constants[WORK]))
            states = self._along(JKR(radius, modulus, constants[WORK]), end)
        else:
            adhesive = self.theory is DMT
            pull = 2 * np.pi * constants[WORK] * radius if adhesive else 0.0
            end = float(hertz_contact_radius(push + 2 * pull + 1e-3 * largest_force, radius, modulus))
            theory = DMT(radius, modulus, constants[WORK]) if adhesive else Hertz(radius, modulus)
            states = self._along(theory, end)
        far = min(start, states[0, 0]) - 1e-3 * abs(states[0]).max()
        free = np.zeros((3, _BEFORE))
        free[0] = np.linspace(far, states[0, 0], _BEFORE)
        if self.theory in (DMT, Hertz):  # forces between zero and that of first touch are not in equilibrium
            branch = Branch(free, states)
        else:
            branch = split(np.concatenate([free[:, :-1], states], axis=1), compliance)
        return branch, branch

    def _along(self, theory: SphereTheory, end: float) -> np.ndarray:
        """States at evenly spaced contact radii up to one (m)."""
        unit = float(theory.states(1.0)[2])
        return _states(theory, np.linspace(0.0, end / unit, _STATES))

    def _maugis(self, constants: Mapping[str, float], push: float) -> np.ndarray:
        work, radius = constants[WORK], constants[RADIUS]
        theory = MaugisDugdale(radius, constants[MODULUS], work, work / constants[RANGE])
        place, force, a = _uneven(theory)
        least = int(np.argmin(force))
        last = min(least + int(np.searchsorted(force[least:], push)) + 1, _DENSE - 1)
        even = np.interp(np.linspace(a[0], a[last], _STATES), a[: last + 1], place[: last + 1])
        return _states(theory, np.concatenate([np.linspace(-10.0, -9.0, _BEFORE)[:-1], even]))


@lru_cache(maxsize=8)  # slopes along offsets have the constants of the value beside them
def _uneven(theory: MaugisDugdale) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    place = np.linspace(-9.0, 34.0, _DENSE)
    force, _, radius = theory.states(place)
    return place, force, radius


def _states(theory: SphereTheory, places: np.ndarray) -> np.ndarray:
    force, displacement, radius = theory.states(places)
    return np.array([displacement, force, radius])


MODELS = {
    "hertz": SphereModel(Hertz, (MODULUS, RADIUS)),
    "jkr": SphereModel(JKR, (WORK, MODULUS, RADIUS)),
    "dmt": SphereModel(DMT, (WORK, MODULUS, RADIUS)),
    "maugis": SphereModel(MaugisDugdale, (WORK, MODULUS, RADIUS, RANGE)),
}
