"""What a whole path tells of adhesion: where it pulls off, where it jumps in, the work of separation.

All three are read off the series of states in equilibrium that the path passes: mean pressure p, mean separation s,
energy U per area. Between two of them the load does the work −∫p ds; along a branch all of it is stored, in a jump it
is not.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import trapezoid

from contact_study.observables.base import Variable

# Share of the work and of the energy exchanged that a smooth step may leave unaccounted for.
UNACCOUNTED = 0.02

# Of the largest energy of a path, below which what a step leaves is the solver's error and no jump.
_NOISE = 1e-6

# What is kept of each state that a step of the path's own passes.
PASSED = ("pressure", "separation", "energy")

PATH_RESULTS: dict[str, Variable] = {
    "pull_off_pressure": Variable(
        "Pa", "lowest mean pressure that surfaces in contact carry: of a path where it pulls them apart", ()
    ),
    "jump_in_pressure": Variable("Pa", "mean pressure of the last state before the first jump of an approach", ()),
    "jump_in_separation": Variable("m", "mean separation of the last state before the first jump of an approach", ()),
    "work_of_separation": Variable(
        "J m-2",
        "work of the load per nominal area from balance, or from the end of loading, to full separation",
        (),
    ),
}


@dataclass(frozen=True)
class PathSeries:
    """The states in equilibrium that a path passes, one after the other.

    Parameters
    ----------
    pressure : numpy.ndarray, shape (n,)
        Mean pressure (Pa), compression positive; where surfaces came apart under a load, that load.
    separation : numpy.ndarray, shape (n,)
        Mean separation (m); infinite where they came apart under a load.
    energy : numpy.ndarray, shape (n,), or None
        Elastic and of the interaction, per area (J/m²); None of a path whose points are too far apart to integrate.
    ends_apart : bool
        Whether there was contact on the path, and none is left at its end.
    """

    pressure: np.ndarray
    separation: np.ndarray
    energy: np.ndarray | None = None
    ends_apart: bool = False


def unaccounted(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Work of the load that is not in the energy, by the trapezoidal rule, and what was exchanged (J/m²).

    Parameters
    ----------
    before, after : numpy.ndarray, shape (..., 3)
        Mean pressure (Pa), mean separation (m) and energy (J/m²) of two states.
    """
    work = -0.5 * (before[..., 0] + after[..., 0]) * (after[..., 1] - before[..., 1])
    stored = after[..., 2] - before[..., 2]
    return work - stored, np.abs(work) + np.abs(stored)


def path_results(series: PathSeries, control: str) -> dict[str, float]:
    """What a path tells of adhesion, by names of the schema; what it does not tell is left out.

    Parameters
    ----------
    series : PathSeries
        Its states.
    control : {"pressure", "gap", "approach"}
        What is prescribed. A load below the pull-off pressure pulls the surfaces apart; at a prescribed distance the
        lowest pressure of retraction is passed. Only there a path meets its jump-in, and does a finite work on its way
        out: under a prescribed pressure surfaces that attract come together without a load and fly apart.
    """
    if control == "pressure":
        return _lost_under_load(series)
    found = _lowest_of_retraction(series)
    if series.energy is not None:
        found |= _jump_in(series) | _work_of_separation(series)
    return found


def _lost_under_load(series: PathSeries) -> dict[str, float]:
    """The lowest pressure that was held before one that was not, and how far that lies below."""
    apart = np.isinf(series.separation)
    last = np.flatnonzero(~apart[:-1] & apart[1:])
    if not last.size:
        return {}
    # Under no load surfaces that attract are held: this is known of every path.
    held = np.minimum(series.pressure[last], 0.0)
    lowest = int(np.argmin(held))
    return {
        "pull_off_pressure": float(held[lowest]),
        "pull_off_pressure_resolution_error": float(held[lowest] - series.pressure[last[lowest] + 1]),
    }


