"""Half-spaces: elastic and isotropic, viscoelastic, and the modulus of a transversely isotropic one."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from contact_study.numerics.arguments import positive
from contact_study.physics.solids.base import Elasticity


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
    """A linear viscoelastic half-space, whose contact modulus relaxes as a sum of exponentials (Prony series).

    After a sudden displacement the modulus falls from E*_0 to E*_∞,

        E*(t) = E*_∞ + Σ_i E*_i exp(−t/τ_i),        E*_0 = E*_∞ + Σ_i E*_i,

    a spring beside any number of Maxwell branches. Poisson's ratio is the same at all times, so that all waves relax
    alike, K(q, t) = E*(t) q/2. A branch is one field: the displacement h_i that its spring still carries,
    h_i' = u' − h_i/τ_i. :meth:`stiffness` and ``contact_modulus`` are those after all time.

    Parameters
    ----------
    contact_modulus : float
        E*_∞ (Pa).
    branch_moduli : tuple of float
        E*_i (Pa).
    relaxation_times : tuple of float
        τ_i (s), one for each.

    Raises
    ------
    ValueError
        If a number is not positive, or there are not as many times as moduli.

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


def stiffnesses(modulus: float, ratio: float, axial_modulus: float, axial_ratio: float) -> tuple[float, float, float]:
    """Calculate the elastic constants C₁₁, C₁₃ and C₃₃ of a transversely isotropic solid (Pa).

    Parameters
    ----------
    modulus, ratio : float
        Young's modulus (Pa) and Poisson's ratio in the plane.
    axial_modulus, axial_ratio : float
        Young's modulus along the normal (Pa), and contraction in the plane over extension along the normal.

    Raises ValueError if no elastic solid has them: its energy would not be positive.
    """
    coupling = modulus / axial_modulus * axial_ratio**2
    rest = 1 - ratio - 2 * coupling
    if not rest > 0:
        raise ValueError(f"1 − ν − 2 ν_z² E/E_z = {rest:.3g} must be positive")
    return (
        modulus * (1 - coupling) / ((1 + ratio) * rest),
        modulus * axial_ratio / rest,
        axial_modulus * (1 - ratio) / rest,
    )


def indentation_modulus(c11: float, c13: float, c33: float, c44: float) -> float:
    """Calculate E* of a half-space whose normal (3) is the axis of symmetry (Pa).

    E* = 2 √[(C₁₁C₃₃ − C₁₃²)/C₁₁ / (1/C₄₄ + 2/(√(C₁₁C₃₃) + C₁₃))]; isotropic, it is E/(1 − ν²). The tests compare it
    with an integration of the equations of elasticity.
    """
    along = 1 / c44 + 2 / (np.sqrt(c11 * c33) + c13)
    return 2 * float(np.sqrt((c11 * c33 - c13**2) / c11 / along))
