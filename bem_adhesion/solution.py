"""Result of a continuum solver, the same for the hard wall and for adhesion, and checks of what it is given."""

from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from contact_study.numerics.arguments import check_control
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import TractionLaw
from contact_study.physics.solids import Elasticity
from contact_study.results.state import in_two_lines


class Outcome(Enum):
    """End of a solve; the value is the message for the user.

    Examples
    --------
    >>> from bem_adhesion import Outcome
    >>> Outcome.CONVERGED.value
    'converged'
    """

    CONVERGED = "converged"
    DETACHED = "detached: no equilibrium in contact exists under this tension, the surfaces separate"
    APART = "detached: the surfaces are separated; start the loading path with a positive pressure"
    ITERATION_LIMIT = (
        "the iteration limit was reached before the tolerance: take smaller loading steps or raise "
        "solver.max_iterations"
    )
    YIELDED = (
        "the whole surface yields: every point carries material.hardness, at this approach and beyond it; "
        "use a smaller one"
    )
    LEAST_STEP = (
        "no adaptive step converged, not even the least of loading.resolution: the values at this load step are not an "
        "equilibrium. The run continued from the last converged state. Raise solver.max_iterations, lower "
        "loading.resolution or use a finer grid"
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
    state : numpy.ndarray
        Start of a next step with the same solver: the displacement (m), or the pressure on a hard wall (Pa). Read-only,
        and the same array as that field.
    displacement : numpy.ndarray, shape (y, x)
        Position of the solid's deformed surface (m): heights plus gap, mean included.
    gap : numpy.ndarray, shape (y, x)
        Separation of the surfaces (m); negative only under laws whose repulsion is finite at a gap of zero.
    pressure : numpy.ndarray, shape (y, x)
        Pressure at the interface, positive in compression (Pa).
    elastic_energy : float
        Energy of the solid per nominal area (J/m²), with the uniform compression of a layer.
    interaction_energy : float
        Energy of the traction-separation law per nominal area (J/m²); zero for a hard wall.
    residual : float
        Scale-free error of the equations, which the solver's tolerance bounds.
    iterations : int
        Outer iterations on the finest grid.
    fft_pairs : float
        Transform pairs, as float64 pairs on the finest grid.
    outcome : Outcome
        End of the solve.
    complementarity_residual : float or None
        Attraction outside a wall: the largest tension between touching points and the wall, over E*. With a hardness:
        the largest tension, or pressure above the hardness, over E*.
    plane : float or None
        Free boundaries: position of the undeformed surface, in the coordinate of the heights (m).
    plastic_indentation : numpy.ndarray, shape (y, x), or None
        Permanent indentation at the hardness so far, >= 0 (m): the surfaces are at heights − indentation + gap. None
        without yielding.
    plastic_work : float
        Work that plastic indentation has taken so far per nominal area (J/m²).
    law : TractionLaw
        The law of the interface, which defines contact.

    Examples
    --------
    >>> import numpy as np
    >>> from bem_adhesion import HardWall, rough_contact
    >>> height = 1e-9 * np.cos(np.linspace(0, 2 * np.pi, 32, endpoint=False)) * np.ones((32, 1))
    >>> contact = rough_contact(height, 1e-7, 1e11, HardWall())
    >>> solution = contact.step(contact.separated(), 1e8)
    >>> bool(solution.converged), round(float(solution.pressure.mean()) / 1e8, 9)
    (True, 1.0)
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
    plastic_work: float = 0.0
    law: TractionLaw = field(kw_only=True)

    def __post_init__(self):
        self.state.setflags(write=False)  # also the displacement's array, or a wall's pressure's

    def __repr__(self) -> str:
        return in_two_lines(self)

    @property
    def relative_contact_area(self) -> float:
        """Contact area over nominal area, by the law's :attr:`~TractionLaw.contact_distance`."""
        return float(np.mean(self.law.in_contact(self.gap, self.pressure, self.law.contact_distance)))

    @property
    def mean_gap(self) -> float:
        """Mean of the gap minus the law's equilibrium distance, as in datasets (m); infinite when detached."""
        return float(np.mean(self.gap)) - self.law.equilibrium_distance

    @property
    def converged(self) -> bool:
        """Whether the solve found an equilibrium within the tolerance, or that none exists."""
        return self.outcome is Outcome.CONVERGED or self.detached

    @property
    def detached(self) -> bool:
        """Whether the surfaces are separated."""
        return self.outcome in (Outcome.DETACHED, Outcome.APART)

    @property
    def message(self) -> str:
        """End of the solve, in words."""
        return self.outcome.value


@dataclass(frozen=True)
class NewtonResult:
    """End of a Newton solve: gap, pressure of a wall where it is zero, max|gradient| without what a wall carries.

    ``pressure`` is that of the load, which is found where the mean gap is prescribed.
    """

    gap: np.ndarray
    reaction: np.ndarray | float
    residual: float
    iterations: int
    outcome: Outcome
    pressure: float


def approach_stiffness(elasticity: Elasticity, grid: Grid, machine_compliance: float = 0.0) -> float:
    """Return the stiffness of the mean under an approach, of solid and machine in series (Pa/m); zero if none."""
    solid = elasticity.mean_stiffness_on(grid)
    if not machine_compliance:
        return solid
    return 1 / (machine_compliance + (1 / solid if solid else 0.0))


def check_arguments(
    grid: Grid,
    control: str,
    tolerance: float,
    max_iterations: int,
    elasticity: Elasticity,
    machine_compliance: float = 0.0,
) -> None:
    """Raise ValueError if control or limits are invalid, or solid and machine do not support the control."""
    check_control(control, tolerance, max_iterations, ("pressure", "gap", "approach"))
    if control == "approach" and not approach_stiffness(elasticity, grid, machine_compliance):
        raise ValueError(
            "control = 'approach': a uniform pressure moves this solid by no finite distance, or not at all; use "
            "'pressure' or 'gap'"
        )


def require_solution(solution: Solution) -> None:
    """Raise TypeError unless the argument is a Solution."""
    if not isinstance(solution, Solution):
        raise TypeError(
            f"stiffness takes the Solution that step returned, not {type(solution).__name__}; pass solution itself, "
            "not solution.state"
        )
