"""Whether a block under a load has come to where the interface carries it, and what is to be known where it has not."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import special

from contact_study.numerics.time_series import statistics_of

_AT_REST = 1e-3  # unbalanced stress over E*, below which atoms without noise count as in equilibrium

# Standard errors that chance accounts for: normal numbers miss by more once in 16 000 times.
_BY_CHANCE = 4.0
# Of the load, or of the temperature. Area and gap follow them at most in proportion: what is missing changes them by as
# little.
_NEGLIGIBLE = 0.01
# Of the load. More is missing by no chance where the series is too short to tell its own error.
_LARGE = 0.1
# The share of blocks in equilibrium that are found to ring: as rare on one side as _BY_CHANCE errors are on two.
_RARE = 6e-5
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
    impact : float
        Stress with which the block as a whole would strike at its speed in the last of them: density times speed of
        sound times speed (Pa).
    """

    carried: np.ndarray
    load: float
    reached: bool
    speed: float
    terminal_speed: float
    impact: float


@dataclass(frozen=True)
class TemperatureStatistics:
    """How warm a block under a thermostat was on average over the states of a point that count.

    Attributes
    ----------
    nodes : float
        Temperature of all nodes (K).
    whole : float
        That of the block as one body, see :meth:`md_reference.thermal.langevin.MolecularDynamics.temperature_of_whole`
        (K).
    bath : float
        The thermostat's (K).
    freedoms : int
        Of the nodes.
    states : int
        That count.
    forgotten : float
        Times that friction takes a wave's energy over these states: friction times time.
    """

    nodes: float
    whole: float
    bath: float
    freedoms: int
    states: int
    forgotten: float


def still_moving(descent: Descent, unbalanced: float, modulus: float) -> tuple[float, str]:
    """What is left over E* of a block without noise in its last state, and what to do where it is not at rest.

    A block that flies, or swings through where its load is carried, is out of balance in nothing but its speed.

    Parameters
    ----------
    descent : Descent
        Of the last state.
    unbalanced : float
        Largest stress left on an atom of the surface (Pa).
    modulus : float
        E* (Pa).
    """
    residual = max(unbalanced, abs(float(descent.carried[-1]) - descent.load), descent.impact) / modulus
    if descent.reached and residual <= _AT_REST:
        return residual, ""
    return residual, _on_its_way(descent) or "the atoms still move: raise dynamics.duration or dynamics.damping"


def not_in_equilibrium(descent: Descent, warmth: TemperatureStatistics, modulus: float) -> tuple[float, str]:
    """What a warm block's interface does not carry of the load over E*, and what to do if it is in no equilibrium yet.

    A block that rings carries its load on average over many swings and is off by swings over few of them; one that is
    still cold carries it, too. Equipartition tells both.
    """
    residual, message = load_missing(descent, modulus)
    if message and _on_its_way(descent):
        return residual, message
    return residual, _ringing(warmth) or message or _still_cold(warmth)


def _ringing(warmth: TemperatureStatistics) -> str:
    """That a block moves up and down by more than thermal motion, as after an impact; empty if it does not.

    The square of one momentum is χ²-distributed with one freedom. Friction takes a wave's energy at its rate, so that
    states which see all swings alike remember the square for the inverse of it, others for less: a mean over time has
    half as many freedoms as friction times time at least, or one, and one a state at most.
    """
    freedoms = min(max(0.5 * warmth.forgotten, 1.0), warmth.states)
    largest = special.chdtri(freedoms, _RARE) / freedoms
    found = warmth.whole / warmth.bath
    if found <= largest:
        return ""
    return (
        f"the block still moves up and down as a whole, with {found:.3g} times the energy of thermal motion, by chance "
        f"with {largest:.3g} at most: raise dynamics.duration or dynamics.damping"
    )


def _still_cold(warmth: TemperatureStatistics) -> str:
    """That the nodes have not the thermostat's temperature; empty if they have."""
    by_chance = _BY_CHANCE * math.sqrt(2 / warmth.freedoms)  # as if all states were one
    if abs(warmth.nodes / warmth.bath - 1) <= max(by_chance, _NEGLIGIBLE):
        return ""
    return (
        f"the atoms moved at {warmth.nodes:.4g} K on average, not at the thermostat's {warmth.bath:.4g} K: raise "
        "dynamics.duration or dynamics.damping"
    )


def load_missing(descent: Descent, modulus: float, swings: bool = False) -> tuple[float, str]:
    """The load that the interface of a moving block does not carry on average over E*, and what to do about it.

    A block that nothing carries has yet to come down. One that swings without end misses its load by chance as far as
    it swings: no error excuses that.
    """
    missing, words = mean_load_missing(descent.carried, descent.load, swings)
    if descent.reached and not words:
        return missing / modulus, ""
    return missing / modulus, _on_its_way(descent) or f"{words}: raise dynamics.duration"


def mean_load_missing(carried: np.ndarray, load: float, swings: bool = False) -> tuple[float, str]:
    """What a series of mean pressures lacks of the load on average (Pa), and words on it if that is not by chance.

    In equilibrium the mean force of the interface is the load at any temperature and any time step.

    Parameters
    ----------
    carried : numpy.ndarray, shape (n,)
        Mean pressure of the interface in the states that count (Pa).
    load : float
        The applied one (Pa).
    swings : bool, optional
        Whether the states are those of a block without friction, whose errors tell how far it swings.
    """
    found = statistics_of(carried)
    mean, error = float(found.mean), float(found.standard_error)
    missing = abs(mean - load)
    by_chance = _BY_CHANCE * error if math.isfinite(error) else 0.0  # of one state
    allowed = max(by_chance, _NEGLIGIBLE * abs(load))
    if swings or not found.resolved:
        allowed = min(allowed, _LARGE * abs(load))
    if missing <= allowed:
        return missing, ""
    told = f" ± {error:.2g}" if math.isfinite(error) else ""
    return missing, f"the interface carried {mean:.4g}{told} Pa on average, not the {load:.4g} Pa applied"


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
