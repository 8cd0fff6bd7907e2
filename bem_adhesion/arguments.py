"""Checks of arguments that all contacts share."""

import numpy as np

from bem_adhesion.solution import Solution
from contact_study.numerics.arguments import check_control
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import Elasticity


def check_arguments(
    height: np.ndarray, grid: Grid, control: str, tolerance: float, max_iterations: int, elasticity: Elasticity
) -> None:
    """Raise ValueError if heights, control or limits are invalid, or the solid does not support the control."""
    if height.shape != grid.shape:
        raise ValueError(f"height has shape {height.shape}, the grid {grid.shape}")
    if not np.all(np.isfinite(height)):
        raise ValueError("height is not finite everywhere")
    check_control(control, tolerance, max_iterations, ("pressure", "gap", "approach"))
    if control == "approach" and not elasticity.mean_stiffness_on(grid):
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
