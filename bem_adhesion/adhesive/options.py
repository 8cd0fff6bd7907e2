"""Constants of the adhesive solver, as frozen options with defaults; trials behind them are in research/notes.

Residuals and stiffnesses are in units of the contact modulus, lengths in units of the law's length.
"""

from dataclasses import dataclass, field

from contact_study.numerics.multigrid import SHORT_WAVES
from contact_study.physics.laws.base import TractionLaw


@dataclass(frozen=True)
class NewtonOptions:
    """Constants of the Newton descent on one grid.

    Parameters
    ----------
    reduction, damped_reduction, tangent_reduction : float
        Reduction of the residual in a linear solve with the full curvature, with damped negative curvature, and of a
        tangent step.
    close, close_reduction : float
        Residual below which a linear solve reduces the residual to ``close_reduction``.
    beyond_tolerance : float
        Share of the tolerance below which a linear solve does not reduce the residual.
    linear_iterations : int
        Largest number of iterations of a linear solve.
    short_waves : float
        ω of the preconditioner's short waves, see :mod:`contact_study.numerics.multigrid`.
    step_limit : float
        Largest relative change of an attracted gap in one step.
    damping_start, damping_growth, damping_decay : float
        Damping of negative curvature: first value, factor after a failure, factor after a success.
    first_contact_residual : float
        Residual above which negative curvature is removed at first contact, where surfaces jump in everywhere at once:
        the descent then ends in the state of a slow gradient flow.
    saddle_residual, saddle_step, saddle_steps : float, float, int
        Residual below which a state with negative curvature is left along that direction; length of this step; and
        number of such steps in a row after which the curvature is damped instead.
    curvature_iterations : int
        Iterations of conjugate gradients that search for negative curvature at an equilibrium.
    subdomain_residual : float
        Residual above which subdomains are relaxed separately.
    backtracking, shortest_step : float
        Factor of the line search, and the share of a step at which it fails.
    longest_fall : float
        Longest step of separated surfaces, over the largest gap: a longer one is that of a mean gap which only rounding
        holds.
    energy_rounding : float
        Relative difference of equal energies; the residual then decides.
    share_of_tolerance : float
        Share of the tolerance above which rounding of the residual makes the solver evaluate it again at the end.
    """

    reduction: float = 0.1
    damped_reduction: float = 0.3
    tangent_reduction: float = 0.1
    close: float = 1e-3
    close_reduction: float = 0.03
    beyond_tolerance: float = 0.5
    linear_iterations: int = 60
    short_waves: float = SHORT_WAVES
    step_limit: float = 0.4
    damping_start: float = 0.1
    damping_growth: float = 3.0
    damping_decay: float = 0.6
    first_contact_residual: float = 0.2
    saddle_residual: float = 0.2
    saddle_step: float = 0.1
    saddle_steps: int = 50
    curvature_iterations: int = 8
    subdomain_residual: float = 5e-3
    backtracking: float = 0.4
    shortest_step: float = 1e-4
    longest_fall: float = 100
    energy_rounding: float = 1e-9
    share_of_tolerance: float = 0.01

    @classmethod
    def of(cls, law: TractionLaw) -> "NewtonOptions":
        """Return the defaults for a law; outside a wall the held points change after every step."""
        return cls(reduction=0.2, short_waves=2.5) if law.has_wall else cls()


@dataclass(frozen=True)
class SubdomainOptions:
    """Constants of the relaxation in subdomains.

    Parameters
    ----------
    tiles, tiles_of_subdomain : int
        Tiles along an axis of the grid and of a subdomain; one tile at each rim is held.
    fewest_points : int
        Points along an axis of a subdomain below which little work can be saved.
    share : float
        Fraction of the largest residual above which a point is out of balance.
    most : int
        Largest number of subdomains.
    steps : int
        Newton steps in one subdomain before the whole takes one; more may end in another state.
    """

    tiles: int = 32
    tiles_of_subdomain: int = 8
    fewest_points: int = 64
    share: float = 0.2
    most: int = 4
    steps: int = 3


@dataclass(frozen=True)
class MultigridOptions:
    """Constants of the prediction on coarser grids.

    Parameters
    ----------
    points_for_prediction : float
        Points per process zone of the coarsest grid that predicts.
    coarse_tolerance : float
        Tolerance on the coarse grids.
    closest_prediction : float
        Smallest predicted gap over the equilibrium distance, unless the gap was smaller before.
    lag, least_lag : float
        Distance of a prediction from the load, in units of the law's peak stress: on a coarse grid of one point per
        process zone, and its lower limit; it falls with the fourth power of the points.
    tangent_limit : float
        Largest relative change of a gap along the tangent on the rest of the way; beyond it a fold is near.
    tangent_steps, points_for_steps : int, float
        Tangent steps, and points per process zone of the coarse grid from which more than one is taken.
    points_for_curvature, curvature_margin : float
        Points per process zone of the coarsest grid that searches for negative curvature, and the factor on the
        softening there.
    fewest_points : int
        Points along an axis below which a grid is not halved.
    """

    points_for_prediction: float = 1.25
    coarse_tolerance: float = 3e-4
    closest_prediction: float = 0.85
    lag: float = 0.05
    least_lag: float = 1e-4
    tangent_limit: float = 0.1
    tangent_steps: int = 3
    points_for_steps: float = 32
    points_for_curvature: float = 4
    curvature_margin: float = 1.05
    fewest_points: int = 8

    @classmethod
    def of(cls, law: TractionLaw) -> "MultigridOptions":
        """Return the defaults for a law; at contact edges with a wall interpolation leaves a residual of 0.3."""
        return cls(coarse_tolerance=1e-2) if law.has_wall else cls()


@dataclass(frozen=True)
class AdhesiveOptions:
    """Constants of an adhesive contact.

    Parameters
    ----------
    newton, multigrid, subdomains
        Constants of its parts; None chooses the defaults of the law.
    preconditioner_shift : float
        Stiffness that separates core and tail in the preconditioner, in units of the geometric mean of the law's
        strongest softening and of the solid at the surface's typical wavenumber.
    gap_corrections : int
        Corrections of the spring's end under gap control.
    approach_refinements : int
        Solves at smaller and smaller tolerance until an approach is reached.
    touching : float
        Rounding of a gap of zero outside a wall, over the largest height.
    """

    newton: NewtonOptions | None = None
    multigrid: MultigridOptions | None = None
    subdomains: SubdomainOptions = field(default_factory=SubdomainOptions)
    preconditioner_shift: float = 0.22
    gap_corrections: int = 20
    approach_refinements: int = 5
    touching: float = 1e-14
