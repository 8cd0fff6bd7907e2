"""The interface of Persson's theory: roughness, solid and adhesion at the magnifications, and their energies."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.special import erfcx

from contact_study.numerics.arguments import finite, positive
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of
from theory.persson.diffusion import DiffusionOptions

ENERGY_WEIGHTS = ("paper", "wang_mueser", "area")
TRUE_AREAS = ("persson", "none", "lattice")


@dataclass(frozen=True)
class IterationOptions:
    """Constants of the iteration."""

    tolerance: float = 1e-7  # largest change of σ_a over the stress scale, four digits below the error of the nodes
    max_iterations: int = 400  # diffusions at most
    accelerated: int = 40  # diffusions after which the acceleration is given up
    memory: int = 3  # states that it uses; with more it fails near the sticking threshold
    relaxation: float = 0.8  # largest share of the change that the damped iteration takes
    patience: int = 200  # diffusions in which the smallest change of the damped iteration has to halve


@dataclass(frozen=True)
class PerssonOptions:
    """Constants of the numerics."""

    early_share: float = 0.4  # of the nodes even in this power of the stress variance, not in ln q
    early_power: float = 1 / 6
    nearest: float = 1e-14  # smallest distance from the first wavevector of a node, over the spectrum's width
    negligible: float = 1e-9  # stress variance left out: filtered maps have shells down to the rounding
    full_contact: float = 7.0  # pressure beyond which contact is full to 1e-12, over the stress scale
    balance: float = 0.02  # largest error of the stress balance of a converged state, over the pressure
    least_pressure: float = 1e-6  # its bound is that of this pressure where p is smaller, over the stress scale
    diffusion: DiffusionOptions = field(default_factory=DiffusionOptions)
    iteration: IterationOptions = field(default_factory=IterationOptions)


@dataclass(frozen=True)
class PerssonInterface:
    """Hold what a state refers to; parameters as of :class:`theory.PerssonTheory`, which solves for states."""

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
    options: PerssonOptions = field(default_factory=PerssonOptions)

    def __post_init__(self):
        if finite("work_of_adhesion", self.work_of_adhesion, "J/m²") < 0:
            raise ValueError(f"work_of_adhesion = {self.work_of_adhesion!r}: must not be negative, in J/m²")
        for name in ("alpha", "nodes", "cells"):
            positive(name, getattr(self, name), "1")
        for name, known in (("energy_weight", ENERGY_WEIGHTS), ("true_area", TRUE_AREAS)):
            if getattr(self, name) not in known:
                raise ValueError(f"{name} = {getattr(self, name)!r}: expected one of {', '.join(known)}")

    @cached_property
    def solid(self) -> Elasticity:
        """The elastic solid."""
        return elasticity_of(self.elasticity)

    @cached_property
    def wavevectors(self) -> np.ndarray:
        """Magnifications from the smallest to the largest wavevector with roughness, shape (nodes + 1,) (1/m).

        They equidistribute 0.4 (s/s₁)^(1/6) + 0.6 ln q; octaves that add no stress variance get none.
        """
        options = self.options
        fine = self.spectrum.band_edges(100 * self.nodes)
        near = fine[0] + (fine[-1] - fine[0]) * np.geomspace(options.nearest, 1e-2, 20 * self.nodes)
        fine = np.unique(np.concatenate([fine, near, np.geomspace(fine[0], fine[-1], 100 * self.nodes)]))
        share = np.maximum.accumulate(self.spectrum.full_contact_stress_variance(self.solid.stiffness, fine))
        share /= share[-1]
        end = int(np.argmax(share >= 1 - options.negligible)) + 1
        fine, share = fine[:end], share[:end]
        octaves = np.diff(np.log(fine))
        octaves[np.diff(share) < options.negligible * octaves / octaves.sum()] = 0.0
        late = np.concatenate([[0.0], np.cumsum(octaves)]) / octaves.sum()
        measure = options.early_share * share**options.early_power + (1 - options.early_share) * late
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
        return self._root(2 * self.alpha * self._stiffness * effective_work)

    def _root(self, square: np.ndarray) -> np.ndarray:
        """σ_a (Pa) from its square where nothing caps it, negative where γ_eff is (Pa²)."""
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
