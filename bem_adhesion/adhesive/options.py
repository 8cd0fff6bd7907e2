"""Constants of the adhesive solver, as frozen options with defaults; trials behind them are in research/notes.

Residuals and stiffnesses are in units of the contact modulus, lengths in units of the law's length.
"""

from dataclasses import dataclass

from contact_study.numerics.multigrid import SHORT_WAVES
from contact_study.physics.laws import TractionLaw


@dataclass(frozen=True)
class NewtonOptions:
    """Constants of the Newton descent on one grid."""

    # Reduction of the residual in a linear solve: full curvature, damped negative curvature, a tangent step.
    reduction: float = 0.1
    damped_reduction: float = 0.3
    tangent_reduction: float = 0.1
    # Below the residual ``close`` a linear solve reduces further, but not beyond this share of the tolerance.
    close: float = 1e-3
    close_reduction: float = 0.03
    beyond_tolerance: float = 0.5
    linear_iterations: int = 60
    settled_mean: float = 0.1  # error of a prescribed mean gap over its tolerance below which steps leave it
    short_waves: float = SHORT_WAVES  # ω of the preconditioner, see contact_study.numerics.multigrid
    step_limit: float = 0.4  # largest relative change of an attracted gap in one step
    # Damping of negative curvature: first value, factor after a failure, factor after a success.
    damping_start: float = 0.1
    damping_growth: float = 3.0
    damping_decay: float = 0.6
    # Residual above which negative curvature is removed at first contact, where surfaces jump in everywhere at once:
    # the descent then ends in the state of a slow gradient flow.
    first_contact_residual: float = 0.2
    # Residual below which a state with negative curvature is left along it, the length of that step, and the number of
    # such steps in a row after which the curvature is damped instead.
    saddle_residual: float = 0.2
    saddle_step: float = 0.1
    saddle_steps: int = 50
    curvature_iterations: int = 8  # of conjugate gradients that search for negative curvature at an equilibrium
    subdomain_residual: float = 5e-3  # residual above which subdomains are relaxed separately
    # Line search: factor, and share of a step at which it fails.
    backtracking: float = 0.4
    shortest_step: float = 1e-4
    longest_fall: float = 100  # step of separated surfaces over the largest gap, beyond which only rounding holds them
    energy_rounding: float = 1e-9  # relative difference of equal energies; the residual then decides
    share_of_tolerance: float = 0.01  # rounding of the residual above which it is evaluated again at the end

    @classmethod
    def of(cls, law: TractionLaw) -> "NewtonOptions":
        """Return the defaults for a law; outside a wall the held points change after every step."""
        return cls(reduction=0.2, short_waves=2.5) if law.has_wall else cls()


@dataclass(frozen=True)
class MultigridOptions:
    """Constants of the prediction on coarser grids."""

    points_for_prediction: float = 1.25  # per process zone of the coarsest grid that predicts
    coarse_tolerance: float = 3e-4
    closest_prediction: float = 0.85  # smallest predicted gap over the equilibrium distance, unless it was smaller
    # Distance of a prediction from the load over the law's peak stress: on a coarse grid of one point per process zone,
    # and its lower limit. It falls with the fourth power of the points.
    lag: float = 0.05
    least_lag: float = 1e-4
    tangent_limit: float = 0.1  # largest relative change of a gap along the tangent; beyond it a fold is near
    # Tangent steps, and points per process zone of the coarse grid from which more than one is taken.
    tangent_steps: int = 3
    points_for_steps: float = 32
    # Points per process zone of the coarsest grid that searches for negative curvature, and factor on its softening.
    points_for_curvature: float = 4
    curvature_margin: float = 1.05
    fewest_points: int = 8  # along an axis, below which a grid is not halved

    @classmethod
    def of(cls, law: TractionLaw) -> "MultigridOptions":
        """Return the defaults for a law; at contact edges with a wall interpolation leaves a residual of 0.3."""
        return cls(coarse_tolerance=1e-2) if law.has_wall else cls()