def _turn(series: PathSeries) -> int:
    """Where approach ends and retraction begins."""
    return int(np.argmin(series.separation)) if series.separation.size else 0


def _lowest_of_retraction(series: PathSeries) -> dict[str, float]:
    """The lowest state passed, and how far the parabola through it and its neighbours goes below."""
    turn = _turn(series)
    pressure, separation = series.pressure[turn:], series.separation[turn:]
    lowest = int(np.argmin(pressure)) if pressure.size else 0
    if not (0 < lowest < pressure.size - 1 and pressure[lowest] < 0):
        return {}
    near = slice(lowest - 1, lowest + 2)
    if not np.all(np.isfinite(separation[near])):  # torn off right after it: no parabola goes through infinity
        return {"pull_off_pressure": float(pressure[lowest])}
    return {
        "pull_off_pressure": float(pressure[lowest]),
        "pull_off_pressure_resolution_error": _depth(separation[near], pressure[near]),
    }


def _depth(x: np.ndarray, y: np.ndarray) -> float:
    """How far the parabola through three points goes below the middle one, the lowest of them."""
    left, right = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
    curvature = (right - left) / (x[2] - x[0])
    slope = (left * (x[2] - x[1]) + right * (x[1] - x[0])) / (x[2] - x[0])
    return float(slope**2 / (4 * curvature)) if curvature > 0 else 0.0


def _jump_in(series: PathSeries) -> dict[str, float]:
    assert series.energy is not None
    states = np.stack([series.pressure, series.separation, series.energy], axis=-1)[: _turn(series) + 1]
    lost, exchanged = unaccounted(states[:-1], states[1:])
    jumps = np.flatnonzero((lost > UNACCOUNTED * exchanged) & (lost > _NOISE * np.abs(states[:, 2]).max(initial=0.0)))
    if not jumps.size:
        return {}
    first = int(jumps[0])
    return {
        "jump_in_pressure": float(series.pressure[first]),
        "jump_in_separation": float(series.separation[first]),
        "jump_in_separation_resolution_error": float(series.separation[first] - series.separation[first + 1]),
    }


def _work_of_separation(series: PathSeries) -> dict[str, float]:
    """∫−p ds of the last retraction from p = 0 on; beyond its end, where nothing touches, the energy left is due."""
    assert series.energy is not None
    turn = _turn(series)
    pressure, separation = series.pressure[turn:], series.separation[turn:]
    if not series.ends_apart or not (pressure < 0).any():
        return {}
    balances = np.flatnonzero((pressure[:-1] >= 0) & (pressure[1:] < 0))
    if balances.size:
        last = int(balances[-1])
        share = pressure[last] / (pressure[last] - pressure[last + 1])
        at = separation[last] + share * (separation[last + 1] - separation[last])
        pressure, separation = np.append(0.0, pressure[last + 1 :]), np.append(at, separation[last + 1 :])
    return {"work_of_separation": float(trapezoid(-pressure, separation) - series.energy[-1])}


def series_of(steps: Sequence[Mapping[str, Any]], control: str) -> PathSeries:
    """The series of a path from what is kept of its points.

    Parameters
    ----------
    steps : sequence of mapping
        Quantities of each point by names of the schema: the states that its steps passed, or those at the points.
    control : str
        What is prescribed.
    """
    touching = [step["relative_contact_area"] > 0 for step in steps]
    ends_apart = any(touching) and not touching[-1]
    if all("passed_pressure" in step for step in steps):
        pressure, separation, energy = (np.concatenate([step[f"passed_{name}"] for step in steps]) for name in PASSED)
        return PathSeries(pressure, separation, energy, ends_apart)
    known = [step for step in steps if step["converged"]]
    lost = np.array([bool(step["detached"]) for step in known], bool)
    load = np.array([step["applied_pressure" if control == "pressure" else "mean_pressure"] for step in known])
    separation = np.array([step["mean_separation"] for step in known])
    return PathSeries(load, np.where(lost, np.inf, separation), ends_apart=ends_apart)
