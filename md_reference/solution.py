"""What the minimiser returns: a state of the atoms and how it was reached."""

from dataclasses import dataclass
from enum import Enum

import numpy as np


class Outcome(Enum):
    """How a solve ended; the value is the sentence for the user."""

    CONVERGED = "converged"
    DETACHED = "detached: no atom is within reach of the substrate and no pressure drives the block towards it"
    ITERATION_LIMIT = (
        "the iteration limit was reached before the tolerance: take smaller loading steps or raise "
        "solver.max_iterations"
    )
    STALLED = "no step lowers the energy although the residual is above the tolerance: raise solver.tolerance"


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
        Newton steps and evaluations of the interface.
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
