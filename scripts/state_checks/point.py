"""A state to be checked, whoever found it."""

from dataclasses import dataclass

import numpy as np

from bem_adhesion import Solution
from contact_study.results.state import InterfaceState


@dataclass(frozen=True)
class Point:
    """A state as a solver or a path gives it, SI.

    Parameters
    ----------
    gap, pressure : numpy.ndarray
        As of :class:`~bem_adhesion.Solution`.
    state : numpy.ndarray
        What a next step would start from.
    plane : float or None
        Of free boundaries where the surface would be undeformed.
    elastic_energy, interaction_energy : float
        As reported.
    """

    gap: np.ndarray
    pressure: np.ndarray
    state: np.ndarray
    plane: float | None
    elastic_energy: float
    interaction_energy: float

    @classmethod
    def of(cls, found: Solution) -> "Point":
        """Of what a solver has found."""
        return cls(found.gap, found.pressure, found.state, found.plane, found.elastic_energy, found.interaction_energy)

    @classmethod
    def on_path(cls, found: InterfaceState, free: bool) -> "Point":
        """Of what a path has come to, with free boundaries or not."""
        plane = found.mean_separation + found.equilibrium_distance if free else None
        energies = found.elastic_energy, found.interaction_energy
        return cls(found.gap, found.pressure, found.restart["state"], plane, *energies)
