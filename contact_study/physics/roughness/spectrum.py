"""Isotropic roughness spectra: a self-affine target, a table and that of a realised surface, with their moments.

C(q) = (2π)⁻² ∫ d²x <h(x) h(0)> exp(−i q·x), so that h_rms² = 2π ∫ q C dq; M_n(q) = ∫ q'ⁿ C dq' up to q.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact_study.numerics import fourier
from contact_study.numerics.arguments import field, grid_of
from contact_study.numerics.grid import Grid

# Least number of pieces of a weighted integral over a continuous spectrum.
PIECES = 200
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)  # of each piece
_Function = Callable[[np.ndarray], np.ndarray]
_Limit = float | np.ndarray | None


class RoughnessSpectrum(ABC):
    """A roughness spectrum, continuous or discrete, by its moments.

    Examples
    --------
    >>> from theory import RoughnessSpectrum, SelfAffineSpectrum
    >>> issubclass(SelfAffineSpectrum, RoughnessSpectrum)
    True
    """

    @property
    @abstractmethod
    def limits(self) -> tuple[float, float]:
        """Smallest and largest wavevector (1/m)."""

    @abstractmethod
    def moment(self, order: float, lower: float | None = None, upper: _Limit = None) -> np.ndarray:
        """Moment M_n = ∫ qⁿ C dq between two wavevectors (1/m), moved to the spectrum's ends if beyond (m^(3−n))."""

    @abstractmethod
    def weighted_variance(self, weight: _Function, upper: _Limit = None) -> np.ndarray:
        """Height variance 2π ∫ w(q) q C dq below ``upper`` with a weight w, smooth on the scale of an octave."""

    def band_edges(self, count: int) -> np.ndarray:
        """At most ``count`` + 1 increasing wavevectors that divide the whole spectrum well (1/m)."""
        edges = np.geomspace(*self.limits, count + 1)
        edges[0], edges[-1] = self.limits
        return edges

    @property
    def mean_square_height(self) -> float:
        """<h²> = 2π M₁ (m²)."""
        return float(2 * np.pi * self.moment(1))

    @property
    def rms_slope(self) -> float:
        """Root-mean-square slope √<(∇h)²> = √(2π M₃)."""
        return float(np.sqrt(2 * np.pi * self.moment(3)))

    @property
    def rms_laplacian(self) -> float:
        """√<(∇²h)²> = √(2π M₅) (1/m)."""
        return float(np.sqrt(2 * np.pi * self.moment(5)))

    def full_contact_stress_variance(self, stiffness: _Function, upper: _Limit = None) -> np.ndarray:
        """Variance of the stress K h of full contact with the roughness up to ``upper`` (1/m), 2π ∫ K² q C dq (Pa²)."""
        return self.weighted_variance(lambda q: stiffness(q) ** 2, upper)

    def full_contact_energy(self, stiffness: _Function, upper: _Limit = None) -> np.ndarray:
        """Elastic energy per area of full contact, π ∫ K q C dq (J/m²); parameters as for its stress variance."""
        return 0.5 * self.weighted_variance(stiffness, upper)


