"""Residuals of measured curves from the states of a model, as functions of the free parameters."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from contact_study.inference.branches import Branch, held, nearest
from contact_study.inference.curves import MeasuredCurve
from contact_study.inference.parameters import DISPLACEMENT_ZERO, FORCE_ZERO, PHYSICAL, RANGE, SCALE, Prior

_OF_SPAN = 1e-2  # of the span of an axis: unit of an offset
_WIDE = 1e4  # factor by which a physical parameter may move from its start
_STEP = 1e-3  # of differences, in the units of the free parameters: states are those of polylines


class Model(Protocol):
    """States of a contact by constants."""

    @property
    def names(self) -> tuple[str, ...]:
        """Parameters that the model has."""

    def branches(
        self, constants: Mapping[str, float], largest_force: float, start: float, compliance: float
    ) -> tuple[Branch, Branch]:
        """States of approach and retraction up to a force (N), from a displacement (m), on a spring (m/N)."""


@dataclass(frozen=True)
class Free:
    """A free parameter: its name, the curve it belongs to, its unit (SI), and the limits of its coordinate.

    The coordinate of an offset is its value in its unit. Those of physical parameters are logarithms, but that of the
    range is v/(unit + v): a range far above or far below its unit has no effect, and curves then have no slope along
    its logarithm.
    """

    name: str
    curve: int | None
    unit: float
    low: float
    high: float

    @property
    def label(self) -> str:
        """Name, with the number of the curve from 1 on."""
        return self.name if self.curve is None else f"{self.name}_{self.curve + 1}"

    def value(self, u: float) -> float:
        """SI value of a coordinate."""
        if self.curve is not None:
            return u * self.unit
        return u / (1 - u) * self.unit if self.name == RANGE else float(np.exp(u))

    def coordinate(self, value: float) -> float:
        """Coordinate of an SI value."""
        if self.curve is not None:
            return value / self.unit
        return value / (self.unit + value) if self.name == RANGE else float(np.log(value))


class Problem:
    """Curves, a model and what is known beforehand.

    Parameters
    ----------
    model : Model
        States by constants.
    curves : sequence of MeasuredCurve
        Measured points.
    known : mapping of str to Prior
        Fixed values and priors.
    start : mapping of str to float
        First guess of every free parameter by its label.
    limits : mapping, optional
        Least and largest value (SI) of a parameter.

    Examples
    --------
    :func:`contact_study.infer` makes one for each model.
    """

    def __init__(
        self,
        model: Model,
        curves: Sequence[MeasuredCurve],
        known: Mapping[str, Prior],
        start: Mapping[str, float],
        limits: Mapping[str, tuple[float, float]] | None = None,
    ):
        self.model, self.curves, self.known = model, list(curves), dict(known)
        self.fixed = {name: one.value for name, one in known.items() if not one.error}
        self.fixed.setdefault(SCALE, 1.0)
        if SCALE in known and known[SCALE].error:
            del self.fixed[SCALE]
        self.free: list[Free] = []
        for name in PHYSICAL:
            if name in (*model.names, SCALE) and name not in self.fixed:
                ends = (limits or {}).get(name, (start[name] / _WIDE, start[name] * _WIDE))
                one = Free(name, None, float(np.sqrt(ends[0] * ends[1])), -np.inf, np.inf)
                self.free.append(replace(one, low=one.coordinate(ends[0]), high=one.coordinate(ends[1])))
        for number, curve in enumerate(curves):
            for name, row in ((DISPLACEMENT_ZERO, 0), (FORCE_ZERO, 1)):
                if row in curve.rows and name not in self.fixed and (row == 0 or curve.rest is not None):
                    unit = _OF_SPAN * float(np.ptp(curve.points[curve.rows.index(row)]))
                    self.free.append(Free(name, number, unit, -np.inf, np.inf))
        self.start = np.array([one.coordinate(start[one.label]) for one in self.free])
        self.errors = [curve.errors.copy() for curve in curves]
        self._asked, self._found = b"", np.empty(0)

    @property
    def data(self) -> int:
        """Number of independent measured values, without priors."""
        return sum(
            curve.points.shape[1] * (len(curve.rows) - 1) + (curve.pull_off is not None) for curve in self.curves
        )

    @property
    def labels(self) -> list[str]:
        """Labels of the free parameters."""
        return [one.label for one in self.free]

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Limits of the coordinates."""
        return np.array([one.low for one in self.free]), np.array([one.high for one in self.free])

    def constants(self, u: np.ndarray) -> dict[str, float]:
        """SI values of the shared parameters."""
        shared = {one.name: one.value(float(x)) for one, x in zip(self.free, u, strict=True) if one.curve is None}
        return {**self.fixed, **shared}

    def offsets(self, u: np.ndarray, number: int) -> tuple[float, float]:
        """Zeros of displacement (m) and force (N) of a curve."""
        own = {one.name: one.value(float(x)) for one, x in zip(self.free, u, strict=True) if one.curve == number}
        known = (DISPLACEMENT_ZERO, FORCE_ZERO)
        zeros = [own.get(name, self.fixed.get(name, 0.0)) for name in known]
        return zeros[0], zeros[1]

    def lines(self, u: np.ndarray, number: int) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Polylines of approach and of retraction, as the curve would measure them, on its axes."""
        curve, constants = self.curves[number], self.constants(u)
        at, rest = self.offsets(u, number)
        scale = constants[SCALE]
        compliance = curve.compliance * scale
        most = (float(curve.force.max()) - rest) / scale
        first = float(curve.points[0].min()) - at if 0 in curve.rows else 0.0
        ways = self.model.branches(constants, max(most, 1e-3 * float(np.ptp(curve.force))), first, compliance)
        found = []
        for way in ways[: 1 if ways[0] is ways[1] else 2]:
            kept = held(way, compliance)
            parts = kept if 0 in curve.rows else (kept.after,)
            moved = [np.array([at + p[0] + compliance * p[1], rest + scale * p[1], p[2]]) for p in parts]
            found.append([one[list(curve.rows)] for one in moved])
        return found[0], found[-1]

    def residuals(self, u: np.ndarray) -> np.ndarray:
        """Distances of the points from the model in units of their errors, of the pull-off, and from priors."""
        asked = b"".join(one.tobytes() for one in (u, *self.errors))
        if asked != self._asked:  # a fit asks for the value at a point, and again for the slopes there
            parts = [self._of_curve(u, number) for number in range(len(self.curves))]
            self._asked, self._found = asked, np.concatenate([*parts, self._of_priors(u)])
        return self._found

    def signed(self, u: np.ndarray, number: int) -> np.ndarray:
        """Distance of each point of a curve from the model in its errors, with the sign of the force's residual."""
        curve = self.curves[number]
        parts = self._of_curve(u, number)[: curve.points.size].reshape(curve.points.shape)
        return np.sign(parts[curve.rows.index(1)]) * np.sqrt((parts**2).sum(0))

    def cost(self, u: np.ndarray) -> tuple[float, float]:
        """Sums of squares of the measured values and of the priors."""
        found = self.residuals(u)
        priors = self._of_priors(u).size
        return float((found[: found.size - priors] ** 2).sum()), float((found[found.size - priors :] ** 2).sum())

    def jacobian(self, u: np.ndarray, moving: Sequence[int] | None = None) -> np.ndarray:
        """Derivatives of the residuals by differences, shape (residuals, coordinates), by all coordinates or some."""
        base, columns = self.residuals(u), []
        for number in range(u.size) if moving is None else moving:
            step = np.zeros(u.size)
            step[number] = _STEP
            columns.append((self.residuals(u + step) - base) / step[number])
        return np.array(columns).T

    def _of_curve(self, u: np.ndarray, number: int) -> np.ndarray:
        curve, errors = self.curves[number], self.errors[number]
        found = np.empty_like(curve.points)
        lines = self.lines(u, number)
        for way, back in zip(lines, (False, True), strict=True):
            own = curve.unloading == back
            if own.any():
                found[:, own] = (curve.points[:, own] - nearest(curve.points[:, own], way, errors)) / errors[:, None]
        if curve.pull_off is None:
            return found.ravel()
        low, high = curve.pull_off
        detached = float(lines[1][-1][0, 0])
        error = max(float(errors[0]), (high - low) / np.sqrt(12))
        return np.append(found.ravel(), (max(low - detached, 0.0) + min(high - detached, 0.0)) / error)

    def _of_priors(self, u: np.ndarray) -> np.ndarray:
        constants, found = self.constants(u), []
        for name, one in self.known.items():
            if not one.error:
                continue
            if name in constants:
                found.append((constants[name] - one.value) / one.error)
            elif name in (DISPLACEMENT_ZERO, FORCE_ZERO):
                row = (DISPLACEMENT_ZERO, FORCE_ZERO).index(name)
                found += [(self.offsets(u, n)[row] - one.value) / one.error for n in range(len(self.curves))]
        return np.array(found)
