"""The curve of equilibrium of a sphere, and the states on it under a prescribed force or displacement."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import ClassVar, NamedTuple

import numpy as np

from contact_study.numerics.arguments import finite

Number = float | np.ndarray
_DENSE = 20_001  # states on the whole curve, of which those shown are chosen
_EXACT = 4e-16


def check(least: Number | None = None, **numbers: Number) -> None:
    """Refuse numbers that are not finite, or not positive, or less than something if that is given."""
    for name, value in numbers.items():
        if least is None and isinstance(value, float) and 0 < value < np.inf:  # a fit asks often
            continue
        given = np.asarray(value, dtype=float)
        if not np.all(np.isfinite(given) & (given > 0 if least is None else given >= least)):
            bound = "positive" if least is None else f"at least {float(np.min(least)):g}"
            raise ValueError(f"{name} = {value!r}: must be finite and {bound}")


class SphereCurve(NamedTuple):
    """States of a sphere along its curve of equilibrium, from loose to pressed.

    Attributes
    ----------
    force, displacement, contact_radius : numpy.ndarray
        Force (N, compression positive), displacement beyond first touch (m) and radius of the contact (m).
    held : numpy.ndarray
        Whether a state is stable under a prescribed displacement.

    Examples
    --------
    :meth:`SphereTheory.curve` returns one.
    """

    force: np.ndarray
    displacement: np.ndarray
    contact_radius: np.ndarray
    held: np.ndarray


@dataclass(frozen=True)
class SphereTheory(ABC):
    """A smooth sphere on a half-space after one theory; a subclass gives the states along a coordinate of the curve.

    Parameters
    ----------
    radius, contact_modulus : float
        Radius R (m) and contact modulus E* (Pa), positive as all constants of a subclass.

    Examples
    --------
    >>> from theory import DMT, JKR
    >>> spheres = JKR(1e-6, 1e9, 0.05), DMT(1e-6, 1e9, 0.05)
    >>> [f"{sphere.pull_off_force:.3g}" for sphere in spheres]
    ['-2.36e-07', '-3.14e-07']
    """

    radius: float
    contact_modulus: float
    _start: ClassVar[float] = 0.0  # coordinate of the loosest state

    def __post_init__(self) -> None:
        check(**{one.name: getattr(self, one.name) for one in fields(self)})

    @abstractmethod
    def states(self, coordinate: Number) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Force (N), displacement (m) and contact radius (m) at a coordinate, which grows from loose to pressed."""

    @property
    def pull_off_force(self) -> float:
        """Least force of the curve (N), at which a prescribed force detaches the sphere."""
        return float(self.states(self._fold(0))[0])

    @property
    def pull_off_displacement(self) -> float:
        """Least displacement of the curve (m), at which a prescribed displacement detaches the sphere."""
        return float(self.states(self._fold(1))[1])

    def at_force(self, force: float) -> tuple[float, float, float]:
        """Calculate force (N), displacement (m) and contact radius (m) of the stable state at a force.

        Parameters
        ----------
        force : float
            Prescribed force (N), no lower than the pull-off force.

        Returns
        -------
        tuple of float

        Raises
        ------
        ValueError
            If no state carries the force.

        Examples
        --------
        >>> from theory import JKR
        >>> f"{JKR(1e-6, 1e9, 0.05).at_force(0.0)[2]:.3g}"
        '8.91e-08'
        """
        return self._at("force", 0, force)

    def at_displacement(self, displacement: float) -> tuple[float, float, float]:
        """Calculate force (N), displacement (m) and contact radius (m) of the stable state at a displacement.

        Parameters
        ----------
        displacement : float
            Prescribed displacement (m), no less than the pull-off displacement.

        Returns
        -------
        tuple of float

        Raises
        ------
        ValueError
            If no state on the curve has the displacement.

        Examples
        --------
        >>> from theory import Hertz
        >>> f"{Hertz(1e-6, 0.75e9).at_displacement(1e-8)[0]:.3g}"
        '1e-06'
        """
        return self._at("displacement", 1, displacement)

    def curve(self, largest_force: float, points: int = 400) -> SphereCurve:
        """Calculate the curve of equilibrium up to a force, unstable states included.

        Parameters
        ----------
        largest_force : float
            Force of the last state (N).
        points : int, optional
            Number of states, evenly along the drawn curve.

        Returns
        -------
        SphereCurve

        Raises
        ------
        ValueError
            If the force is not finite or below pull-off, or there are fewer than two points.

        Examples
        --------
        >>> from theory import JKR
        >>> curve = JKR(1e-6, 1e9, 0.05).curve(1e-6)
        >>> f"{curve.force.min():.3g}"
        '-2.36e-07'
        """
        if points < 2:
            raise ValueError(f"points = {points!r}: a curve has at least 2")
        end = self._coordinate("force", 0, largest_force)
        places = np.linspace(self._start, end, _DENSE)
        found = np.array(self.states(places))
        spans = np.ptp(found[:2], axis=1)
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(found[:2]) / spans[:, None], axis=0))])
        shown = np.unique(np.searchsorted(along, np.linspace(0.0, along[-1], points)).clip(max=_DENSE - 1))
        held = np.arange(_DENSE) >= np.searchsorted(places, self._fold(1))
        force, displacement, radius = found[:, shown]
        return SphereCurve(force, displacement, radius, held[shown])

    def _at(self, name: str, row: int, value: float) -> tuple[float, float, float]:
        force, displacement, radius = self.states(self._coordinate(name, row, value))
        return float(force), float(displacement), float(radius)

    def _coordinate(self, name: str, row: int, value: float) -> float:
        """Coordinate of the stable state at a force (row 0) or displacement (row 1)."""
        from scipy.optimize import brentq  # slow to import

        wanted = finite(name, value, ("N", "m")[row])
        low = self._fold(row)
        least = float(self.states(low)[row])
        if wanted <= least:
            if np.isclose(wanted, least, rtol=1e-9, atol=0.0):
                return low
            raise ValueError(f"{name} = {value:g}: the sphere has detached; its least {name} is {least:g}")
        end = self._beyond(low, lambda x: float(self.states(x)[row]) > wanted)
        return float(brentq(lambda x: float(self.states(x)[row]) - wanted, low, end, xtol=1e-300, rtol=_EXACT * 4))

    def _fold(self, row: int) -> float:
        """Coordinate at which force or displacement, followed from a pressed state, is least."""
        from scipy.optimize import minimize_scalar  # slow to import

        end = self._beyond(self._start, lambda x: float(self.states(x)[row]) > 0)
        places = np.linspace(self._start, end, _DENSE)
        rising = np.diff(self.states(places)[row]) > 0
        at = _DENSE - 1 - int(np.argmin(rising[::-1])) if not rising.all() else 0
        if at in (0, _DENSE - 1):
            return float(places[at])
        bounds, width = (places[at - 1], places[at + 1]), places[1] - places[0]
        found = minimize_scalar(
            lambda x: float(self.states(x)[row]), bounds=bounds, method="bounded", options={"xatol": 1e-8 * width}
        )
        return float(found.x)

    def _beyond(self, start: float, reached: Callable[[float], bool]) -> float:
        """A coordinate above another one, at which a condition holds that holds of all pressed states."""
        span = 1.0
        while not reached(start + span):
            span *= 1.5
        return start + span