@dataclass(frozen=True)
class SelfAffineSpectrum(RoughnessSpectrum):
    """C = C₀ from ``low`` to ``roll_off``, C₀ (q/q_0)^(−2(1+H)) from there to ``cutoff``, zero elsewhere.

    Parameters
    ----------
    hurst_exponent, rms_height : float
        H = 3 − D_f, from 0 to 1, and h_rms of the ensemble (m); it fixes C₀.
    low, roll_off, cutoff : float
        Wavevectors q_L <= q_0 <= q_1, with q_L < q_1 (1/m).

    Examples
    --------
    >>> from theory import SelfAffineSpectrum
    >>> f"{SelfAffineSpectrum(0.8, 1e-9, 1e6, 1e6, 1e9).rms_slope:.3f}"
    '0.008'
    """

    hurst_exponent: float
    rms_height: float
    low: float
    roll_off: float
    cutoff: float

    def __post_init__(self):
        if not 0 < self.low <= self.roll_off <= self.cutoff or self.low == self.cutoff:
            raise ValueError(
                f"low = {self.low:g}, roll_off = {self.roll_off:g}, cutoff = {self.cutoff:g} 1/m: "
                "must be positive, not decrease, and span a range"
            )
        if not self.rms_height > 0:
            raise ValueError(f"rms_height = {self.rms_height:g} m: must be positive")
        if not 0 <= self.hurst_exponent <= 1:
            raise ValueError(f"hurst_exponent = {self.hurst_exponent:g}: must be from 0 to 1")

    @property
    def limits(self) -> tuple[float, float]:
        return self.low, self.cutoff

    @cached_property
    def plateau(self) -> float:
        """C₀, the density between ``low`` and ``roll_off`` (m⁴)."""
        return float(self.rms_height**2 / (2 * np.pi * self._shape_moment(1, self.low, self.cutoff)))

    def density(self, wavevector: float | np.ndarray) -> np.ndarray:
        """C(q) (m⁴), zero outside the spectrum."""
        q = np.asarray(wavevector, dtype=float)
        decay = (np.maximum(q, self.roll_off) / self.roll_off) ** (-2 * (1 + self.hurst_exponent))
        return np.where((q >= self.low) & (q <= self.cutoff), self.plateau * decay, 0.0)

    def moment(self, order, lower=None, upper=None):
        a = self.low if lower is None else min(max(lower, self.low), self.cutoff)
        b = np.clip(self.cutoff if upper is None else upper, self.low, self.cutoff)
        return self.plateau * self._shape_moment(order, a, b)

    def weighted_variance(self, weight, upper=None):
        return _integrated_variance(self, self.density, weight, upper, self.band_edges(PIECES))

    def _shape_moment(self, order: float, a: float, b: float | np.ndarray) -> np.ndarray:
        """∫ qⁿ C/C₀ dq from a to b, exact in each of the two power laws."""
        q0, decay = self.roll_off, 2 * (1 + self.hurst_exponent)
        flat = _power_integral(order, min(a, q0), np.minimum(b, q0))
        falling = _power_integral(order - decay, max(a, q0), np.maximum(b, q0)) * q0**decay
        return flat + falling

    def band_edges(self, count: int) -> np.ndarray:
        """Logarithmically spaced wavevectors, with the roll-off among them."""
        edges = super().band_edges(count)
        edges[np.argmin(np.abs(np.log(edges / self.roll_off)))] = self.roll_off
        edges[0], edges[-1] = self.limits
        return edges


