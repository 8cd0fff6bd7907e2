"""Persson's theory of rough contact with adhesion, as Yang et al. used it.

C. Yang, B. N. J. Persson, J. Israelachvili and K. Rosenberg, EPL 84, 46004 (2008), arXiv:0808.3463, with B. N. J.
Persson, Surf. Sci. Rep. 61, 201 (2006), arXiv:cond-mat/0603807, section 8. The contact is studied at growing
magnification q: its stress distribution diffuses with the roughness added (:mod:`theory.persson.diffusion`), stopped at
the detachment stress σ_a(q) of a crack of size 1/q,

    σ_a² = 2α K(q) γ_eff(q),     γ_eff(q) A*(q) = Δγ A*(q₁) − U_el(q),

where A*(q) is the true area in contact and U_el(q) the elastic energy stored at wavelengths shorter than 2π/q,

    U_el(q) = π ∫_q^q₁ K(q') W(A(q')) C(q') q' dq'.

The paper has a half-space, K = E* q/2: then σ_a² = α E* q γ_eff and U_el = (π/2) E* ∫ q'² W C dq'. Any other solid
enters by its stiffness K(q) of a wave, and by the stress variance 2π ∫ K² q C dq of full contact. For a bed of springs
the crack condition is then exact: the energy σ²/2K of a spring is released.

A(q) and σ_a(q) depend on each other at all magnifications: :mod:`theory.persson.solver` finds them.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import erfcx

from contact_study.numerics.arguments import finite, positive
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of
from theory.persson.contact import PerssonContact
from theory.persson.solver import MAX_ITERATIONS, TOLERANCE, solve

ENERGY_WEIGHTS = ("paper", "wang_mueser", "area")
TRUE_AREAS = ("persson", "none", "lattice")

# Share of the nodes that resolves the start of the diffusion, evenly in this power of the stress variance: under light
# load contact is lost where that is p². The others are logarithmic in q.
_EARLY_SHARE, _EARLY_POWER = 0.4, 1 / 6

# Smallest distance from the first wavevector at which the variance is looked at, over the spectrum's width.
_NEAREST = 1e-14

# Share of the stress variance below which roughness is left out: 3e-5 of the stress's deviation, far below the error of
# the nodes. Filtered height maps have shells down to the rounding of the variance's sum, where no diffusion is left.
_NEGLIGIBLE = 1e-9


@dataclass(frozen=True)
class PerssonTheory:
    """The interface and the choices inside the theory; the defaults are the paper's.

    Parameters
    ----------
    spectrum : RoughnessSpectrum
        Roughness, analytic or of one surface.
    elasticity : Elasticity or float
        The solid; a number is the contact modulus E* of a half-space (Pa).
    work_of_adhesion : float
        Δγ >= 0 (J/m²).
    energy_weight : str, optional
        W(A): ``"paper"`` A[β + (1−β)A²]; ``"wang_mueser"`` A[5/9 − (2/9)A² + (2/3)A⁴]; ``"area"`` A.
    beta : float, optional
        β of the paper's weight.
    true_area : str, optional
        True over projected area: ``"persson"`` <√(1+|∇h|²)> of a Gaussian surface; ``"none"`` 1; ``"lattice"``
        <1/√(1+|∇h|²)>, for a substrate of atoms with a fixed number per projected area.
    alpha : float, optional
        α of the crack condition.
    stress_cap : float, optional
        Upper bound of σ_a, such as the law's largest tensile stress (Pa).
    nodes, cells : int, optional
        Magnifications and stress cells of the diffusion.

    Raises
    ------
    ValueError
        If a choice is unknown or a number is not possible.

    Examples
    --------
    >>> from theory import PerssonTheory, SelfAffineSpectrum
    >>> spectrum = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
    >>> contact = PerssonTheory(spectrum, elasticity=93.7e9, work_of_adhesion=0.1).at_pressure(1e9)
    >>> bool(contact.converged and 0 < contact.relative_contact_area < 1)
    True
    """

    spectrum: RoughnessSpectrum
    elasticity: Elasticity | float
    work_of_adhesion: float
    energy_weight: str = "paper"
    beta: float = 0.4
    true_area: str = "persson"
    alpha: float = 1.0
    stress_cap: float = np.inf
    nodes: int = 200
    cells: int = 300

    def __post_init__(self):
        if finite("work_of_adhesion", self.work_of_adhesion, "J/m²") < 0:
            raise ValueError(f"work_of_adhesion = {self.work_of_adhesion!r}: must not be negative, in J/m²")
        for name in ("alpha", "nodes", "cells"):
            positive(name, getattr(self, name), "1")
        if self.energy_weight not in ENERGY_WEIGHTS:
            raise ValueError(f"energy_weight = {self.energy_weight!r}: expected one of {', '.join(ENERGY_WEIGHTS)}")
        if self.true_area not in TRUE_AREAS:
            raise ValueError(f"true_area = {self.true_area!r}: expected one of {', '.join(TRUE_AREAS)}")

    @cached_property
    def solid(self) -> Elasticity:
        """The elastic solid."""
        return elasticity_of(self.elasticity)

    @cached_property
    def wavevectors(self) -> np.ndarray:
        """Magnifications from the smallest to the largest wavevector with roughness, shape (nodes + 1,) (1/m).

        They equidistribute 0.4 (s/s₁)^(1/6) + 0.6 ln q. Octaves that add no stress variance get no nodes, so that s
        grows from each to the next.
        """
        fine = self.spectrum.band_edges(100 * self.nodes)
        near = fine[0] + (fine[-1] - fine[0]) * np.geomspace(_NEAREST, 1e-2, 20 * self.nodes)
        fine = np.unique(np.concatenate([fine, near, np.geomspace(fine[0], fine[-1], 100 * self.nodes)]))
        share = np.maximum.accumulate(self.spectrum.full_contact_stress_variance(self.solid.stiffness, fine))
        share /= share[-1]
        end = int(np.argmax(share >= 1 - _NEGLIGIBLE)) + 1
        fine, share = fine[:end], share[:end]
        octaves = np.diff(np.log(fine))
        octaves[np.diff(share) < _NEGLIGIBLE * octaves / octaves.sum()] = 0.0
        late = np.concatenate([[0.0], np.cumsum(octaves)]) / octaves.sum()
        measure = _EARLY_SHARE * share**_EARLY_POWER + (1 - _EARLY_SHARE) * late
        return np.interp(np.linspace(0, measure[-1], self.nodes + 1), measure, fine)

    @cached_property
    def _stiffness(self) -> np.ndarray:
        """K at the magnifications (Pa/m)."""
        return self.solid.stiffness(self.wavevectors)

    @cached_property
    def stress_variance(self) -> np.ndarray:
        """s(q) at the magnifications (Pa²)."""
        return self.spectrum.full_contact_stress_variance(self.solid.stiffness, self.wavevectors)

    @property
    def stress_scale(self) -> float:
        """√s(q₁), the standard deviation of the stress in full contact (Pa)."""
        return float(np.sqrt(self.stress_variance[-1]))

    @cached_property
    def area_factor(self) -> np.ndarray:
        """True over projected area of conformal contact at the magnifications."""
        if self.true_area == "none":
            return np.ones(self.nodes + 1)
        slope = np.sqrt(2 * np.pi * self.spectrum.moment(3, upper=self.wavevectors))
        return true_area_factor(slope) if self.true_area == "persson" else mean_cosine(slope)

    @cached_property
    def _energy_parts(self) -> np.ndarray:
        """Full-contact elastic energy of the roughness between neighbouring magnifications (J/m²)."""
        return np.diff(self.spectrum.full_contact_energy(self.solid.stiffness, self.wavevectors))

    def at_pressure(
        self,
        pressure: float,
        start: np.ndarray | str = "adhered",
        tolerance: float = TOLERANCE,
        max_iterations: int = MAX_ITERATIONS,
    ) -> PerssonContact:
        """The contact at a mean pressure; see :func:`theory.persson.solver.solve`."""
        return solve(self, pressure, start, tolerance, max_iterations)

    @property
    def full_contact_energy(self) -> float:
        """Interfacial energy U at infinite pressure: U_full − Δγ S (J/m²)."""
        return float(self._energy_parts.sum() - self.work_of_adhesion * self.area_factor[-1])

    def elastic_energy(self, contact: np.ndarray) -> np.ndarray:
        """U_el(q) at the magnifications from A(q) (J/m²)."""
        weight = energy_weight(contact, self.energy_weight, self.beta)
        parts = self._energy_parts * 0.5 * (weight[1:] + weight[:-1])
        return np.concatenate([np.cumsum(parts[::-1])[::-1], [0.0]])

    def effective_work_of_adhesion(self, contact: np.ndarray) -> np.ndarray:
        """γ_eff(q) from A(q), zero where nothing is in contact (J/m²)."""
        true_area = contact * self.area_factor
        gain = self.work_of_adhesion * true_area[-1] - self.elastic_energy(contact)
        return np.divide(gain, true_area, out=np.zeros_like(gain), where=true_area > 0)

    def detachment_stress(self, effective_work: np.ndarray) -> np.ndarray:
        """σ_a(q) from γ_eff(q) (Pa)."""
        return self.stress_of_square(self.stress_square(effective_work))

    def stress_square(self, effective_work: np.ndarray) -> np.ndarray:
        """2α K γ_eff, the square of σ_a where nothing caps it; negative where γ_eff is (Pa²)."""
        return 2 * self.alpha * self._stiffness * effective_work

    def stress_of_square(self, square: np.ndarray) -> np.ndarray:
        """σ_a (Pa) from :meth:`stress_square`."""
        return np.minimum(np.sqrt(np.maximum(square, 0.0)), self.stress_cap)


def energy_weight(contact: np.ndarray, kind: str, beta: float) -> np.ndarray:
    """Share W(A) of the full-contact elastic energy that incomplete contact stores."""
    if kind == "paper":
        return contact * (beta + (1 - beta) * contact**2)
    if kind == "wang_mueser":
        return contact * (5 / 9 - 2 / 9 * contact**2 + 2 / 3 * contact**4)
    return contact.copy()


def true_area_factor(rms_slope: np.ndarray) -> np.ndarray:
    """S(ξ) = ∫₀^∞ √(1+ξ²x) e^(−x) dx = 1 + (√π/2) ξ e^(1/ξ²) erfc(1/ξ), <√(1+|∇h|²)> of a Gaussian surface."""
    inverse = 1 / np.maximum(rms_slope, 1e-150)  # ξ = 0 is the limit, without a division by zero
    return 1 + 0.5 * np.sqrt(np.pi) * rms_slope * erfcx(inverse)


def mean_cosine(rms_slope: np.ndarray) -> np.ndarray:
    """∫₀^∞ e^(−x)/√(1+ξ²x) dx = (√π/ξ) e^(1/ξ²) erfc(1/ξ), <1/√(1+|∇h|²)> of a Gaussian surface."""
    inverse = 1 / np.maximum(rms_slope, 1e-150)
    return np.sqrt(np.pi) * inverse * erfcx(inverse)
