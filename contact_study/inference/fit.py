"""Least squares of a problem, its curvature, and profiles of the likelihood."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from contact_study.inference.problem import Problem

CONFIDENCE = 0.9
_ROUNDS = 3  # of the fit with errors of the size of its residuals
_FURTHEST = 40  # points of a profile on each side
_SLOW, _PAST = 0.25, 2.5  # of the threshold: a lesser rise lengthens the step, a rise to more shortens it
_FINEST = 0.02  # of the way from the best value: least step


@dataclass
class Profile:
    """Rise of minus twice the logarithm of the likelihood along one parameter, minimised over the others.

    Attributes
    ----------
    coordinate, rise : numpy.ndarray
        Coordinates in ascending order, and the rise there.
    others : numpy.ndarray
        Coordinates of all parameters at each of them, shape (points, parameters).
    interval : tuple of float
        Ends of the interval in the coordinate; infinite where the profile does not close.
    """

    coordinate: np.ndarray
    rise: np.ndarray
    others: np.ndarray
    interval: tuple[float, float]


@dataclass
class Fit:
    """Best parameters of a problem.

    Attributes
    ----------
    problem : Problem
        What was fitted; its errors have the size of the residuals if they were not known.
    best : numpy.ndarray
        Coordinates.
    covariance : numpy.ndarray
        Of the coordinates, by the curvature.
    misfit : float
        Minus twice the logarithm of the likelihood, up to a constant of the data.
    reduced : float
        Sum of squares over degrees of freedom, with the errors before they were scaled.
    threshold : float
        Rise of a profile at the ends of its interval.
    profiles : dict of Profile
        By label.
    """

    problem: Problem
    best: np.ndarray
    covariance: np.ndarray
    misfit: float
    reduced: float
    threshold: float
    profiles: dict[str, Profile] = field(default_factory=dict)

    @property
    def data_count(self) -> int:
        """Number of independent measured values."""
        return self.problem.data

    @property
    def bic(self) -> float:
        """Bayesian information criterion, G. Schwarz, Ann. Stat. 6, 461–464 (1978)."""
        return self.misfit + self.best.size * float(np.log(self.problem.data))


def minimise(problem: Problem, start: np.ndarray, held: Mapping[int, float] | None = None) -> np.ndarray:
    """Coordinates of the least sum of squares from a start, some of them held."""
    from scipy.optimize import least_squares  # slow to import

    fixed = held or {}
    moving = [number for number in range(start.size) if number not in fixed]
    low, high = problem.bounds()
    whole = np.clip(start, low + 1e-9, high - 1e-9)
    for number, value in fixed.items():
        whole[number] = value

    def at(part: np.ndarray) -> np.ndarray:
        full = whole.copy()
        full[moving] = part
        return full

    if not moving:
        return whole
    found = least_squares(
        lambda part: problem.residuals(at(part)),
        whole[moving],
        jac=lambda part: problem.jacobian(at(part), moving),
        bounds=(low[moving], high[moving]),
        x_scale="jac",
        xtol=1e-6,
        ftol=1e-6,
        max_nfev=60,
    )
    return at(found.x)


def fit(problem: Problem, starts: Sequence[np.ndarray]) -> Fit:
    """Fit a problem from the best of several starts.

    Parameters
    ----------
    problem : Problem
        Its errors are scaled if they are not known.
    starts : sequence of numpy.ndarray
        Coordinates; the two with the least sum of squares are followed.

    Returns
    -------
    Fit
        Without profiles.
    """
    from scipy.special import chdtri, stdtrit

    ranked = sorted(starts, key=lambda start: sum(problem.cost(start)))
    found = [minimise(problem, start) for start in ranked[:2]]
    best = min(found, key=lambda one: sum(problem.cost(one)))
    known = all(curve.known for curve in problem.curves)
    freedom = max(problem.data - best.size, 1)
    scale = 1.0
    for _ in range(0 if known else _ROUNDS):
        factor = float(np.sqrt(max(problem.cost(best)[0] / freedom, 1e-12)))
        scale *= factor
        problem.errors = [errors * factor for errors in problem.errors]
        best = minimise(problem, best)
        if abs(factor - 1) < 1e-2:
            break
    squares, priors = problem.cost(best)
    misfit = priors + (squares if known else problem.data * float(np.log(squares * scale**2 / problem.data)))
    jacobian = problem.jacobian(best)
    covariance = np.linalg.pinv(jacobian.T @ jacobian)
    threshold = chdtri(1, 1 - CONFIDENCE) if known else stdtrit(freedom, 0.5 + CONFIDENCE / 2) ** 2
    return Fit(problem, best, covariance, misfit, squares * scale**2 / freedom, float(threshold))


def profile(found: Fit, label: str) -> Profile:
    """Follow the profile of a parameter from the best value to both sides until it closes or meets its limits.

    States along the profiles of ``found.profiles`` are starts, too: valleys of the likelihood may be bent.
    """
    problem, number = found.problem, found.problem.labels.index(label)
    base = sum(problem.cost(found.best))
    ends, points = [], [(float(found.best[number]), 0.0, found.best)]
    for sign, limit in ((-1, problem.free[number].low), (1, problem.free[number].high)):
        way, end = _one_side(found, number, base, sign, limit)
        ends.append(end)
        points += way
    points.sort(key=lambda one: one[0])
    coordinate, rise, others = (np.array(part) for part in zip(*points, strict=True))
    return Profile(coordinate, rise, others, (ends[0], ends[1]))


def _one_side(
    found: Fit, number: int, base: float, sign: int, limit: float
) -> tuple[list[tuple[float, float, np.ndarray]], float]:
    """States of a profile on one side, and its crossing of the threshold, infinite without one."""
    problem, level = found.problem, found.threshold
    step = 0.4 * float(np.clip(np.sqrt(found.covariance[number, number]), 1e-6, 1.0))
    last = before = (float(found.best[number]), 0.0, found.best)
    way: list[tuple[float, float, np.ndarray]] = []
    for _ in range(_FURTHEST):
        at = float(min(max(last[0] + sign * step, min(limit, last[0])), max(limit, last[0])))
        ahead = (at - last[0]) / (last[0] - before[0]) if last is not before else 0.0
        tried = [last[2] + ahead * (last[2] - before[2])]
        tried += [one.others[np.argmin(np.abs(one.others[:, number] - at))] for one in found.profiles.values()]
        tried = [np.clip(one, *problem.bounds()) for one in tried]
        for one in tried:
            one[number] = at
        here = minimise(problem, min(tried, key=lambda one: sum(problem.cost(one))), {number: at})
        new = (at, max(sum(problem.cost(here)) - base, 0.0), here)
        if new[1] > _PAST * level and step > _FINEST * abs(at - found.best[number]):
            step *= 0.35  # too far for an interpolation
            continue
        way.append(new)
        if new[1] > level:
            return way, _crossing(last, new, level)
        if at == limit:
            break
        if new[1] - last[1] < _SLOW * level:
            step *= 1.5
        before, last = last, new
    return way, float(sign * np.inf)


def _crossing(inside: tuple[float, float, np.ndarray], outside: tuple[float, float, np.ndarray], level: float) -> float:
    """Coordinate at which the root of the rise, nearly linear, meets that of the threshold."""
    roots = np.sqrt([inside[1], outside[1], level])
    share = (roots[2] - roots[0]) / max(roots[1] - roots[0], 1e-12)
    return inside[0] + float(np.clip(share, 0, 1)) * (outside[0] - inside[0])