@dataclass(frozen=True, eq=False)
class TabulatedSpectrum(RoughnessSpectrum):
    """C(q) on a table, a power law between neighbours, zero outside: a self-affine spectrum needs its corners only.

    Parameters
    ----------
    wavevectors : array_like, shape (n,)
        q > 0, rising, two at least (1/m).
    density : array_like, shape (n,)
        C(q) > 0 in the convention of h_rms² = 2π ∫ q C dq (m⁴).

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

    def density_at(self, wavevector: float | np.ndarray) -> np.ndarray:
        """C(q) (m⁴), zero outside the table."""
        q = np.asarray(wavevector, dtype=float)
        low, high = self.limits
        inside = np.exp(np.interp(np.log(np.clip(q, low, high)), np.log(self.wavevectors), np.log(self.density)))
        return np.where((q >= low) & (q <= high), inside, 0.0)

    def moment(self, order, lower=None, upper=None):
        low, high = self.limits
        below = 0.0 if lower is None else self._moment(order, np.clip(lower, low, high))
        return self._moment(order, np.clip(high if upper is None else upper, low, high)) - below

    def _moment(self, order: float, upper: np.ndarray) -> np.ndarray:
        """∫ qⁿ C dq from the first wavevector, exact in each power law."""
        q = self.wavevectors
        powers = order + np.diff(np.log(self.density)) / np.diff(np.log(q))
        scale = self.density[:-1] * q[:-1] ** (order + 1)
        whole = np.concatenate([[0.0], np.cumsum(scale * _power_integral(powers, 1.0, q[1:] / q[:-1]))])
        piece = np.clip(np.searchsorted(q, upper, side="right") - 1, 0, q.size - 2)
        return whole[piece] + scale[piece] * _power_integral(powers[piece], 1.0, upper / q[piece])

    def weighted_variance(self, weight, upper=None):
        ends = np.concatenate([self.wavevectors, self.band_edges(PIECES)])
        return _integrated_variance(self, self.density_at, weight, upper, ends)


def _integrated_variance(spectrum, density, weight, upper, ends):
    """Integrate 2π w(q) q C dq to upper limits by Gauss's rule on ln q, in pieces between ends (corners)."""
    low, high = spectrum.limits
    upper = np.clip(high if upper is None else upper, low, high)
    ends = np.unique(np.concatenate([np.ravel(upper), ends]))
    half = 0.5 * np.diff(np.log(ends))
    q = np.sqrt(ends[1:] * ends[:-1])[:, None] * np.exp(half[:, None] * _NODES)
    pieces = half * np.sum(_WEIGHTS * q**2 * density(q) * weight(q), axis=1)
    cumulative = np.concatenate([[0.0], np.cumsum(pieces)])
    return 2 * np.pi * cumulative[np.searchsorted(ends, upper)]


def _power_integral(power: float | np.ndarray, a: float, b: float | np.ndarray) -> np.ndarray:
    """∫ q^power dq from a to b, without cancellation when power nears −1."""
    exponent = power + 1
    octaves = np.log(np.asarray(b) / a)
    x = exponent * octaves
    ratio = np.where(x == 0, 1.0, np.expm1(x) / np.where(x == 0, 1.0, x))
    return a**exponent * octaves * ratio


@dataclass(frozen=True)
class RadialSpectrum(RoughnessSpectrum):
    """Spectrum of one surface: shells of Fourier modes of equal wavevector and the height variance of each.

    For continuous theories each shell is spread between the geometric means of its wavevector with its neighbours'
    (mirrored at both ends): every moment grows linearly to the exact M_n = Σ <h²>_i q_i^(n−1) / 2π of the shells below.

    Parameters
    ----------
    wavevectors : numpy.ndarray, shape (n,)
        Magnitudes q of the shells, increasing (1/m).
    variances : numpy.ndarray, shape (n,)
        Height variance in each shell (m²); their sum is h_rms².

    Examples
    --------
    >>> import numpy as np
    >>> from theory import RadialSpectrum
    >>> f"{RadialSpectrum(np.array([1e6, 2e6]), np.array([1e-18, 1e-18])).rms_height:.3g}"
    '1.41e-09'
    """

    wavevectors: np.ndarray
    variances: np.ndarray

    def __post_init__(self):
        q = self.wavevectors
        if q.size == 0 or not q[0] > 0 or not np.all(np.diff(q) > 0) or self.variances.shape != q.shape:
            raise ValueError("wavevectors: need at least one, increasing from above zero, with a variance each")
        for at in np.flatnonzero(~((self.variances >= 0) & np.isfinite(self.variances))):
            raise ValueError(f"variances: {self.variances[at]:g} m² at {q[at]:g} 1/m: must be finite, not negative")

    @cached_property
    def shell_edges(self) -> np.ndarray:
        """Wavevectors between which each shell is spread, shape (n + 1,) (1/m)."""
        q = self.wavevectors
        if q.size == 1:
            return q[0] * np.array([0.5, 2.0]) ** 0.5  # an octave: a single wave has no neighbour
        inner = np.sqrt(q[1:] * q[:-1])
        return np.concatenate([[q[0] ** 2 / inner[0]], inner, [q[-1] ** 2 / inner[-1]]])

    @property
    def limits(self) -> tuple[float, float]:
        return float(self.shell_edges[0]), float(self.shell_edges[-1])

    @property
    def rms_height(self) -> float:
        """h_rms of this surface (m)."""
        return float(np.sqrt(self.variances.sum()))

    def moment(self, order, lower=None, upper=None):
        parts = self.variances * self.wavevectors ** (order - 1) / (2 * np.pi)
        return self._below(upper, parts) - (0.0 if lower is None else self._below(lower, parts))

    def weighted_variance(self, weight, upper=None):
        return self._below(upper, self.variances * weight(self.wavevectors))

    def _below(self, upper: _Limit, parts: np.ndarray) -> np.ndarray:
        """Sum what the shells have up to a wavevector."""
        cumulative = np.concatenate([[0.0], np.cumsum(parts)])
        return np.interp(self.limits[1] if upper is None else upper, self.shell_edges, cumulative)

    def band_edges(self, count: int) -> np.ndarray:
        """Edges of the shells; where they lie denser than ``count`` bands in all, of groups of neighbours."""
        edges = self.shell_edges
        if edges.size <= count + 1:
            return edges.copy()
        wanted = np.geomspace(edges[0], edges[-1], count + 1)
        return edges[np.unique(np.abs(np.log(edges[:, None] / wanted[None, :])).argmin(axis=0))]


