"""Checks of the arguments that both solvers share."""

import numpy as np

from contact_study.numerics.arguments import check_control
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import Elasticity


def check_arguments(
    height: np.ndarray,
    grid: Grid,
    control: str,
    tolerance: float,
    max_iterations: int,
    elasticity: Elasticity,
) -> None:
    """Make sure that a solver can begin.

    Raises
    ------
    ValueError
        If the heights do not fit the grid or are not numbers, ``control`` is unknown or not known of the solid, or a
        limit is not positive.
    """
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
