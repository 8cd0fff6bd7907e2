"""Solids whose stiffness is a table: by wavenumber, or by the wavevectors of a grid."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.physics.solids.base import Elasticity, contact_modulus_of


@dataclass(frozen=True, eq=False)
class Measured(Elasticity):
    """A solid of stiffness K(q) known at a number of wavenumbers, the same in all directions.

    Between the points E*(q) = 2K/q is a monotone cubic of ln q (SciPy's ``PchipInterpolator``), beyond them constant.

    Parameters
    ----------
    contact_modulus : float
        E* to quote, and the unit of stresses (Pa).
    wavenumbers : array_like, shape (points,)
        Increasing and positive (1/m).
    stiffnesses : array_like, shape (points,)
        K there (Pa/m), positive.

    Examples
    --------
    >>> from contact_study.physics.solids import Measured
    >>> f"{float(Measured(1e9, [1e6, 1e8], [5e14, 5e16]).stiffness(1e7)):.3g}"
    '5e+15'
    """

    wavenumbers: Sequence[float] | np.ndarray
    stiffnesses: Sequence[float] | np.ndarray

    def __post_init__(self) -> None:
        super().__post_init__()
        q, stiffness = self._table
        if q.ndim != 1 or q.shape != stiffness.shape or q.size < 2:
            raise ValueError("needs at least two wavenumbers, and as many stiffnesses")
        if not (np.all(np.isfinite(q)) and q[0] > 0 and np.all(np.diff(q) > 0)):
            raise ValueError("must have positive wavenumbers in increasing order")
        if not (np.all(np.isfinite(stiffness)) and np.all(stiffness > 0)):
            raise ValueError("must have positive stiffnesses")

    @property
    def _table(self) -> tuple[np.ndarray, np.ndarray]:
        return np.asarray(self.wavenumbers, dtype=float), np.asarray(self.stiffnesses, dtype=float)

    @cached_property
    def _modulus(self) -> Any:
        from scipy.interpolate import PchipInterpolator  # slow to import

        q, stiffness = self._table
        return PchipInterpolator(np.log(q), contact_modulus_of(stiffness, q))

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        q = np.asarray(wavenumber, dtype=float)
        return 0.5 * q * self._modulus(np.log(np.clip(q, self.wavenumbers[0], self.wavenumbers[-1])))

    def scaled(self, length: float, stress: float) -> Self:
        q, stiffness = self._table
        return replace(
            super().scaled(length, stress), wavenumbers=q * length, stiffnesses=stiffness * (length / stress)
        )


@dataclass(frozen=True, eq=False)
class Tabulated(Elasticity):
    """K on the wavevectors of a grid, which may depend on their direction; theories see its mean over directions.

    Parameters
    ----------
    contact_modulus : float
        E* to quote, and the unit of stresses: that of the half-space which the solid is compared with (Pa).
    grid : Grid
        Whose wavevectors they are.
    table : numpy.ndarray, shape grid.spectrum_shape
        K in the layout of ``rfft2`` (Pa/m), positive; the first entry, that of the mean, is not looked at.

    Examples
    --------
    >>> import numpy as np
    >>> from contact_study.numerics.grid import Grid
    >>> from contact_study.physics.solids import Tabulated
    >>> grid = Grid((4, 4), (1e-6, 1e-6))
    >>> Tabulated(1e9, grid, np.ones(grid.spectrum_shape)).stiffness_on(grid).shape
    (4, 3)
    """

    on_any_grid = False
    grid: Grid
    table: np.ndarray

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.table.shape != self.grid.spectrum_shape:
            raise ValueError(f"table has shape {self.table.shape}, the grid's spectrum {self.grid.spectrum_shape}")
        waves = self.table.reshape(-1)[1:]
        if not (np.all(np.isfinite(waves)) and np.all(waves > 0)):
            raise ValueError("table: every stiffness must be positive and finite")

    @cached_property
    def _by_wavenumber(self) -> tuple[np.ndarray, np.ndarray]:
        """Wavenumbers and E*(q) = 2K/q, both in the mean over rings as wide as the longest wave's wavenumber."""
        q = self.grid.wavenumber.reshape(-1)[1:]
        weight = np.broadcast_to(self.grid.multiplicity, self.grid.spectrum_shape).reshape(-1)[1:]
        ring = np.rint(q * max(self.grid.size) / (2 * np.pi)).astype(int)
        modulus = contact_modulus_of(self.table.reshape(-1)[1:], q)
        count, waves, moduli = (np.bincount(ring, part) for part in (weight, weight * q, weight * modulus))
        filled = count > 0
        return waves[filled] / count[filled], moduli[filled] / count[filled]

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        """Mean of K over directions, between the rings of the table with E*(q) linear, beyond them constant (Pa/m)."""
        q = np.asarray(wavenumber, dtype=float)
        return 0.5 * q * np.interp(q, *self._by_wavenumber)

    def stiffness_on(self, grid: Grid) -> np.ndarray:
        """The table itself, or of a coarser grid the part that it holds; ValueError if the grid has other waves."""
        fits = np.allclose(grid.size, self.grid.size, rtol=1e-9, atol=0)
        if not fits or grid.shape[0] > self.grid.shape[0] or grid.shape[1] > self.grid.shape[1]:
            raise ValueError(
                f"the stiffness is tabulated on {self.grid.shape} points over {self.grid.size} m: "
                f"{grid.shape} points over {grid.size} m have other waves"
            )
        rows = np.rint(np.fft.fftfreq(grid.shape[0], 1 / grid.shape[0])).astype(int)
        stiffness_q = self.table[rows, : grid.spectrum_shape[1]]  # a copy
        stiffness_q[0, 0] = 0.0
        return stiffness_q

    def scaled(self, length: float, stress: float) -> Self:
        grid = Grid(self.grid.shape, (self.grid.size[0] / length, self.grid.size[1] / length))
        return replace(super().scaled(length, stress), grid=grid, table=self.table * (length / stress))
