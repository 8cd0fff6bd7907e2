"""Tests of a block under load: is it at rest, or in equilibrium at its temperature, and what to change if not."""

import math
from typing import NamedTuple

import numpy as np
from scipy import special

from contact_study.numerics.time_series import statistics_of

_AT_REST = 1e-3  # unbalanced stress over E*, below which atoms without noise count as in equilibrium
_BY_CHANCE = 4.0  # standard errors; normal numbers miss by more once in 16 000 times
_NEGLIGIBLE = 0.01  # share of the load, or of the temperature; area and gap follow them at most in proportion
_LARGE = 0.1  # share of the load that no unresolved error excuses
_RARE = 6e-5  # share of blocks in equilibrium that are found to ring; one-sided, as rare as by chance
_FALLING = 0.5  # share of the terminal speed above which a block counts as falling


class Descent(NamedTuple):
    """Motion of a block under a load in the recorded states of a point that count."""

    carried: np.ndarray  # mean pressure of the interface in each state, shape (n,) (Pa)
    load: float  # the applied one (Pa)
    reached: bool  # whether an atom was within reach of the substrate in any state
    speed: float  # mean speed of the rigid plane downwards (m/s)
    terminal_speed: float  # of a fall out of reach: load over mass per area and damping (m/s); inf without damping
    impact: float  # stress of an impact at the block's last speed: density times speed of sound times speed (Pa)


def still_moving(descent: Descent, unbalanced: float, modulus: float) -> tuple[float, str]:
    """Test whether a block without noise is at rest; return what is left over E*, and advice if it is not.

    ``unbalanced`` is the largest stress on an atom of the surface, ``modulus`` E* (Pa).
    """
    residual = max(unbalanced, abs(float(descent.carried[-1]) - descent.load), descent.impact) / modulus
    if descent.reached and residual <= _AT_REST:
        return residual, ""
    return residual, _falling(descent) or "the atoms still move: raise dynamics.duration or dynamics.damping"


def not_in_equilibrium(
    descent: Descent, modulus: float, nodes: float, whole: float, bath: float, freedoms: int, forgotten: float
) -> tuple[float, str]:
    """Test whether a warm block is in equilibrium; return the missing load over E*, and advice if it is not.

    A block that rings, or is still cold, may carry its load on average: equipartition detects both, by the mean
    temperatures of the ``nodes``, with their ``freedoms``, of the ``whole`` as one body and of the ``bath`` (K).
    ``forgotten`` is damping times time: how often the thermostat replaces a wave's energy.
    """
    residual, message = load_missing(descent, modulus)
    if message and _falling(descent):
        return residual, message
    ringing = _ringing(whole / bath, forgotten, descent.carried.size)
    by_chance = _BY_CHANCE * math.sqrt(2 / freedoms)  # as if all states were one
    if ringing or message or abs(nodes / bath - 1) <= max(by_chance, _NEGLIGIBLE):
        return residual, ringing or message
    return residual, (
        f"the atoms moved at {nodes:.4g} K on average, not at the thermostat's {bath:.4g} K: raise dynamics.duration "
        "or dynamics.damping"
    )


def load_missing(descent: Descent, modulus: float, swings: bool = False) -> tuple[float, str]:
    """Return :func:`mean_load_missing` of a block over E*, and advice if it is not chance."""
    missing, words = mean_load_missing(descent.carried, descent.load, swings)
    if descent.reached and not words:
        return missing / modulus, ""
    return missing / modulus, _falling(descent) or f"{words}: raise dynamics.duration"


def mean_load_missing(carried: np.ndarray, load: float, swings: bool = False) -> tuple[float, str]:
    """Return how much of the load a series of mean pressures lacks on average (Pa), and words if it is not chance.

    ``swings`` marks states of a block without damping, whose errors measure how far it swings and excuse nothing.
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
    spread = f" ± {error:.2g}" if math.isfinite(error) else ""
    return missing, f"the interface carried {mean:.4g}{spread} Pa on average, not the {load:.4g} Pa applied"


def _ringing(found: float, forgotten: float, states: int) -> str:
    """Return advice if a block moves up and down by ``found`` times thermal motion, as after an impact."""
    # The square of one momentum is χ²-distributed with one freedom; a mean over time has at least half as many freedoms
    # as damping times time, or one, and at most one per state.
    freedoms = min(max(0.5 * forgotten, 1.0), states)
    largest = special.chdtri(freedoms, _RARE) / freedoms
    if found <= largest:
        return ""
    return (
        f"the block still moves up and down as a whole, with {found:.3g} times the energy of thermal motion, by chance "
        f"with {largest:.3g} at most: raise dynamics.duration or dynamics.damping"
    )


def _falling(descent: Descent) -> str:
    """Return advice if a block is still on its way down."""
    advice = "raise dynamics.duration or dynamics.approach_speed"
    slow = math.isfinite(descent.terminal_speed) and descent.terminal_speed > 0
    if slow:
        advice += f", or lower dynamics.damping: damping limits its fall to {descent.terminal_speed:.3g} m/s"
    if not descent.reached:
        return f"no atom is within reach of the substrate: {advice}"
    if slow and descent.speed > _FALLING * descent.terminal_speed:
        return f"the block still falls at {descent.speed:.3g} m/s: {advice}"
    return ""
