"""A state of the atoms and how it was reached: what the minimiser returns, and what a contact under load does."""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from contact_study.physics.laws.base import CONTACT_DISTANCE
from contact_study.results.state import in_two_lines


class Outcome(Enum):
    """How a solve ended; the value is the sentence for the user."""

    CONVERGED = "converged"
    DETACHED = "detached: no atom is within reach of the substrate and no pressure drives the block towards it"
    ITERATION_LIMIT = (
        "the iteration limit was reached before the tolerance: take smaller loading steps or raise "
        "solver.max_iterations"
    )
    STALLED = (
        "no step comes nearer to balance: take smaller loading steps, or raise solver.tolerance if the residual is "
        "close to it"
    )


@dataclass(frozen=True)
class Equilibrium:
    """A state and how it was reached.

    Attributes
    ----------
    displacement : numpy.ndarray, shape (3, ny, nx)
        Lateral moves along x and y from the rest positions, and height over the mean plane of the substrate (m).
    force : numpy.ndarray, shape (3, ny, nx)
        Force of the interface on each atom (N).
    residual : float
        Largest force component left on an atom, over a² E*.
    outcome : Outcome
        How the solve ended.
    iterations, evaluations : int
        Newton steps and evaluations of the interface, those of some atoms counted by their share.
    fft_pairs : float
        Transform pairs of three components, a single-precision pair counted one half.
    elastic_energy, interaction_energy : float
        ½ u·Su and E(u) (J).
    """

    displacement: np.ndarray
    force: np.ndarray
    residual: float
    outcome: Outcome
    iterations: int
    evaluations: int
    fft_pairs: float
    elastic_energy: float
    interaction_energy: float

    @property
    def converged(self) -> bool:
        """Whether the question is answered: an equilibrium within the tolerance, or the finding that none exists."""
        return self.outcome in (Outcome.CONVERGED, Outcome.DETACHED)


@dataclass(frozen=True, eq=False, repr=False)
class Solution:
    """A state of the contact at one load.

    Solutions compare by identity.

    Attributes
    ----------
    state : numpy.ndarray, shape (3, ny, nx)
        What the next step starts from (m); read-only, with the displacement that it is.
    displacement : numpy.ndarray, shape (3, ny, nx)
        As of :class:`Equilibrium` (m).
    gap : numpy.ndarray, shape (ny, nx)
        Height of each atom above the surface at its lateral position (m); infinite when detached.
    pressure : numpy.ndarray, shape (ny, nx)
        Normal force on each atom per its area, positive in compression (Pa).
    shear_stress : numpy.ndarray, shape (2, ny, nx)
        Force on each atom along x and y per its area (Pa).
    mean_separation : float
        Distance of the mean planes less r0 (m): what the load works on.
    elastic_energy, interaction_energy : float
        Per nominal area (J/m²).
    residual : float
        Largest force component left on an atom, over a² E*.
    iterations, force_evaluations : int
        Newton steps and evaluations of the interface, those of some atoms counted by their share.
    fft_pairs : float
        Transform pairs of three components, a single-precision pair counted one half.
    outcome : Outcome
        How the solve ended.
    length : float
        r0 of the pair potential (m).
    """

    state: np.ndarray
    displacement: np.ndarray
    gap: np.ndarray
    pressure: np.ndarray
    shear_stress: np.ndarray
    mean_separation: float
    elastic_energy: float
    interaction_energy: float
    residual: float
    iterations: int
    force_evaluations: int
    fft_pairs: float
    outcome: Outcome
    length: float

    def __post_init__(self):
        self.state.setflags(write=False)

    def __repr__(self) -> str:
        return in_two_lines(self)

    @property
    def relative_contact_area(self) -> float:
        """Share of the atoms that are nearer to the surface than 2^(1/6) r0."""
        return float(np.mean(self.gap < CONTACT_DISTANCE * self.length))

    @property
    def mean_gap(self) -> float:
        """Mean of the gap less r0, as in datasets (m); infinite when detached."""
        return float(np.mean(self.gap)) - self.length

    @property
    def converged(self) -> bool:
        """Whether the question is answered: an equilibrium within the tolerance, or the finding that none exists."""
        return self.outcome in (Outcome.CONVERGED, Outcome.DETACHED)

    @property
    def detached(self) -> bool:
        """Whether the surfaces are apart."""
        return self.outcome is Outcome.DETACHED

    @property
    def message(self) -> str:
        """How the solve ended, in words."""
        return self.outcome.value
