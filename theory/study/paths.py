"""The theories at each point of a loading path."""

import warnings
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import brentq

from contact_study.study.case import Case
from theory.edge_flow.flow import EdgeFlow
from theory.gap_flow.flow import GapFlow
from theory.gap_flow.state import REMEDY
from theory.numerics.background import BackgroundExecutor, BackgroundTask
from theory.persson.separation import NegativeSeparation, NotConverged, SeparationCurve, separation_curve
from theory.persson.theory import PerssonContact, PerssonTheory
from theory.study.case_theories import CaseTheories

_STORED_WAVEVECTORS = 129  # at which the magnification-resolved quantities are stored
_RESOLVED = ("relative_contact_area_at", "detachment_stress", "effective_work_of_adhesion")

# Quantities that no other theory has.
PERSSONS_OWN = (*_RESOLVED, "contact_stress", "edge_stress", "pressure_pdf_at")

# Largest difference of σ_a between states of one branch, and lowest pressure of a search, over the full-contact stress.
_SAME_BRANCH, _LOWEST_PRESSURE = 1e-2, 1e-9


def _nowhere(edges: np.ndarray, value: float = 0.0) -> np.ndarray:
    """Distribution of what is nowhere within any bins."""
    return np.full(edges.size - 1, value)


_undefined = partial(_nowhere, value=np.nan)

# A detached block; its mean gap is infinite where the theory defines one.
_ZERO = ("mean_pressure", "relative_contact_area", "elastic_energy", "interaction_energy", "residual")
_DETACHED: dict[str, Any] = dict.fromkeys(_ZERO, 0.0) | {"stress_balance": np.nan, "pressure_pdf": _nowhere}
_DETACHED |= {"converged": True, "detached": True}


def flow_paths(theories: CaseTheories, start: int = 0) -> list[Callable[[int], dict[str, Any]]]:
    """Values of each flow at the point of a number from ``start`` on; none outside a wall, which no flow goes through.

    A mistake of input is raised at the first point.
    """
    edge_flows = theories.edge_flows
    with theories.naming_the_spectrum():
        found: list[Callable[[int], dict[str, Any]]] = [
            partial(_gap_flow_values, theories.case, flow, begun)
            for flow, begun in zip(theories.gap_flows, theories.gap_flow_states, strict=True)
        ]
        found += [_edge_flow_values(theories.case, flow, theories.ahead, start) for flow in edge_flows]
    return found


def _unknown(names: tuple[str, ...], gap: float, message: str) -> dict[str, Any]:
    """Values of a state that a theory does not have or find: NaN, of some further names too, and flagged."""
    flags = {"mean_gap": gap, "converged": False, "detached": False, "message": message}
    return dict.fromkeys((*_DETACHED, *names), np.nan) | {"pressure_pdf": _undefined} | flags


def _gap_flow_values(case: Case, flow: GapFlow, begun: BackgroundTask, number: int) -> dict[str, Any]:
    state = begun.result()[number]
    values = _come_off(flow.converged) if state is None else state.quantities(case.contact_distance)
    return {f"{flow.name}/{key}": value for key, value in values.items()}


def _edge_flow_values(
    case: Case, flow: EdgeFlow, ahead: BackgroundExecutor, start: int
) -> Callable[[int], dict[str, Any]]:
    if not flow.converged:
        lost = f"{flow.unconverged_states} of {len(flow.equilibria) + flow.lost} mean gaps did not converge"
        sound = ", between pieces of the curve; states of these are sound" if len(flow.pieces) > 1 else ""
        branch = ", unloading" * (flow.branch == "unloading")
        warnings.warn(f"edge flow{branch}: {lost}{sound}", NotConverged, stacklevel=2)
    gaps = [_edge_flow_gap(case, flow, asked) for asked, _ in case.path]
    begun = {
        number: ahead.begin(partial(flow.states, np.array([gap])))
        for number, gap in enumerate(gaps)
        if number >= start and gap is not None and not np.isnan(gap)
    }
    message = f"adhesion is too strong for the edge flow ({flow.limit}); {REMEDY}"

    def values(number: int) -> dict[str, Any]:
        asked, gap = case.path[number][0], gaps[number]
        if gap is None:
            gap = asked if case.loading.control == "gap" else np.nan
            found = _unknown(("relative_repulsive_area", "local_mean_pressure"), gap, message) | {"gap_pdf": _undefined}
        elif np.isnan(gap):
            found = _come_off(flow.converged)
        else:
            (state,) = begun[number].result()
            found = state.quantities(case.contact_distance)
        return {f"{name}/{key}": value for name in flow.names for key, value in found.items()}

    return values


def _edge_flow_gap(case: Case, flow: EdgeFlow, asked: float) -> float | None:
    """Mean gap of a path point (m), NaN where no state carries its pressure; None where the curve does not say."""
    if case.loading.control == "pressure":
        # A curve that ended early does not say what is beyond it, nor one in pieces what is between these.
        gap = flow.gap_at(asked) if asked <= flow.pressure.max() else np.nan
        known = np.isfinite(gap) or (asked <= 0 and asked < flow.pressure.min())
        return gap if known else None
    gap = asked + case.law.equilibrium_distance
    return gap if flow.mean_gap[0] <= gap <= flow.mean_gap[-1] else None


def _come_off(converged: bool) -> dict[str, Any]:
    """Quantities where a curve has no state; one that is not solved does not tell where it ends either."""
    local = {"relative_repulsive_area": 0.0, "local_mean_pressure": 0.0, "gap_pdf": _nowhere}
    return _DETACHED | local | {"mean_gap": np.inf, "converged": converged}


