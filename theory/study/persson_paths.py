"""States of Persson's theory at each point of a loading path."""

import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.optimize import brentq

from theory.persson.contact import PerssonContact
from theory.persson.separation import NegativeSeparation, SeparationCurve, separation_curve
from theory.persson.theory import PerssonTheory
from theory.study.case_theories import CaseTheories
from theory.study.gap_paths import DETACHED, nowhere, undefined

_UNSOUND_GAP = "the mean gap depends on states at higher pressures that did not converge"

# Wavevectors at which the magnification-resolved quantities are stored.
_STORED_WAVEVECTORS = 129
_RESOLVED = ("relative_contact_area_at", "detachment_stress", "effective_work_of_adhesion")

# Quantities that no other theory has.
PERSSONS_OWN = (*_RESOLVED, "contact_stress", "edge_stress", "pressure_pdf_at")

# Largest difference of the detachment stress between states of one branch, and lowest pressure of the search for a mean
# gap, both in units of the full-contact stress.
_SAME_BRANCH, _LOWEST_PRESSURE = 1e-2, 1e-9


def persson_path(
    theories: CaseTheories, stress: np.ndarray | str = "adhered", start: int = 0
) -> Iterator[tuple[dict[str, Any], np.ndarray | str]]:
    """Values and detachment stress at each path point from number ``start`` on.

    Each state starts from the one before, since under tension the branch matters; the first starts from ``stress``.
    Under compression the separation curve, which follows the adhered branch, gives a better start.
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
            values = _unreachable(case.path[number][0])
        else:
            before = pressures[number - 1] if number else np.nan
            first = _first(curve, pressures[number], before, stress)
            contact = theory.at_pressure(pressures[number], first, *theories.effort)
            stress = contact.detachment_stress
            values = _persson_values(contact) | {"mean_gap": float(gaps[number])}
            if np.isfinite(gaps[number]) and not curve.converged_above(pressures[number]):
                values |= {"converged": False, "message": values["message"] or _UNSOUND_GAP}
        if asked:
            zetas = magnifications(theory, asked)
            known = not np.isnan(pressures[number])
            unknown = lambda edges: np.tile(undefined(edges), (asked, 1))  # noqa: E731
            values["pressure_pdf_at"] = contact.stress_densities(zetas) if known else unknown
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
    tolerance, max_iterations = theories.effort

    def sweep(lowest: float) -> SeparationCurve:
        return separation_curve(theory, lowest, tolerance=tolerance, max_iterations=max_iterations)

    if case.loading.control == "pressure":
        # Under tension alone there is no separation: the curve stays short.
        lowest = min((p for p, _ in case.path if p > 0), default=theory.stress_scale)
        return sweep(min(lowest, theory.stress_scale))
    curve = sweep(1e-3 * theory.stress_scale)
    largest = max(gap for gap, _ in case.path)
    ends = _quiet_gap(curve, curve.pressure[:2])
    growth = ends[0] - ends[1]
    if ends[0] > largest or growth <= 0:  # reached, or limited by strong sticking
        return curve
    # At light load the gap grows by the same step with every decade less pressure; one decade in reserve.
    decades = (largest - ends[0]) / growth * np.log10(curve.pressure[1] / curve.pressure[0]) + 1
    lowest = max(curve.pressure[0] * 10.0 ** (-decades), _LOWEST_PRESSURE * theory.stress_scale)
    return sweep(lowest)


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
    theory = contact.theory
    if contact.detached:
        return DETACHED | {
            **{name: np.zeros(_STORED_WAVEVECTORS) for name in _RESOLVED},
            **dict.fromkeys(("contact_stress", "edge_stress"), 0.0),
            "pressure_pdf": nowhere,
            "message": "detached: the adhered branch ends above this pressure",
            "stress_balance": np.nan,
            "iterations": contact.iterations,
        }
    stored, nodes = np.log(stored_wavevectors(theory)), np.log(theory.wavevectors)
    message = ""
    if contact.pressure <= 0:
        message = "the theory's mean gap diverges at zero pressure and is not defined under tension"
    elif not contact.converged:
        message = "the detachment stress did not converge; " * contact.balanced + contact.advice
    values = contact.quantities() | {"message": message}
    return values | {name: np.interp(stored, nodes, values[name]) for name in _RESOLVED}


def _unreachable(gap: float) -> dict[str, Any]:
    """Values of a prescribed mean gap that Persson's theory has no pressure for: NaN."""
    names = ("mean_pressure", "relative_contact_area", "elastic_energy", "interaction_energy", "contact_stress")
    lost: dict[str, Any] = dict.fromkeys((*names, "edge_stress", "stress_balance", "residual"), float("nan"))
    return lost | {
        **{name: np.full(_STORED_WAVEVECTORS, np.nan) for name in _RESOLVED},
        "pressure_pdf": undefined,
        "mean_gap": gap,
        "converged": False,
        "detached": False,
        "message": "the theory has no pressure for this mean gap",
        "iterations": 0,
    }
