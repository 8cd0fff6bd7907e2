"""Elastic solids, as solvers and theories see them: the stiffness K(q) of a wave of the surface."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from contact_study.numerics.arguments import finite, positive
from contact_study.numerics.grid import Grid


@dataclass(frozen=True)
class Elasticity(ABC):
    """Linear response of a block's flat surface to a normal pressure: p of wavenumber q displaces it by p/K(q).

    A subclass gives :meth:`stiffness`, and scales its further lengths and stresses in :meth:`scaled`.

    Parameters
    ----------
    contact_modulus : float
        E* > 0, the modulus that is quoted, the unit of stresses; of a homogeneous solid short waves feel E* q/2 (Pa).

    Examples
    --------
    >>> from contact_study.physics.solids import Elasticity, HalfSpace
    >>> isinstance(HalfSpace(1e9), Elasticity)
    True
    """

    on_any_grid: ClassVar[bool] = True  # K is known at the waves of any grid, of part of a surface for one
    contact_modulus: float

    def __post_init__(self) -> None:
        positive("contact_modulus", self.contact_modulus, "Pa")

    @abstractmethod
    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        """K(q) at wavenumbers q > 0 (1/m), of their shape (Pa/m)."""

    @property
    def depth(self) -> float:
        """Distance from the surface to what holds the block (m)."""
        return np.inf

    @property
    def layer_thickness(self) -> float:
        """Thickness of the layer under the surface, which may be all there is; infinite without one (m)."""
        return self.depth

    @property
    def mean_compliance(self) -> float:
        """Displacement of the surface's mean towards what holds the block, per mean pressure (m/Pa); zero without."""
        return 0.0

    def mean_stiffness_on(self, grid: Grid) -> float:
        """Stiffness of the mean displacement of a grid against what holds the block (Pa/m); zero where nothing does."""
        return 1 / self.mean_compliance if self.mean_compliance else 0.0

    def compression(self, mean_pressure: float) -> float:
        """How far a mean pressure (Pa), known or not, moves the surface's mean towards what holds the block (m)."""
        return self.mean_compliance * mean_pressure if self.mean_compliance else 0.0

    def compression_energy(self, mean_pressure: float) -> float:
        """Energy of that movement per area (J/m²)."""
        return 0.5 * self.compression(mean_pressure) * mean_pressure if self.mean_compliance else 0.0

    def stiffness_on(self, grid: Grid) -> np.ndarray:
        """K of each wavevector of a grid, zero at q = 0, in the layout of ``rfft2`` (Pa/m)."""
        stiffness_q, (q_y, q_x) = np.zeros(grid.spectrum_shape), grid.wavevectors
        half = grid.shape[0] // 2 + 1  # the rows of −qy are those of qy
        wavenumber = np.sqrt(q_y[:half] ** 2 + q_x**2)
        stiffness_q[:half].reshape(-1)[1:] = self.stiffness(wavenumber.reshape(-1)[1:])
        stiffness_q[half:] = stiffness_q[grid.shape[0] - half : 0 : -1]
        return stiffness_q

    def softest_modulus(self, longest: float, shortest: float) -> float:
        """The least E*(q) = 2 K(q)/q of waves between two lengths (m), that of a homogeneous half-space (Pa)."""
        # Solids change over an octave at the earliest.
        count = 2 + math.ceil(8 * math.log2(max(longest / shortest, 1.0)))
        q = np.geomspace(2 * np.pi / longest, 2 * np.pi / shortest, count)
        return float(np.min(contact_modulus_of(self.stiffness(q), q)))

    def scaled(self, length: float, stress: float) -> Self:
        """The same solid in other units: lengths divided by ``length`` (m), stresses by ``stress`` (Pa)."""
        return replace(self, contact_modulus=self.contact_modulus / stress)


def contact_modulus_of(stiffness: np.ndarray, wavenumber: np.ndarray) -> np.ndarray:
    """Calculate E*(q) = 2 K(q)/q, the contact modulus of the half-space that is as stiff for a wave (Pa)."""
    return 2 * stiffness / wavenumber


@dataclass(frozen=True)
class HalfSpace(Elasticity):
    """The homogeneous isotropic half-space, K(q) = E* q/2; the compression of its depth is left out.

    K. L. Johnson, Contact Mechanics, Cambridge 1985, ch. 13; A. Stanley & T. Kato, J. Tribol. 119, 481 (1997).

    Parameters
    ----------
    contact_modulus : float
        E* = E/(1 − ν²) (Pa).

    Examples
    --------
    >>> from contact_study.physics.solids import HalfSpace
    >>> f"{float(HalfSpace(1e9).stiffness(1e7)):.3g}"
    '5e+15'
    """

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        return 0.5 * self.contact_modulus * np.asarray(wavenumber)


