"""First guesses of the parameters from landmarks of the curves."""

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from contact_study.inference.curves import MeasuredCurve
from contact_study.inference.fit import Fit
from contact_study.inference.parameters import (
    DISPLACEMENT_ZERO,
    FORCE_ZERO,
    MODULUS,
    RADIUS,
    RANGE,
    SCALE,
    WORK,
    Prior,
)
from contact_study.inference.problem import Model, Problem
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import stress

_FACTORS = (0.3, 1.0, 3.0)  # of work of adhesion and modulus, among which the starts are chosen
_TABOR = (0.2, 1.0, 5.0)
_LIMITING = (0.03, 60.0)  # those at which other models than JKR's and DMT's are like them
_SOFTEST, _HARDEST = 1.0, 1e13  # moduli (Pa) that units in order give
_TABOR_LIMITS = 0.01, 100.0  # theories beyond them differ from their limits by less than curves show


def landmarks(curves: Sequence[MeasuredCurve], known: Mapping[str, Prior]) -> dict[str, float]:
    """Guess radius, work of adhesion and modulus (SI) from pull-off and the largest force.

    Raises
    ------
    InputError
        If the radius is not given where it must be, or units of force and length give no possible modulus.
    """
    found = {name: one.value for name, one in known.items() if name in (RADIUS, WORK, MODULUS)}
    first = max(curves, key=lambda curve: float(np.ptp(curve.force)))
    load = first.force - (first.rest or 0.0)
    top, lowest = int(np.argmax(load)), int(np.argmin(load))
    row = {axis: first.points[at] for at, axis in enumerate(first.rows)}
    depth = None if 0 not in row else row[0] - first.compliance * first.force
    if RADIUS not in found:
        if depth is None or 2 not in row:
            raise InputError(
                "radius: force with displacement, or with contact radius, does not determine it beside the work of "
                'adhesion; fix it, radius = "10 um", or give a prior, "10 +- 1 um"'
            )
        found[RADIUS] = float(row[2][top] ** 2 / max(np.ptp(depth), 1e-300))
    radius = found[RADIUS]
    pull = max(-float(load[lowest]), 1e-3 * float(np.ptp(load)))
    found.setdefault(WORK, pull / (1.5 * np.pi * radius))
    if MODULUS not in found:
        force = float(load[top]) + pull
        if 2 in row:
            found[MODULUS] = 0.75 * radius * force / float(row[2][top]) ** 3
        else:
            assert depth is not None
            start = depth[lowest] if load[lowest] < -0.05 * load[top] else np.median(depth[load < 0.05 * load[top]])
            way = max(float(depth[top] - start), 0.05 * float(np.ptp(depth)))
            found[MODULUS] = 0.75 * force / (np.sqrt(radius) * way**1.5)
        if not _SOFTEST < found[MODULUS] < _HARDEST:
            raise InputError(
                f"{first.name}: forces and lengths imply a contact modulus of about {stress(found[MODULUS])}; check "
                "the units of its columns and of the radius"
            )
    return found


def starts(
    model: Model,
    curves: Sequence[MeasuredCurve],
    known: Mapping[str, Prior],
    others: Sequence[Fit] = (),
    guess: Mapping[str, float] | None = None,
    factors: Sequence[float] = _FACTORS,
) -> tuple[Problem, list[np.ndarray]]:
    """The problem of a model and starts of its fit: the guess times factors, and the best of other models.

    A fit of JKR's or DMT's theory is a start of models with a range, from the end that it is a limit of.
    """
    guess = landmarks(curves, known) if guess is None else guess
    reach = float(np.cbrt(guess[RADIUS] * (guess[WORK] / guess[MODULUS]) ** 2))
    limits = {RANGE: (reach / _TABOR_LIMITS[1], reach / _TABOR_LIMITS[0])}
    base = {SCALE: 1.0, RANGE: reach, **guess, **{name: known[name].value for name in (SCALE, RANGE) if name in known}}
    for number, curve in enumerate(curves):
        zero = known.get(DISPLACEMENT_ZERO, Prior(0.0)).value
        base[f"{DISPLACEMENT_ZERO}_{number + 1}"] = zero
        base[f"{FORCE_ZERO}_{number + 1}"] = curve.rest or 0.0
    problem = Problem(model, curves, known, base, limits)
    names = [one.name for one in problem.free]
    scales = [tuple(factors) if name in names and name not in known else (1.0,) for name in (WORK, MODULUS)]
    tabor = _TABOR if RANGE in names and RANGE not in known else (1.0,)
    found = []
    for each in itertools.product(*scales, tabor):
        u = problem.start.copy()
        for name, factor in zip((WORK, MODULUS, RANGE), (*each[:2], 1 / each[2]), strict=True):
            if name in names:
                at = names.index(name)
                u[at] = problem.free[at].coordinate(problem.free[at].value(u[at]) * factor)
        found.append(_placed(problem, u))
    for other in others:
        constants = other.problem.constants(other.best)
        if RANGE in names and RANGE not in constants and WORK in constants:
            span = np.cbrt(constants[RADIUS] * (constants[WORK] / constants[MODULUS]) ** 2)
            for limit in _LIMITING:
                u = problem.start.copy()
                for at, one in enumerate(problem.free):
                    if one.label in other.problem.labels:
                        u[at] = other.best[other.problem.labels.index(one.label)]
                u[names.index(RANGE)] = problem.free[names.index(RANGE)].coordinate(span / limit)
                found.append(u)
    return problem, found


def _placed(problem: Problem, u: np.ndarray) -> np.ndarray:
    """Coordinates with zeros of displacement at which the state of the largest force is where it was measured."""
    for at, one in enumerate(problem.free):
        if one.name != DISPLACEMENT_ZERO or one.curve is None:
            continue
        curve, number = problem.curves[one.curve], one.curve
        top = int(np.argmax(curve.force))
        line = problem.lines(u, number)[int(curve.unloading[top])][-1]
        force = curve.rows.index(1)
        rising = np.maximum.accumulate(line[force])
        u[at] += (curve.points[0, top] - float(np.interp(curve.force[top], rising, line[0]))) / one.unit
    return u
