"""The mean gap from the interfacial energy, ū(p) = ∫_p^∞ (dU/dp') dp'/p', as an integral over ln p."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(6)


@dataclass(frozen=True, eq=False)
class GapIntegral:
    """The integral over a cubic spline of U(ln p).

    Attributes
    ----------
    pressure, energy : numpy.ndarray, shape (n,)
        Increasing p > 0 (Pa) and U (J/m²).
    full_energy : float
        U at infinite pressure (J/m²), reached from the last pressure at that pressure.
    """

    pressure: np.ndarray
    energy: np.ndarray
    full_energy: float

    def gap(self, x: np.ndarray) -> np.ndarray:
        """ū at x = ln p within the pressures (m)."""
        nodes = self._spline.x
        interval = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
        return self._above[interval + 1] + self._between(x, nodes[interval + 1])

    @cached_property
    def _spline(self) -> CubicSpline:
        return CubicSpline(np.log(self.pressure), self.energy)

    @cached_property
    def _above(self) -> np.ndarray:
        """ū at the pressures."""
        parts = self._between(self._spline.x[:-1], self._spline.x[1:])
        rest = (self.full_energy - self.energy[-1]) / self.pressure[-1]
        return np.concatenate([np.cumsum(parts[::-1])[::-1], [0.0]]) + rest

    def _between(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """∫ (dU/dx) e^(−x) dx between points of one interval of the spline, by Gauss's rule."""
        half = 0.5 * (end - start)
        inside = start[..., None] + half[..., None] * (1 + _POINTS)
        return half * np.sum(_WEIGHTS * self._spline(inside, 1) * np.exp(-inside), axis=-1)
