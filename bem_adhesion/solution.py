"""What a continuum solver returns, the same for the hard wall and for adhesion."""

from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from contact_study.physics.laws.base import TractionLaw
from contact_study.results.state import in_two_lines


class Outcome(Enum):
    """How a solve ended; the value is the sentence shown to the user, with advice where there is any."""

    CONVERGED = "converged"
    DETACHED = "detached: no equilibrium in contact exists under this tension, the surfaces separate"
    APART = "detached: the surfaces are separated; start the loading path with a positive pressure"
    ITERATION_LIMIT = (
        "the iteration limit was reached before the tolerance: take smaller loading steps or raise "
        "solver.max_iterations"
    )
    YIELDED = (
        "the whole surface gives way: every point carries material.hardness, at this approach and beyond it; give less"
    )
    LEAST_STEP = (
        "no step converged, not even the least of loading.resolution: these are numbers of a state that is not in "
        "balance, on the way to this point, not at it; the path goes on from the last state that converged: raise "
        "solver.max_iterations, lower loading.resolution or take a finer grid"
    )
    STALLED = (
        "no step comes nearer to balance: take smaller loading steps, or raise solver.tolerance if the residual is "
        "close to it"
    )


@dataclass(frozen=True, eq=False, repr=False)
class Solution:
    """A state of the contact at one load.

    Solutions compare by identity.

    Parameters
    ----------
    state : numpy.ndarray, shape (y, x)
        What the next step starts from, of the solver that gave it: the displacement (m), or the pressure on a hard wall
        (Pa). Read-only, with the field that it is.
    displacement : numpy.ndarray, shape (y, x)
        Position of the block's deformed surface (m): heights plus gap, mean included.
    gap : numpy.ndarray, shape (y, x)
        Separation of the surfaces (m); negative only under laws whose repulsion is finite at a gap of zero.
    pressure : numpy.ndarray, shape (y, x)
        Pressure that the interface exerts, positive in compression (Pa).
    elastic_energy : float
        Energy of the block per nominal area (J/m²), with the uniform compression of a layer.
    interaction_energy : float
        Energy of the traction-separation law per nominal area (J/m²); zero for a hard wall.
    residual : float
        Scale-free error of the equations the solver stops on.
    iterations : int
        Outer iterations on the finest grid.
    fft_pairs : float
        Transform pairs, as float64 pairs on the finest grid (see :meth:`Operator.equivalent_pairs`).
    outcome : Outcome
        How the solve ended.
    complementarity_residual : float or None
        Attraction outside a wall: the largest pull that touching points would need of the wall, over E*; where there is
        a gap the wall carries nothing. With a hardness: the largest pull, or pressure beyond the hardness, over E*.
    plane : float or None
        Free boundaries: where the block's surface would be undeformed, in the coordinate of the heights (m).
    plastic_indentation : numpy.ndarray, shape (y, x), or None
        How far points have given way for good at the hardness, >= 0 (m): in this step, or of a
        :class:`~bem_adhesion.contacts.plastic.PlasticContact` in all steps; the surfaces are at heights less
        indentation plus gap. None where nothing has.
    law : TractionLaw
        The law of the interface, which says what counts as contact.
    """

    state: np.ndarray
    displacement: np.ndarray
    gap: np.ndarray
    pressure: np.ndarray
    elastic_energy: float
    interaction_energy: float
    residual: float
    iterations: int
    fft_pairs: float
    outcome: Outcome
    complementarity_residual: float | None = None
    plane: float | None = None
    plastic_indentation: np.ndarray | None = None
    law: TractionLaw = field(kw_only=True)

    def __post_init__(self):
        self.state.setflags(write=False)  # it is the displacement's array, or a wall's pressure's, and a later start

    def __repr__(self) -> str:
        return in_two_lines(self)

    @property
    def relative_contact_area(self) -> float:
        """Contact area over nominal area, by the law's own :attr:`~TractionLaw.contact_distance`."""
        return float(np.mean(self.law.in_contact(self.gap, self.pressure, self.law.contact_distance)))

    @property
    def mean_gap(self) -> float:
        """Mean of the gap less the law's equilibrium distance, as in datasets (m); infinite when detached."""
        return float(np.mean(self.gap)) - self.law.equilibrium_distance

    @property
    def converged(self) -> bool:
        """Whether the question is answered: an equilibrium within the tolerance, or the finding that none exists."""
        return self.outcome is Outcome.CONVERGED or self.detached

    @property
    def detached(self) -> bool:
        """Whether the surfaces are apart."""
        return self.outcome in (Outcome.DETACHED, Outcome.APART)

    @property
    def message(self) -> str:
        """How the solve ended, in words."""
        return self.outcome.value


@dataclass(frozen=True)
class NewtonResult:
    """State that a Newton solve reached.

    Parameters
    ----------
    gap : numpy.ndarray
        The gap d; positive where the repulsion diverges, not negative outside a wall.
    reaction : numpy.ndarray or float
        Pressure of the wall where the gap is zero; zero for a law without one.
    residual : float
        max|K d + φ'(d) + load|; where surfaces touch a wall, only what it would have to pull.
    iterations : int
        Newton iterations.
    outcome : Outcome
        How the solve ended.
    """

    gap: np.ndarray
    reaction: np.ndarray | float
    residual: float
    iterations: int
    outcome: Outcome