@dataclass(frozen=True)
class Viscoelastic(HalfSpace):
    """A half-space whose contact modulus relaxes as a Prony series, E*(t) = E*_∞ + Σ_i E*_i exp(−t/τ_i).

    A spring beside Maxwell branches of one Poisson's ratio: all waves relax alike, K(q, t) = E*(t) q/2. A branch is one
    field, the displacement h_i that its spring still carries, h_i' = u' − h_i/τ_i. :meth:`stiffness` and
    ``contact_modulus`` are those after all time.

    Parameters
    ----------
    contact_modulus : float
        E*_∞ (Pa).
    branch_moduli, relaxation_times : tuple of float
        E*_i (Pa) and τ_i (s), one for each.

    Examples
    --------
    >>> from contact_study.physics.solids import Viscoelastic
    >>> f"{float(Viscoelastic(1e9, (9e9,), (1.0,)).stiffness(1e7)):.3g}"
    '5e+15'
    """

    branch_moduli: tuple[float, ...]
    relaxation_times: tuple[float, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self.branch_moduli) != len(self.relaxation_times) or not self.branch_moduli:
            raise ValueError(
                f"{len(self.branch_moduli)} branch_moduli and {len(self.relaxation_times)} relaxation_times: one of "
                "each for every branch"
            )
        for modulus, time in zip(self.branch_moduli, self.relaxation_times, strict=True):
            positive("branch_moduli", modulus, "Pa")
            positive("relaxation_times", time, "s")

    @property
    def instantaneous(self) -> HalfSpace:
        """The half-space that a sudden load meets, of modulus E*_0."""
        return HalfSpace(self.contact_modulus + sum(self.branch_moduli))

    @property
    def relaxed(self) -> HalfSpace:
        """The half-space that a slow load meets, of modulus E*_∞."""
        return HalfSpace(self.contact_modulus)

    def scaled(self, length: float, stress: float) -> Self:
        return replace(super().scaled(length, stress), branch_moduli=tuple(np.array(self.branch_moduli) / stress))


def _check_poissons_ratio(name: str, value: float) -> None:
    """Raise ValueError unless a number can be Poisson's ratio of an isotropic solid."""
    if not -1 < finite(name, value, "1") <= 0.5:
        raise ValueError(f"{name} = {value:g}: must be above -1 and at most 0.5")


@dataclass(frozen=True)
class Layer(Elasticity):
    """A homogeneous isotropic layer bonded to a rigid base.

    K = E* q / 2S, S = [(3−4ν) sinh 2qd − 2qd] / [(3−4ν) cosh 2qd + 2(qd)² + 5 − 12ν + 8ν²]: e^(±qz), z e^(±qz) under
    the conditions of a free face without shear and one that is held. Thick layers are half-spaces, S → 1; thin
    compressible ones springs side by side, K → (1−ν) E / [(1+ν)(1−2ν) d], incompressible ones K → 3E*/(4 q² d³).

    Parameters
    ----------
    contact_modulus, poissons_ratio, thickness : float
        E* = E/(1 − ν²) (Pa), ν, above −1 and up to 0.5 (incompressible), and d (m).

    Examples
    --------
    >>> from contact_study.physics.solids import Layer
    >>> f"{float(Layer(1e9, 0.4, 1e-6).stiffness(1e7)):.3g}"
    '5e+15'
    """

    poissons_ratio: float
    thickness: float

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_poissons_ratio("poissons_ratio", self.poissons_ratio)
        positive("thickness", self.thickness, "m")

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        q, ratio = np.asarray(wavenumber, dtype=float), self.poissons_ratio
        x = self.thickness * q
        # Both brackets of S times 2 exp(−2x), which no thickness overflows.
        decay = np.exp(-2 * x)
        above = 2 * (3 - 4 * ratio) * sinh_less_argument(2 * x) + 8 * (1 - 2 * ratio) * x * decay
        below = (3 - 4 * ratio) * (1 + decay**2) + 2 * (2 * x**2 + 5 - 12 * ratio + 8 * ratio**2) * decay
        return 0.5 * self.contact_modulus * q * below / above

    @property
    def depth(self) -> float:
        return self.thickness

    @property
    def mean_compliance(self) -> float:
        """(1+ν)(1−2ν) d / [(1−ν) E]: compression without lateral strain, none if incompressible (m/Pa)."""
        ratio = self.poissons_ratio
        return (1 - 2 * ratio) * self.thickness / ((1 - ratio) ** 2 * self.contact_modulus)

    def scaled(self, length: float, stress: float) -> Self:
        return replace(super().scaled(length, stress), thickness=self.thickness / length)


