"""A law measured or computed elsewhere, by its traction at a number of gaps: monotone between them, of no other peak.

Below the first gap the repulsion is a power of the gap of the value and slope there. Beyond the last one tension fades
as the exponential through the last two points, whose slope the interpolant takes: its own is zero where they are steep.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from contact_study.physics.laws.base import LawAtLength, solved

# Tension at the last gap, over the table's peak, up to which an end is guessed.
_LARGEST_END = 0.05
# Least power of the gap with which the repulsion grows at the first gaps.
_LEAST_POWER = 2.0
_FEWEST_POINTS = 5


@dataclass(frozen=True, eq=False)
class TabulatedLaw(LawAtLength):
    """A law through a table; make it with :meth:`through`, which finds its work of adhesion and equilibrium distance.

    Parameters
    ----------
    gaps, tractions : numpy.ndarray, shape (points,)
        The table (m, Pa).

    Examples
    --------
    >>> import numpy as np
    >>> from bem_adhesion import LennardJones104, TabulatedLaw
    >>> gap, law = np.geomspace(2e-10, 3e-9, 200), LennardJones104(0.05, 3e-10)
    >>> f"{TabulatedLaw.through(gap, law.traction(gap)).work_of_adhesion:.3f}"
    '0.050'
    """

    title = "tabulated"
    words = "A law by a table"
    gaps: np.ndarray
    tractions: np.ndarray

    @classmethod
    def through(cls, gaps: Sequence[float] | np.ndarray, tractions: Sequence[float] | np.ndarray) -> "TabulatedLaw":
        """The law through a table of gaps (m) and tractions (Pa, tension positive); ValueError if it is no law."""
        gap, traction = (np.asarray(values, dtype=float) for values in (gaps, tractions))
        _check(gap, traction)
        first = int(np.argmax(traction > 0))
        bare = cls(1.0, 1.0, gap, traction)
        interpolant = bare._between
        if traction[first - 1] == 0:
            length = float(gap[first - 1])
        else:
            from scipy.optimize import brentq  # slow to import

            length = float(brentq(interpolant, gap[first - 1], gap[first], xtol=1e-15 * gap[first], rtol=1e-15))
        return replace(bare, work_of_adhesion=-float(bare.potential(np.array(length))), length=length)

    @cached_property
    def _between(self) -> Any:
        from scipy.interpolate import CubicHermiteSpline, PchipInterpolator  # slow to import

        _, tension, fading = self._end
        slopes = PchipInterpolator(self.gaps, self.tractions).derivative()(self.gaps)
        # Up to three times the secant a cubic is monotone; the exponential has less, unless its length is the bound.
        secant = (self.tractions[-1] - self.tractions[-2]) / (self.gaps[-1] - self.gaps[-2])
        slopes[-1] = max(-tension / fading, 3 * secant)
        return CubicHermiteSpline(self.gaps, self.tractions, slopes)

    @cached_property
    def _slope(self) -> Any:
        return self._between.derivative()

    @cached_property
    def _work(self) -> Any:
        return self._between.antiderivative()

    @cached_property
    def _core(self) -> tuple[float, float, float]:
        """First gap, its pressure and the power of the gap with which that grows."""
        gap, pressure = float(self.gaps[0]), -float(self.tractions[0])
        return gap, pressure, gap * float(self._slope(gap)) / pressure

    @cached_property
    def _end(self) -> tuple[float, float, float]:
        """Last gap, its tension, and the length over which that fades, at most the distance from the peak."""
        gap, tension = float(self.gaps[-1]), float(self.tractions[-1])
        longest = gap - self.peak_distance
        if tension == 0:
            return gap, 0.0, longest
        fall = math.log(self.tractions[-2]) - math.log(tension)
        step = float(self.gaps[-1] - self.gaps[-2])
        return gap, tension, step / max(fall, step / longest)

    def _pieces(self, gap: np.ndarray, core: Any, between: Any, end: Any) -> np.ndarray:
        """One function of the gap below, one within and one beyond the table."""
        gap = np.asarray(gap, dtype=float)
        result = np.asarray(between(np.clip(gap, self.gaps[0], self.gaps[-1])))
        near, far = gap < self.gaps[0], gap > self.gaps[-1]
        if near.any():
            result = np.where(near, core(self.gaps[0] / np.where(near, gap, 1.0)), result)
        if far.any():
            result = np.where(far, end(np.where(far, gap, self.gaps[-1])), result)
        return result

    def potential(self, gap):
        first, pressure, power = self._core
        last, tension, fading = self._end
        at_last, at_first = -tension * fading, -tension * fading - float(self._work(last))
        return self._pieces(
            gap,
            lambda s: at_first + pressure * first / (power - 1) * (s ** (power - 1) - 1),
            lambda d: at_last - (self._work(last) - self._work(d)),
            lambda d: at_last * np.exp(-(d - last) / fading),
        )

    def traction(self, gap):
        _, pressure, power = self._core
        last, tension, fading = self._end
        return self._pieces(
            gap, lambda s: -pressure * s**power, self._between, lambda d: tension * np.exp(-(d - last) / fading)
        )

    def stiffness(self, gap):
        first, pressure, power = self._core
        last, tension, fading = self._end
        return self._pieces(
            gap,
            lambda s: pressure * power / first * s ** (power + 1),
            self._slope,
            lambda d: -tension / fading * np.exp(-(d - last) / fading),
        )

    def repulsive_gap(self, traction):
        wanted = np.minimum(np.asarray(traction, dtype=float), 0.0)
        first, pressure, power = self._core
        rising, tiny = int(np.argmax(self.tractions > 0)) + 1, np.finfo(float).tiny
        # The points around the value are known; within them Newton, by halves where it leaves them.
        right = np.clip(np.searchsorted(self.tractions[:rising], wanted, side="right"), 1, rising - 1)
        low, high = self.gaps[right - 1], self.gaps[right]
        gap = solved(self._between, lambda x: np.maximum(self._slope(x), tiny), wanted, low, high, 0.5 * (low + high))
        deep = np.maximum(-wanted, pressure) / pressure
        gap = np.where(-wanted > pressure, first * deep ** (-1 / power), gap)
        return np.where(wanted == 0, self.length, np.minimum(gap, self.length))

    @property
    def peak_distance(self) -> float:
        return float(self.gaps[np.argmax(self.tractions)])

    @cached_property
    def strongest_softening(self) -> float:
        # The slope is a parabola between two points: lowest at one of them or at its vertex, where the curvature ends.
        bends = self._slope.derivative().roots(extrapolate=False)
        outside = np.concatenate([self.gaps, bends[np.isfinite(bends)]])
        return -float(self.stiffness(outside[outside >= self.length]).min())

    def scaled(self, length: float, stress: float) -> Self:
        law = super().scaled(length, stress)
        return replace(law, gaps=self.gaps / length, tractions=self.tractions / stress)


def _check(gap: np.ndarray, traction: np.ndarray) -> None:
    """Raise ValueError for a table that is no law."""
    if gap.ndim != 1 or gap.shape != traction.shape or gap.size < _FEWEST_POINTS:
        raise ValueError(f"needs at least {_FEWEST_POINTS} gaps, and as many tractions as gaps")
    if not (np.all(np.isfinite(gap)) and np.all(np.isfinite(traction))):
        raise ValueError("holds what is no finite number")
    if not gap[0] > 0 or np.any(np.diff(gap) <= 0):
        raise ValueError("must have positive gaps in increasing order")
    if not traction[0] < 0:
        flipped = traction[0] > 0 > traction.min()
        raise ValueError(
            "has no core: at its smallest gap the traction must be negative, a repulsion"
            + ("; tension is positive here, so change all signs if the table counts it negative" if flipped else "")
        )
    if not traction.max() > 0:
        raise ValueError('does not attract: no traction is positive; law = "repulsive" is a repulsion alone')
    first = int(np.argmax(traction > 0))
    if np.any(np.diff(traction[: first + 1]) <= 0):
        raise ValueError(
            f"must fall steadily in its core: up to a gap of {gap[first]:g} m the traction has to rise from point to "
            "point; smooth the measurement there"
        )
    if np.any(traction[first:] < 0):
        at = gap[first + int(np.argmax(traction[first:] < 0))]
        raise ValueError(
            f"repels again at a gap of {at:g} m: there may be one distance of zero stress, no more; smooth the "
            "measurement there, or end the table before"
        )
    # Solvers take surfaces pulled past the peak to detach, and to be out of reach where the tension is gone.
    peak = int(np.argmax(traction))
    rises = np.diff(traction) > 0
    strays = np.flatnonzero(np.concatenate([np.diff(traction[first : peak + 1]) < 0, rises[peak:]]))
    if strays.size:
        raise ValueError(
            f"has a second peak of tension, near a gap of {gap[first + int(strays[0])]:g} m: it has to rise to "
            "one and fall from there on; smooth the measurement there"
        )
    if traction[-1] > _LARGEST_END * traction.max():
        raise ValueError(
            f"ends at a tension of {traction[-1] / traction.max():.2g} of its peak; go on to where it is below "
            f"{_LARGEST_END:g}"
        )
    from scipy.interpolate import PchipInterpolator  # slow to import

    power = -gap[0] * float(PchipInterpolator(gap, traction).derivative()(gap[0])) / traction[0]
    if power < _LEAST_POWER:
        raise ValueError(
            f"has no core: at its smallest gaps the repulsion grows as the power {power:.2g} of 1/gap, which keeps no "
            f"surfaces apart; add smaller gaps, until it is {_LEAST_POWER:g} or more"
        )
