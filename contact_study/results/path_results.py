"""Results of the equilibrium states that a path passes: pull-off, jump-in, work of approach and of separation.

Between two states the load does the work −∫p ds per area; a branch stores all of it as energy, a jump does not. With a
spring in series the load acts on its far end, and the energy includes the spring's.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_study.results.percolation import PERCOLATION
from contact_study.results.state import PASSED, Variable

UNACCOUNTED = 0.02  # share of the exchanged work and energy that a smooth step may leave unaccounted for
_NOISE = 1e-6  # share of a path's largest energy below which a loss is an error of the solver, not a jump

_PRESSURE, _SEPARATION, _ENERGY = range(3)

_WORK = "work of separation of the last retraction per nominal area, from zero pressure on"
_GAINED = "work of the attraction on the load per nominal area, from separation to the first zero"
PATH_RESULTS: dict[str, Variable] = {
    "pull_off_pressure": Variable("Pa", "pull-off pressure: lowest mean pressure in contact", ()),
    "jump_in_pressure": Variable("Pa", "mean pressure of the last state before the first jump-in", ()),
    "jump_in_separation": Variable("m", "mean separation of the last state before the first jump-in", ()),
    "work_of_approach": Variable("J m-2", _GAINED, ()),
    "work_of_separation": Variable("J m-2", _WORK, ()),
    "pull_off_force": Variable("N", "pull-off force: pull_off_pressure times the nominal area", ()),
    "jump_in_force": Variable("N", "force before the first jump-in: jump_in_pressure times the nominal area", ()),
    "approach_energy": Variable("J", "work_of_approach times the nominal area", ()),
    "separation_energy": Variable("J", "work_of_separation times the nominal area", ()),
    **PERCOLATION,
}
_TIMES_AREA = {
    "pull_off_pressure": "pull_off_force",
    "jump_in_pressure": "jump_in_force",
    "work_of_approach": "approach_energy",
    "work_of_separation": "separation_energy",
}
_ERROR = "_resolution_error"


@dataclass(frozen=True)
class PathSeries:
    """The equilibrium states that a path passes, in order."""

    # Mean pressure (Pa), the load where surfaces detached under it; mean separation (m), infinite there; elastic and
    # interaction energy, with plastic work (J/m²); viscous dissipation so far, if any. Without energies, two columns,
    # points are too far apart to integrate.
    states: np.ndarray
    ends_apart: bool = False  # whether the path has contact, but not at its end
    points: np.ndarray | None = None  # numbers of the path's own points, between which it goes one way; default all
    begins_apart: bool = False  # whether the path begins without contact
    compliance: float = 0.0  # of a spring in series, per area (m/Pa): the states are those of :func:`beyond_spring`
    apart: float = 0.0  # of the energies what is left at full separation (J/m²): plastic, dissipated, or still elastic


def beyond_spring(states: np.ndarray, compliance: float) -> np.ndarray:
    """States, shape (..., columns), at the far end of a spring of this compliance (m/Pa)."""
    if not compliance:
        return states
    found, pressure = states.copy(), states[..., _PRESSURE]
    found[..., _SEPARATION] -= compliance * pressure
    found[..., _ENERGY] += 0.5 * compliance * pressure**2
    return found


def unaccounted(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Work between states (..., 3 or 4) that energies do not account for, by trapezoids, and exchanged work (J/m²)."""
    way = 0.5 * (after[..., 1] - before[..., 1])
    work = -(before[..., 0] + after[..., 0]) * way
    energies = after[..., _ENERGY:] - before[..., _ENERGY:]
    # Beside balance the work of push and of pull cancel; both are exchanged.
    exchanged = (np.abs(before[..., 0]) + np.abs(after[..., 0])) * np.abs(way) + np.abs(energies).sum(-1)
    return work - energies.sum(-1), exchanged


