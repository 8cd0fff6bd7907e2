"""Persson's theory without adhesion, where the diffusion with a resting boundary is solved by images.

B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001); separation: Phys. Rev. Lett. 99, 125502 (2007), with the weight of
the energy of C. Yang, B. N. J. Persson, J. Israelachvili, K. Rosenberg, EPL 84, 46004 (2008).
"""

from functools import cache

import numpy as np
from scipy.special import erf, exp1, roots_legendre

from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of

_gauss = cache(roots_legendre)
BETA = 0.4  # β of the energy's weight


def relative_contact_area(pressure: np.ndarray | float, stress_variance: np.ndarray | float) -> np.ndarray:
    """A/A₀ = erf(p/√(2s)) at a pressure p >= 0 (Pa) and the stress variance s of the magnification (Pa²)."""
    return erf(np.asarray(pressure) / np.sqrt(2 * np.asarray(stress_variance)))


def stress_density(stress: np.ndarray, pressure: float, stress_variance: float) -> np.ndarray:
    """P(σ) = (2πs)^(−½) [e^(−(σ−p)²/2s) − e^(−(σ+p)²/2s)] for σ >= 0, without the δ of non-contact (1/Pa)."""
    stress = np.asarray(stress, dtype=float)
    direct = np.exp(-((stress - pressure) ** 2) / (2 * stress_variance))
    image = np.exp(-((stress + pressure) ** 2) / (2 * stress_variance))
    return np.where(stress >= 0, direct - image, 0.0) / np.sqrt(2 * np.pi * stress_variance)


def mean_gap(
    pressure: np.ndarray | float, spectrum: RoughnessSpectrum, elasticity: Elasticity | float, beta: float = BETA
) -> np.ndarray:
    """Mean separation with the weight W = A[β + (1−β)A²] of the elastic energy (m).

        ū = (2/√π) ∫ dU w ∫_p^∞ (dp'/p') [β + 3(1−β) erf²(wp')] e^(−(wp')²),     w = (2s)^(−½)

    with the energy dU = π K q C dq of full contact and its stress variance s(q) = 2π ∫_{q_L}^q K² q' C dq'.
    """
    stress, energy = shared_points(*stress_and_energy(spectrum, elasticity_of(elasticity)))
    given = np.atleast_1d(np.asarray(pressure, dtype=float))
    return separation(given, stress, energy, beta).reshape(np.shape(pressure))


def separation(pressure: np.ndarray, stress: np.ndarray, energy: np.ndarray, beta: float) -> np.ndarray:
    """ū at pressures, shape (n,) (Pa), from √(2s) at points (Pa) and the full-contact energy at each (J/m²) (m)."""
    w = 1 / stress
    return 2 / np.sqrt(np.pi) * ((energy * w) @ _separation_kernel(w[:, None] * pressure, beta))


def shared_points(root: np.ndarray, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gauss's points of bands from √(2s) at their edges (Pa), and their energies (J/m²) shared among these in √s."""
    nodes, weights = _gauss(4)
    stress = 0.5 * (root[1:] + root[:-1])[:, None] + 0.5 * np.diff(root)[:, None] * nodes
    share = stress * weights / np.sum(stress * weights, axis=1, keepdims=True)
    return stress.ravel(), (parts[:, None] * share).ravel()


def stress_and_energy(spectrum: RoughnessSpectrum, solid: Elasticity) -> tuple[np.ndarray, np.ndarray]:
    """√(2s) at the edges of fine bands (Pa), and the full-contact energy of each (J/m²)."""
    edges = spectrum.band_edges(1000)
    root = np.sqrt(2 * spectrum.full_contact_stress_variance(solid.stiffness, edges))
    return root, np.diff(spectrum.full_contact_energy(solid.stiffness, edges))


def _separation_kernel(x: np.ndarray, beta: float) -> np.ndarray:
    """∫_x^∞ (dy/y) [β + 3(1−β) erf²(y)] e^(−y²); the first part is β E₁(x²)/2."""
    nodes, weights = _gauss(24)
    upper = np.maximum(6.2, x)  # beyond 6.2 the second integrand, entire in y, is below 1e-16
    smooth = np.zeros_like(x)
    for node, weight in zip(nodes, weights, strict=True):
        y = 0.5 * (x + upper) + 0.5 * (upper - x) * node
        smooth += weight * erf(y) ** 2 / y * np.exp(-(y**2))
    return 0.5 * beta * exp1(x**2) + 3 * (1 - beta) * 0.5 * (upper - x) * smooth


def low_pressure_asymptote(spectrum: RoughnessSpectrum, elasticity: Elasticity | float) -> tuple[float, float]:
    """u₀ = (2β/√π) ∫ w dU and p₀ of the light-load limit p = p₀ e^(−ū/u₀) (m, Pa)."""
    solid = elasticity_of(elasticity)
    root, parts = stress_and_energy(spectrum, solid)
    inverse = 2 / (root[1:] + root[:-1])  # mean of w = 1/root over a band whose dU is shared as root d(root)
    decay = float(BETA * 2 / np.sqrt(np.pi) * np.sum(parts * inverse))
    light = 1e-12 * solid.contact_modulus  # where the asymptote is exact to rounding
    return decay, float(light * np.exp(mean_gap(light, spectrum, solid) / decay))
