"""Whether a block under a load has come to where the interface carries it, and what is to be known where it has not."""

import math
from dataclasses import dataclass

import numpy as np

from contact_study.fields.time_series import statistics_of

_AT_REST = 1e-3  # unbalanced stress over E*, below which atoms without noise count as in equilibrium

# Standard errors that chance accounts for: normal numbers miss by more once in 16 000 times.
_BY_CHANCE = 4.0
# Of the load. Area and gap follow it at most in proportion: what is missing changes them by as little.
_NEGLIGIBLE = 0.01
# Of the load. More is missing by no chance where the series is too short to tell its own error.
_LARGE = 0.1
# Of the speed that friction allows, above which a block counts as on its way down.
_FALLING = 0.5


@dataclass(frozen=True)
class Descent:
    """What a block under a load did in the states of a point that count.

    Attributes
    ----------
    carried : numpy.ndarray, shape (n,)
        Mean pressure of the interface in each of them (Pa).
    load : float
        The applied one (Pa).
    reached : bool
        Whether an atom was within reach of the substrate in any of them.
    speed : float
        Of the rigid plane downwards, on average (m/s).
    terminal_speed : float
        That of a fall out of reach: load over density, height and friction (m/s); infinite without friction.
    """

    carried: np.ndarray
    load: float
    reached: bool
    speed: float
    terminal_speed: float


def still_moving(descent: Descent, unbalanced: float, modulus: float) -> tuple[float, str]:
    """What is left over E* of a block without noise in its last state, and what to do where it is not at rest.

    Parameters
    ----------
    descent : Descent
        Of the last state.
    unbalanced : float
        Largest stress left on an atom of the surface (Pa).
    modulus : float
        E* (Pa).
    """
    residual = max(unbalanced, abs(float(descent.carried[-1]) - descent.load)) / modulus
    if descent.reached and residual <= _AT_REST:
        return residual, ""
    return residual, _on_its_way(descent) or "the atoms still move: raise dynamics.duration or dynamics.damping"


def load_missing(descent: Descent, modulus: float) -> tuple[float, str]:
    """The load that the interface of a warm block does not carry on average over E*, and what to do about it.

    In equilibrium the mean force of the interface is the load at any temperature and any time step.
    """
    found = statistics_of(descent.carried)
    mean, error = float(found.mean), float(found.standard_error)
    missing = abs(mean - descent.load)
    allowed = max(_BY_CHANCE * error, _NEGLIGIBLE * abs(descent.load))
    if not found.resolved:
        allowed = min(allowed, _LARGE * abs(descent.load))
    if descent.reached and missing <= allowed:
        return missing / modulus, ""
    return missing / modulus, _on_its_way(descent) or (
        f"the interface carried {mean:.4g} ± {error:.2g} Pa on average, not the {descent.load:.4g} Pa applied: "
        "raise dynamics.duration"
    )


def _on_its_way(descent: Descent) -> str:
    """That a block has yet to come down, and what helps; empty if it has."""
    hurry = "raise dynamics.duration or dynamics.approach_speed"
    slow = math.isfinite(descent.terminal_speed) and descent.terminal_speed > 0
    if slow:
        hurry += f", or lower dynamics.damping: friction lets it fall at {descent.terminal_speed:.3g} m/s"
    if not descent.reached:
        return f"no atom is within reach of the substrate: {hurry}"
    if slow and descent.speed > _FALLING * descent.terminal_speed:
        return f"the block still falls at {descent.speed:.3g} m/s: {hurry}"
    return ""