def sinh_less_argument(y: np.ndarray) -> np.ndarray:
    """(sinh y − y) exp(−y) for y >= 0, without cancellation where y is small."""
    square, rest = np.minimum(y, 1.0) ** 2, np.zeros_like(y)
    # y³/3! + y⁵/5! + … + y¹⁷/17!, the rest of which is 1e-16 of it at y = 1.
    for order in range(17, 3, -2):
        rest = (1 + rest) * square / (order * (order - 1))
    return np.where(y < 1, y**3 / 6 * (1 + rest) * np.exp(-y), 0.5 * (1 - np.exp(-2 * y)) - y * np.exp(-y))


@dataclass(frozen=True)
class Layered(Elasticity):
    """A homogeneous isotropic layer bonded to a half-space of another material: coatings, oxides, skins.

    K = E*q/2S, S = [1 + 4m x e^(−2x) − mn e^(−4x)]/[1 − (m + n + 4mx²) e^(−2x) + mn e^(−4x)], x = qd; with shear moduli
    μ, μ_b m = (μ/μ_b − 1)/(μ/μ_b + 3 − 4ν), n = 1 − 4(1 − ν)/[1 + (μ/μ_b)(3 − 4ν_b)]. Short waves feel the layer,
    S → 1, long ones the base, S → E*/E*_b; on a rigid base it is the bonded layer.

    Parameters
    ----------
    contact_modulus, poissons_ratio, thickness : float
        E* = E/(1 − ν²) (Pa), ν, above −1 and up to 0.5, and d (m) of the layer.
    base_modulus, base_poissons_ratio : float
        E*_b, the contact modulus of the half-space (Pa), and ν_b.

    Examples
    --------
    >>> from contact_study.physics.solids import Layered
    >>> f"{float(Layered(1e9, 0.4, 1e-6, 1e11, 0.3).stiffness(1e7)):.3g}"
    '5e+15'
    """

    poissons_ratio: float
    thickness: float
    base_modulus: float
    base_poissons_ratio: float

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_poissons_ratio("poissons_ratio", self.poissons_ratio)
        _check_poissons_ratio("base_poissons_ratio", self.base_poissons_ratio)
        positive("thickness", self.thickness, "m")
        positive("base_modulus", self.base_modulus, "Pa")

    @property
    def layer_thickness(self) -> float:
        return self.thickness

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        q, ratio, base_ratio = np.asarray(wavenumber, dtype=float), self.poissons_ratio, self.base_poissons_ratio
        # E* = 2μ/(1 − ν).
        shear = self.contact_modulus * (1 - ratio) / (self.base_modulus * (1 - base_ratio))
        m = (shear - 1) / (shear + 3 - 4 * ratio)
        n = 1 - 4 * (1 - ratio) / (1 + shear * (3 - 4 * base_ratio))
        x = self.thickness * q
        decay = np.exp(-2 * x)
        above = 1 + 4 * m * x * decay - m * n * decay**2
        below = 1 - (m + n + 4 * m * x**2) * decay + m * n * decay**2
        return 0.5 * self.contact_modulus * q * below / above

    def scaled(self, length: float, stress: float) -> Self:
        return replace(
            super().scaled(length, stress), thickness=self.thickness / length, base_modulus=self.base_modulus / stress
        )


def stiffnesses(modulus: float, ratio: float, axial_modulus: float, axial_ratio: float) -> tuple[float, float, float]:
    """Calculate C₁₁, C₁₃, C₃₃ by moduli (Pa) and ratios, in the plane and axial; ValueError if no solid has them."""
    coupling = modulus / axial_modulus * axial_ratio**2
    rest = 1 - ratio - 2 * coupling
    if not rest > 0:
        raise ValueError(f"1 − ν − 2 ν_z² E/E_z = {rest:.3g} must be positive")
    c11 = modulus * (1 - coupling) / ((1 + ratio) * rest)
    return c11, modulus * axial_ratio / rest, axial_modulus * (1 - ratio) / rest


def indentation_modulus(c11: float, c13: float, c33: float, c44: float) -> float:
    """Calculate E* of a half-space whose normal (3) is the axis of symmetry (Pa); isotropic, it is E/(1 − ν²)."""
    along = 1 / c44 + 2 / (np.sqrt(c11 * c33) + c13)
    return 2 * float(np.sqrt((c11 * c33 - c13**2) / c11 / along))
