"""State of the atoms in contact under a load, and how its solve ended."""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from contact_study.physics.laws.base import CONTACT_DISTANCE
from contact_study.results.state import in_two_lines


class Outcome(Enum):
    """End of a solve.

    Parameters
    ----------
    value : str
        Sentence for the user.

    Examples
    --------
    >>> from md_reference import Outcome
    >>> Outcome.CONVERGED.value
    'converged'
    """

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


@dataclass(frozen=True, eq=False, repr=False)
class Solution:
    """A state of the contact at one load; solutions compare by identity.

    Parameters
    ----------
    displacement : numpy.ndarray, shape (3, ny, nx)
        Lateral moves along x and y from the rest positions, and height over the mean plane of the substrate (m).
    residual : float
        Largest unbalanced force component on an atom, over a² E*.
    outcome : Outcome
        End of the solve.
    iterations, force_evaluations : int
        Newton steps, and evaluations of the interface, those of some atoms counted by their share.
    fft_pairs : float
        Transform pairs of three components, a single-precision pair counted one half.
    elastic_energy, interaction_energy : float
        Per nominal area (J/m²).
    state : numpy.ndarray, shape (3, ny, nx)
        Start of the next step (m); read-only, with the displacement that it is.
    gap : numpy.ndarray, shape (ny, nx)
        Height of each atom above the surface at its lateral position (m); infinite when detached.
    pressure : numpy.ndarray, shape (ny, nx)
        Normal force on each atom per its area, positive in compression (Pa).
    shear_stress : numpy.ndarray, shape (2, ny, nx)
        Force on each atom along x and y per its area (Pa).
    mean_separation : float
        Distance of the mean planes minus r0 (m), on which the load does work.
    length : float
        r0 of the pair potential (m).

    Examples
    --------
    >>> import numpy as np
    >>> from md_reference import rough_contact
    >>> block = rough_contact(np.zeros((8, 8)), 12 * 2.6e-10, 2.6e-10, 77.2e9, 0.42, 2.98e-21, 3.28e-10)
    >>> solution = block.step(block.separated(), 1e9)
    >>> solution.converged, solution.relative_contact_area
    (True, 1.0)
    """

    displacement: np.ndarray
    residual: float
    outcome: Outcome
    iterations: int
    force_evaluations: int
    fft_pairs: float
    elastic_energy: float
    interaction_energy: float
    state: np.ndarray
    gap: np.ndarray
    pressure: np.ndarray
    shear_stress: np.ndarray
    mean_separation: float
    length: float

    def __post_init__(self):
        self.state.setflags(write=False)

    def __repr__(self) -> str:
        return in_two_lines(self)

    @property
    def converged(self) -> bool:
        """Whether the solve found an equilibrium within the tolerance, or that none exists."""
        return self.outcome in (Outcome.CONVERGED, Outcome.DETACHED)

    @property
    def detached(self) -> bool:
        """Whether the surfaces are apart."""
        return self.outcome is Outcome.DETACHED

    @property
    def message(self) -> str:
        """End of the solve, in words."""
        return self.outcome.value

    @property
    def relative_contact_area(self) -> float:
        """Share of the atoms that are nearer to the surface than 2^(1/6) r0."""
        return float(np.mean(self.gap < CONTACT_DISTANCE * self.length))

    @property
    def mean_gap(self) -> float:
        """Mean of the gap minus r0, as in datasets (m); infinite when detached."""
        return float(np.mean(self.gap)) - self.length