def persson_path(
    theories: CaseTheories, stress: np.ndarray | str = "adhered", start: int = 0
) -> Iterator[tuple[dict[str, Any], np.ndarray | str]]:
    """Values and detachment stress at each path point from number ``start`` on.

    Each state starts from the one before, the first from ``stress``, since under tension the branch matters.
    """
    case, theory = theories.case, theories.persson
    by_pressure = case.loading.control == "pressure"
    asked = 0 if theories.other else case.theory.magnifications
    with theories.naming_the_spectrum():
        curve = _separation(theories)
        pressures = [value if by_pressure else _pressure_at(curve, value) for value, _ in case.path]
        gaps = curve.mean_gap(np.array(pressures))
    for number in range(start, len(case.path)):
        if np.isnan(pressures[number]):
            message = "the theory has no pressure for this mean gap"
            values = _unknown(("contact_stress", "edge_stress"), case.path[number][0], message) | {"iterations": 0}
            values |= dict.fromkeys(_RESOLVED, np.full(_STORED_WAVEVECTORS, np.nan))
            if asked:
                values["pressure_pdf_at"] = lambda edges: np.tile(_undefined(edges), (asked, 1))
        else:
            before = pressures[number - 1] if number else np.nan
            first = _first(curve, pressures[number], before, stress)
            contact = theory.at_pressure(pressures[number], first, *theories.effort)
            stress = contact.detachment_stress
            values = _persson_values(contact) | {"mean_gap": float(gaps[number])}
            if np.isfinite(gaps[number]) and not curve.converged_above(pressures[number]):
                unsound = "the mean gap depends on states at higher pressures that did not converge"
                values |= {"converged": False, "message": values["message"] or unsound}
            if asked:
                values["pressure_pdf_at"] = contact.stress_densities(magnifications(theory, asked))
        yield values, stress


def _first(curve: SeparationCurve, pressure: float, before: float, stress: np.ndarray | str) -> np.ndarray | str:
    """First detachment stress: the curve's, unless the state before, at another pressure, was on another branch."""
    if pressure <= 0:
        return stress
    if isinstance(stress, np.ndarray):
        scale = curve.contacts[0].theory.stress_scale
        if not before > 0 or np.max(np.abs(stress - curve.detachment_stress_at(before))) > _SAME_BRANCH * scale:
            return stress
    return curve.detachment_stress_at(pressure)


def _separation(theories: CaseTheories) -> SeparationCurve:
    """The separation curve down to the lowest pressure, or out to the largest gap, of the path."""
    case, theory = theories.case, theories.persson
    tolerance, most = theories.effort
    sweep = partial(separation_curve, theory, tolerance=tolerance, max_iterations=most)
    if case.loading.control == "pressure":
        # Under tension alone there is no separation: the curve stays short.
        return sweep(min([p for p, _ in case.path if p > 0] + [theory.stress_scale]))
    curve = sweep(1e-3 * theory.stress_scale)
    largest = max(gap for gap, _ in case.path)
    ends = _quiet_gap(curve, curve.pressure[:2])
    growth = ends[0] - ends[1]
    if ends[0] > largest or growth <= 0:  # reached, or limited by strong sticking
        return curve
    # At light load the gap grows by the same step with every decade less pressure; one decade in reserve.
    decades = (largest - ends[0]) / growth * np.log10(curve.pressure[1] / curve.pressure[0]) + 1
    return sweep(max(curve.pressure[0] * 10.0 ** (-decades), _LOWEST_PRESSURE * theory.stress_scale))


def _quiet_gap(curve: SeparationCurve, pressure: np.ndarray | float) -> np.ndarray:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NegativeSeparation)
        return curve.mean_gap(pressure)


def _pressure_at(curve: SeparationCurve, gap: float) -> float:
    """Lowest pressure at which the mean gap has fallen to ``gap``; NaN if the theory reaches no such gap."""
    gaps = _quiet_gap(curve, curve.pressure)
    reached = np.flatnonzero(gaps <= gap)
    if gap <= 0 or reached.size == 0 or reached[0] == 0:
        return float("nan")
    low, high = np.log(curve.pressure[reached[0] - 1 : reached[0] + 1])
    return float(np.exp(brentq(lambda x: float(_quiet_gap(curve, np.exp(x))) - gap, low, high, xtol=1e-10)))


def magnifications(theory: PerssonTheory, count: int) -> np.ndarray:
    """``count`` magnifications ζ > 1, evenly in ln ζ up to the highest; at ζ = 1 all stress is the mean pressure."""
    last = theory.wavevectors[-1] / theory.wavevectors[0]
    return np.geomspace(1.0, last, count + 1)[1:]


def stored_wavevectors(theory: PerssonTheory) -> np.ndarray:
    """Wavevectors at which the magnification-resolved quantities are stored (1/m)."""
    return np.geomspace(theory.wavevectors[0], theory.wavevectors[-1], _STORED_WAVEVECTORS)


def _persson_values(contact: PerssonContact) -> dict[str, Any]:
    if contact.detached:
        own = dict.fromkeys(_RESOLVED, np.zeros(_STORED_WAVEVECTORS)) | {"contact_stress": 0.0, "edge_stress": 0.0}
        message = "detached: the adhered branch ends above this pressure"
        return _DETACHED | own | {"message": message, "iterations": contact.iterations}
    stored, nodes = np.log(stored_wavevectors(contact.theory)), np.log(contact.theory.wavevectors)
    message = ""
    if contact.pressure <= 0:
        message = "the theory's mean gap diverges at zero pressure and is not defined under tension"
    elif not contact.converged:
        message = "the detachment stress did not converge; " * contact.balanced + contact.advice
    values = contact.quantities() | {"message": message}
    return values | {name: np.interp(stored, nodes, values[name]) for name in _RESOLVED}