def undecided(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Uncertainty of the work of a step that is a jump (J/m²), as its position within the step is unknown."""
    change = after - before
    return 0.5 * np.abs(change[..., 0] * change[..., 1])


def lowest_between(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Lowest pressure (Pa) on a branch between two states: that of the parabola that does the step's work."""
    start, end = before[..., 0], after[..., 0]
    stored = (after[..., _ENERGY:] - before[..., _ENERGY:]).sum(-1) / (after[..., 1] - before[..., 1])
    # p = start + (end − start) t + bend t (1 − t), of mean (start + end)/2 + bend/6
    bend = -6 * (stored + 0.5 * (start + end))
    turn = 0.5 * (1 + np.divide(end - start, bend, out=np.ones_like(bend), where=bend != 0))
    at = np.clip(turn, 0.0, 1.0)
    return np.minimum(np.minimum(start, end), start + (end - start) * at + bend * at * (1 - at))


def path_results(series: PathSeries, control: str) -> dict[str, float]:
    """Pull-off, jump-in and works of approach and separation, by names of the schema, as far as the path has them.

    Under a prescribed pressure the surfaces detach below the pull-off pressure, and neither jump-in nor a finite work
    of separation exists. At a prescribed distance the path passes the lowest pressure.
    """
    if not len(series.states):  # no state of the path converged
        return {}
    if control == "pressure":
        return _lost_under_load(series.states)
    approach, retraction = _ways(series)
    found = _lowest_of_retraction(retraction)
    if series.states.shape[1] > _ENERGY:
        found |= _jump_in(approach, series.compliance)
        if series.begins_apart and approach[-1, _PRESSURE] >= 0:
            lost, *jumps = _jumps(approach)  # on the reversed way what is lost is gained
            found |= _work_outwards("work_of_approach", approach[::-1], -lost[::-1], *(each[::-1] for each in jumps))
        if series.ends_apart:
            found |= _work_outwards("work_of_separation", retraction, *_jumps(retraction), apart=series.apart)
    return found


def with_forces(results: Mapping[str, float], area: float) -> dict[str, float]:
    """Complete path results by forces (N) and energies (J) on a nominal area (m²), with their errors."""
    found = dict(results)
    for name, total in _TIMES_AREA.items():
        found |= {f"{total}{end}": results[name + end] * area for end in ("", _ERROR) if name + end in results}
    return found


def _lost_under_load(states: np.ndarray) -> dict[str, float]:
    """The lowest pressure that was carried before one that was not, and the difference."""
    apart = np.isinf(states[:, _SEPARATION])
    last = np.flatnonzero(~apart[:-1] & apart[1:])
    if not last.size:
        return {}
    # Under no load surfaces that attract are held: this is known of every path.
    held = np.minimum(states[last, _PRESSURE], 0.0)
    lowest = int(np.argmin(held))
    return {
        "pull_off_pressure": float(held[lowest]),
        "pull_off_pressure_resolution_error": float(held[lowest] - states[last[lowest] + 1, _PRESSURE]),
    }


def _ways(series: PathSeries) -> tuple[np.ndarray, np.ndarray]:
    """The states up to the path's first turning point, and those of the last retraction from its turning point on."""
    points = np.arange(len(series.states)) if series.points is None else series.points
    distance = series.states[points, _SEPARATION]
    before, after = distance[:-1], distance[1:]
    start = _leading(after >= before)
    turn = start + _leading(after[start:] <= before[start:])
    end = len(points) - 1 - _leading((after < before)[::-1])
    last = end - _leading((before <= after)[:end][::-1])
    return series.states[: points[turn] + 1], series.states[points[last] : points[end] + 1]


def _leading(holds: np.ndarray) -> int:
    """Number of steps before the first that does not hold."""
    return int(np.argmin(np.append(holds, False)))


def _lowest_of_retraction(states: np.ndarray) -> dict[str, float]:
    """The lowest state of a retraction, and how far below it a parabola or a branch falls between its neighbours."""
    pressure, separation = states[:, _PRESSURE], states[:, _SEPARATION]
    lowest = int(np.argmin(pressure))
    if not (0 < lowest < pressure.size - 1 and pressure[lowest] < 0):
        return {}
    found = {"pull_off_pressure": float(pressure[lowest])}
    x, y = separation[lowest - 1 : lowest + 2], pressure[lowest - 1 : lowest + 2]
    if not np.all(np.isfinite(x)):  # torn off right after it: no parabola goes through infinity
        return found
    left, right = np.diff(y) / np.diff(x)
    curvature = (right - left) / (x[2] - x[0])
    slope = (left * (x[2] - x[1]) + right * (x[1] - x[0])) / (x[2] - x[0])
    below = float(slope**2 / (4 * curvature)) if curvature > 0 else 0.0
    if states.shape[1] > _ENERGY:
        smooth = ~_jumps(states)[1] & (np.diff(separation) > 0)
        between = lowest_between(states[:-1][smooth], states[1:][smooth])
        below = max(below, float(pressure[lowest]) - float(np.min(between, initial=pressure.min())))
    return {**found, "pull_off_pressure_resolution_error": below}


def _jumps(states: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Loss of each step, whether it is a jump, and the uncertainty of a jump's work."""
    lost, exchanged = unaccounted(states[:-1], states[1:])
    noise = _NOISE * np.abs(states[:, _ENERGY]).max(initial=0.0)
    return lost, (lost > UNACCOUNTED * exchanged) & (lost > noise), undecided(states[:-1], states[1:])


def _jump_in(states: np.ndarray, compliance: float) -> dict[str, float]:
    """The last state before the first loss that the rule cannot make up, and how far the next one is."""
    lost, jumped, unknown = _jumps(states)
    # Where the pressure only rises or only falls the rule errs by no more than this: beside balance, where little is
    # exchanged, points that meet a wall one by one lose as much, and no energy.
    proven = jumped & (lost > unknown)
    if not proven.any():
        return {}
    first = int(np.argmax(proven))
    pressure, before, after = *states[first, :_ENERGY], states[first + 1, _SEPARATION]
    found = {"jump_in_pressure": pressure, "jump_in_separation": before + compliance * pressure}
    off = 0.0
    if first and (way := states[first - 1, _SEPARATION] - before) > 0:
        # Toward a fold, at the latest at the next state, the pressure goes as the root of the way that is left; half as
        # much again for a step that begins where it does not yet.
        left = max(before - after, 0.0)
        off = 1.5 * abs(pressure - states[first - 1, _PRESSURE]) * (np.sqrt(left * (left + way)) + left) / way
        found["jump_in_pressure_resolution_error"] = off
    found["jump_in_separation_resolution_error"] = before - after + compliance * off
    return {name: float(value) for name, value in found.items()}


def _work_outwards(
    name: str, states: np.ndarray, lost: np.ndarray, jumped: np.ndarray, unknown: np.ndarray, *, apart: float = 0.0
) -> dict[str, float]:
    """∫−p ds of a way outwards from p = 0 on: the energy stored or lost on its branches plus the losses of its jumps.

    The work is the energy of full separation, ``apart`` (J/m²), minus that at p = 0, plus the jumps. A sum of p ds
    would add the errors of the trapezoidal rule along the branches.
    """
    pressure, separation, energy = states[:, _PRESSURE], states[:, _SEPARATION], states[:, _ENERGY:].sum(1)
    if pressure.size < 2 or not (pressure < 0).any():
        return {}
    first, begun, across = 0, float(energy[0]), 0.0
    balances = np.flatnonzero((pressure[:-1] >= 0) & (pressure[1:] < 0))
    if balances.size:
        before, first = int(balances[-1]), int(balances[-1]) + 1
        share = pressure[before] / (pressure[before] - pressure[first])
        balance = separation[before] + share * (separation[first] - separation[before])
        nearer = first if jumped[before] or -pressure[first] <= pressure[before] else before
        begun = float(energy[nearer] + 0.5 * pressure[nearer] * (separation[nearer] - balance))
        if jumped[before]:
            across = float(unknown[before])
    lost, jumped, unknown = lost[first:], jumped[first:], unknown[first:]
    return {
        name: float(lost[jumped].sum()) + (apart - begun),
        name + _ERROR: float(across + unknown[jumped].sum() + abs(lost[~jumped].sum())),
    }


def series_of(steps: Sequence[Mapping[str, Any]], control: str, compliance: float = 0.0) -> PathSeries:
    """Make the series of a path from the quantities of its points; passed states are used if all points have them."""
    touching = [step["relative_contact_area"] > 0 for step in steps]
    ends_apart = any(touching) and not touching[-1]
    if all("passed_pressure" in step for step in steps):
        names = [f"passed_{name}" for name in PASSED if f"passed_{name}" in steps[0]]
        parts = [np.stack([step[name] for name in names], axis=-1) for step in steps]
        parts = [part[~np.isnan(part[:, _PRESSURE])] for part in parts]  # padded, of an earlier dataset
        states, last = np.concatenate(parts), np.cumsum([len(part) for part in parts]) - 1
        states = beyond_spring(states, compliance)
        # In equal steps of time a viscoelastic solid takes up work, so a loss is no jump.
        books = states if all("dissipated_energy" in step for step in steps) else states[:, :_ENERGY]
        apart = steps[-1].get("plastic_work", 0.0)
        if "viscous_dissipation" in steps[-1]:  # its elastic part is dissipated later, without work
            apart += steps[-1]["viscous_dissipation"] + steps[-1]["elastic_energy"]
        # A point that did not converge may have passed none.
        return PathSeries(books, ends_apart, np.unique(last[last >= 0]), not touching[0], compliance, apart)
    load = "applied_pressure" if control == "pressure" else "mean_pressure"
    known = [
        (step[load], np.inf if step["detached"] else step["mean_separation"]) for step in steps if step["converged"]
    ]
    return PathSeries(np.reshape(np.array(known, float), (-1, _ENERGY)), ends_apart)
