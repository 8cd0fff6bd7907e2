"""Persson's theory without adhesion, and three corrections of its diffusion.

The stress of the contact diffuses with the stress variance V(q) of full contact; in incomplete contact with less, V_p:

    A = erf(p/√(2V_p)),     ``persson`` V_p = V,     ``yang_persson`` dV_p = [γ + (1−γ)A²] dV,
    ``wang_mueser`` dV_p = [5/9 − (2/9)A² + (2/3)A⁴] dV,     ``xu`` V_p = [γ + (1−γ)A] V

B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001); C. Yang, B. N. J. Persson, J. Phys.: Condens. Matter 20, 215214
(2008); A. Wang, M. H. Müser, Tribol. Lett. 65 (2017); Y. Xu, L. Zhu, F. Xiao, Y. Zhou, Tribol. Lett. (2024),
doi:10.1007/s11249-024-01838-4, whose programs, https://github.com/xylcsi/PerssonModelFudgeFactor, have γ = 0.42.

V_p/p² = t is one function of V/p² = F. With W = A dt/dF energy, mean gap and stiffness are sums over a spectrum of
W(x), G(x) = ∫_x^∞ W'(x')/x' dx' and W'(x) at x = p/√V.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import erf, roots_legendre

from contact_study.numerics.arguments import positive
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of
from theory.datasets import Dataset, dataset_of
from theory.non_adhesive import closed_forms

CORRECTIONS = ("persson", "yang_persson", "wang_mueser", "xu")


@dataclass(frozen=True)
class NonAdhesiveTheory:
    """Describe contact without adhesion of a surface with a known spectrum.

    Parameters
    ----------
    spectrum, elasticity
        As for :class:`PerssonTheory`.
    correction : str, optional
        One of :data:`CORRECTIONS`.
    gamma : float, optional
        γ of ``yang_persson`` and ``xu``, from 0 to 1.

    Raises
    ------
    ValueError
        If the correction is unknown, or γ is not between 0 and 1.

    Examples
    --------
    >>> from theory import NonAdhesiveTheory, SelfAffineSpectrum
    >>> spectrum = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
    >>> plain, corrected = (NonAdhesiveTheory(spectrum, 93.7e9, name).at_pressure(1e9) for name in ("persson", "xu"))
    >>> plain.relative_contact_area < corrected.relative_contact_area
    True
    """

    spectrum: RoughnessSpectrum
    elasticity: Elasticity | float
    correction: str = "persson"
    gamma: float = 0.42

    def __post_init__(self):
        if self.correction not in CORRECTIONS:
            raise ValueError(f"correction = {self.correction!r}: expected one of {', '.join(CORRECTIONS)}")
        if not 0 < positive("gamma", self.gamma, "1") <= 1:
            raise ValueError(f"gamma = {self.gamma!r}: must lie between 0 and 1")

    @cached_property
    def solid(self) -> Elasticity:
        """The elastic solid."""
        return elasticity_of(self.elasticity)

    @cached_property
    def _curves(self) -> "_Curves":
        return _Curves(self.correction, self.gamma)

    @cached_property
    def _points(self) -> tuple[np.ndarray, np.ndarray]:
        """√V at Gauss's points of fine bands (Pa), and the energy of full contact at each (J/m²)."""
        stress, energy = closed_forms.shared_points(*closed_forms.stress_and_energy(self.spectrum, self.solid))
        return stress / np.sqrt(2), energy

    def at_pressure(self, pressure: float) -> "NonAdhesiveContact":
        """Find the contact at a mean pressure p > 0 (Pa)."""
        p = positive("pressure", pressure, "Pa")
        (root, energy), curves = self._points, self._curves
        x = p / root
        rise = float(energy / root @ curves.slope(x))  # dU/dp
        stored, gap = float(energy @ curves.weight(x)), float(energy / root @ curves.separation(x))
        return NonAdhesiveContact(self, p, stored, gap, p / rise if rise > 0 else np.inf)


