"""A roughness spectrum given as numbers: wavevectors and C(q)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.physics.roughness.spectrum import PIECES, RoughnessSpectrum, integrated_variance, power_integral


@dataclass(frozen=True, eq=False)
class TabulatedSpectrum(RoughnessSpectrum):
    """C(q) on a table, a power law between neighbours, zero outside.

    Moments are exact for these power laws, so a self-affine spectrum needs no more than its corners.

    Parameters
    ----------
    wavevectors : array_like, shape (n,)
        q > 0, rising, two at least (1/m).
    density : array_like, shape (n,)
        C(q) > 0 in the convention of :mod:`contact_study.physics.roughness.spectrum`, h_rms² = 2π ∫ q C dq (m⁴).

    Raises
    ------
    ValueError
        If the table is no such table.

    Examples
    --------
    >>> from theory import PerssonTheory, TabulatedSpectrum
    >>> measured = TabulatedSpectrum([1e7, 1e8, 1e9], [1e-33, 1e-33, 1e-37])
    >>> bool(PerssonTheory(measured, elasticity=93.7e9, work_of_adhesion=0.1).at_pressure(1e9).converged)
    True
    """

    wavevectors: np.ndarray
    density: np.ndarray

    def __post_init__(self):
        for name in ("wavevectors", "density"):
            try:
                given = np.array(getattr(self, name), dtype=float)
            except (TypeError, ValueError):
                raise ValueError(f"{name}: expected an array of numbers") from None
            if given.ndim != 1 or given.size < 2 or not np.all(np.isfinite(given) & (given > 0)):
                raise ValueError(f"{name}: expected two positive finite numbers at least, in one row")
            object.__setattr__(self, name, given)
        if self.wavevectors.shape != self.density.shape:
            raise ValueError(
                f"density: {self.density.size} numbers for {self.wavevectors.size} wavevectors; one each is needed"
            )
        if np.any(np.diff(self.wavevectors) <= 0):
            raise ValueError("wavevectors: must rise")

    @property
    def limits(self) -> tuple[float, float]:
        return float(self.wavevectors[0]), float(self.wavevectors[-1])

    @cached_property
    def _exponents(self) -> np.ndarray:
        """Power of q in each piece."""
        return np.diff(np.log(self.density)) / np.diff(np.log(self.wavevectors))

    def density_at(self, wavevector: float | np.ndarray) -> np.ndarray:
        """C(q) (m⁴), zero outside the table."""
        q = np.asarray(wavevector, dtype=float)
        low, high = self.limits
        inside = np.exp(np.interp(np.log(np.clip(q, low, high)), np.log(self.wavevectors), np.log(self.density)))
        return np.where((q >= low) & (q <= high), inside, 0.0)

    def moment(self, order: float, lower: float | None = None, upper: float | np.ndarray | None = None) -> np.ndarray:
        low, high = self.limits
        below = 0.0 if lower is None else self._moment(order, np.clip(lower, low, high))
        return self._moment(order, np.clip(high if upper is None else upper, low, high)) - below

    def _moment(self, order: float, upper: np.ndarray) -> np.ndarray:
        """∫ qⁿ C dq from the first wavevector, exact in each power law."""
        q, powers = self.wavevectors, order + self._exponents
        scale = self.density[:-1] * q[:-1] ** (order + 1)
        whole = np.concatenate([[0.0], np.cumsum(scale * power_integral(powers, 1.0, q[1:] / q[:-1]))])
        piece = np.clip(np.searchsorted(q, upper, side="right") - 1, 0, q.size - 2)
        return whole[piece] + scale[piece] * power_integral(powers[piece], 1.0, upper / q[piece])

    def weighted_variance(
        self, weight: Callable[[np.ndarray], np.ndarray], upper: float | np.ndarray | None = None
    ) -> np.ndarray:
        low, high = self.limits
        b = np.clip(high if upper is None else upper, low, high)
        ends = np.concatenate([self.wavevectors, self.band_edges(PIECES)])
        return integrated_variance(self.density_at, weight, b, ends)

    def band_edges(self, count: int) -> np.ndarray:
        """Logarithmically spaced wavevectors."""
        edges = np.geomspace(*self.limits, count + 1)
        edges[0], edges[-1] = self.limits
        return edges