def radial_spectrum(heights: np.ndarray, grid: Grid) -> RadialSpectrum:
    """Calculate the spectrum of periodic heights (m) on a grid, their mean apart; raise ValueError if flat."""
    power = grid.variances(fourier.transform(heights))
    q = np.broadcast_to(grid.wavenumber, power.shape).ravel()
    unit = 2 * np.pi / max(grid.size)
    # Modes of one shell differ in |q| by rounding only; nine digits tell neighbouring shells apart.
    _, first, index = np.unique(np.round(q / unit, 9), return_index=True, return_inverse=True)
    variances = np.bincount(index.ravel(), weights=power.ravel())
    # Modes that a band-limited surface does not have hold the transform's rounding, some 1e-16 of the heights each.
    present = variances > 1e-26 * np.mean(np.square(heights))
    if not present.any():
        raise ValueError("heights: the surface is flat and has no spectrum")
    return RadialSpectrum(q[first[present]], variances[present])


def spectrum_of(height: np.ndarray, size: float | Sequence[float]) -> RadialSpectrum:
    """Calculate the isotropic power spectral density of a height array.

    The convention is Persson's two-dimensional one, <h²> = 2π ∫ q C dq with C in m⁴: without the factor (2π)⁻² in
    C(q) = (2π)⁻² ∫ <h(x)h(0)> e^(−iq·x) d²x, as in other conventions, it is 4π² = 39.5 times as large.

    Parameters
    ----------
    height : array_like, shape (y, x)
        Heights (m), continued periodically; their mean is left out.
    size : float or pair of float
        Periods along y and x; one number is both (m).

    Returns
    -------
    RadialSpectrum
        Wavevectors of equal magnitude in shells, and the height variance 2π ∫ q C dq of each (m²).

    Raises
    ------
    ValueError
        If the heights are no array of finite numbers, or flat, or a period is not a positive number.

    Examples
    --------
    >>> import numpy as np
    >>> from theory import spectrum_of
    >>> wave = np.cos(2 * np.pi * np.arange(8) / 8)
    >>> found = spectrum_of(np.tile(1e-9 * wave, (8, 1)), 1e-6)
    >>> found.wavevectors.size, round(1e18 * found.mean_square_height, 9)
    (1, 0.5)
    """
    heights = field("height", height)
    if np.ptp(heights) == 0:
        raise ValueError("height is flat: it has no spectrum")
    return radial_spectrum(heights, grid_of(heights, size))