@dataclass(frozen=True)
class NonAdhesiveContact:
    """Hold the state of contact at one pressure, which :meth:`NonAdhesiveTheory.at_pressure` returns.

    Attributes
    ----------
    theory : NonAdhesiveTheory
        The interface.
    pressure, elastic_energy, mean_gap : float
        p (Pa), U per nominal area (J/m²) and ū (m).
    stiffness : float
        −dp/dū = p/(dU/dp) (Pa/m); infinite in full contact.

    Examples
    --------
    ``NonAdhesiveTheory(...).at_pressure(p)`` returns one, see :class:`theory.NonAdhesiveTheory`.
    """

    theory: NonAdhesiveTheory
    pressure: float
    elastic_energy: float
    mean_gap: float
    stiffness: float

    def stress_variance_at(self, wavevector: float | np.ndarray | None = None) -> np.ndarray:
        """V_p with the roughness up to a wavevector, all of it by default (Pa²)."""
        full = self.theory.spectrum.full_contact_stress_variance(self.theory.solid.stiffness, wavevector)
        return self.pressure**2 * self.theory._curves.spread(full / self.pressure**2)

    def relative_contact_area_at(self, wavevector: float | np.ndarray | None = None) -> np.ndarray:
        """A/A₀ with the roughness up to a wavevector, all of it by default."""
        variance = np.maximum(self.stress_variance_at(wavevector), np.finfo(float).tiny)
        return closed_forms.relative_contact_area(self.pressure, variance)

    @property
    def relative_contact_area(self) -> float:
        """A/A₀ with all roughness."""
        return float(self.relative_contact_area_at())

    def stress_density(self, stress: np.ndarray) -> np.ndarray:
        """P(σ) for σ >= 0 with all roughness, without the δ of non-contact (1/Pa)."""
        return closed_forms.stress_density(stress, self.pressure, float(self.stress_variance_at()))

    def to_dataset(self, pressure_edges: np.ndarray | None = None) -> Dataset:
        """Give the state in the schema of ``theory.nc``; bins as in :meth:`theory.PerssonContact.to_dataset`."""
        deviation = float(np.sqrt(self.stress_variance_at()))

        def density(edges: np.ndarray) -> np.ndarray:
            # ∫ P dσ of the two Gaussians, from zero on.
            up = np.maximum(edges, 0.0)
            mass = 0.5 * sum(sign * erf((up - sign * self.pressure) / (np.sqrt(2) * deviation)) for sign in (1, -1))
            return np.diff(mass) / np.diff(edges)

        values = {name: getattr(self, name) for name in ("mean_gap", "relative_contact_area", "elastic_energy")}
        values |= {"mean_pressure": self.pressure, "interaction_energy": 0.0, "pressure_pdf": density}
        bins = {"pressure_pdf": (pressure_edges, (0.0, self.pressure + 7 * deviation))}
        return dataset_of((self.theory.correction,), values | {"converged": True, "detached": False}, bins)


def _gauss_points(edges: np.ndarray, order: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Half the widths of intervals, Gauss's points inside and their weights."""
    nodes, weights = roots_legendre(order)
    half = 0.5 * np.diff(edges)
    return half, 0.5 * (edges[1:] + edges[:-1])[:, None] + half[:, None] * nodes, weights


class _Curves:
    """The functions of one correction on nodes of t, from full contact to 1e-22 to areas below 1e-6, a power of t."""

    def __init__(self, correction: str, gamma: float):
        t = np.geomspace(1e-2, 1e12, 3000)
        shares: dict[str, Callable[[np.ndarray], np.ndarray]] = {  # dV_p/dV
            "yang_persson": lambda area: gamma + (1 - gamma) * area**2,
            "wang_mueser": lambda area: 5 / 9 - 2 / 9 * area**2 + 2 / 3 * area**4,
        }
        share = shares.get(correction, np.ones_like)
        area = erf(1 / np.sqrt(2 * t))
        if correction == "xu":
            s, rise = gamma + (1 - gamma) * area, 1 - gamma
            fall = -np.exp(-1 / (2 * t)) / np.sqrt(2 * np.pi * t**3)  # dA/dt
            full, slope = t / s, 1 / (1 / s - t * rise * fall / s**2)
        else:
            half, inside, weights = _gauss_points(t, 8)
            parts = half * np.sum(weights / share(erf(1 / np.sqrt(2 * inside))), axis=1)
            full, slope = t[0] + np.concatenate([[0.0], np.cumsum(parts)]), share(area)
        self._spread = CubicSpline(np.log(full), np.log(t))
        self._ends = full[[0, -1]]
        # Rising x = p/√V = F^(−½).
        self._weight = CubicSpline(-0.5 * np.log(full)[::-1], (area * slope)[::-1])
        places = self._weight.x
        half, inside, weights = _gauss_points(places, 6)
        parts = half * np.sum(weights * self._weight(inside, 1) * np.exp(-inside), axis=1)
        self._separation = CubicSpline(places, np.concatenate([np.cumsum(parts[::-1])[::-1], [0.0]]))

    def spread(self, full: np.ndarray) -> np.ndarray:
        """V_p/p² from V/p²."""
        inside = np.clip(full, *self._ends)
        return np.exp(self._spread(np.log(inside))) * full / inside  # whole contact below, a power above

    def weight(self, x: np.ndarray) -> np.ndarray:
        """W at x = p/√V."""
        return self._weight(self._inside(x)) * np.minimum(x / np.exp(self._weight.x[0]), 1.0)

    def slope(self, x: np.ndarray) -> np.ndarray:
        """W' at x."""
        place = self._inside(x)
        return np.where(place < self._weight.x[-1], self._weight(place, 1) / np.exp(place), 0.0)

    def separation(self, x: np.ndarray) -> np.ndarray:
        """G at x; below the nodes W is proportional to x."""
        first = self._weight.x[0]
        below = np.minimum(np.log(x) - first, 0.0)
        return self._separation(self._inside(x)) - below * self._weight(first, 1) / np.exp(first)

    def _inside(self, x: np.ndarray) -> np.ndarray:
        return np.clip(np.log(x), self._weight.x[0], self._weight.x[-1])
