"""A linear viscoelastic half-space: its contact modulus relaxes as a sum of exponentials, a Prony series.

After a sudden displacement the modulus falls from E*_0 to E*_∞,

    E*(t) = E*_∞ + Σ_i E*_i exp(−t/τ_i),        E*_0 = E*_∞ + Σ_i E*_i,

a spring beside any number of Maxwell branches. Poisson's ratio is the same at all times, so that all waves relax alike,
K(q, t) = E*(t) q/2, and a branch is one field: the displacement h_i that its spring still carries, h_i' = u' − h_i/τ_i.
"""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from contact_study.errors import InputError
from contact_study.numerics.arguments import positive
from contact_study.physics.solids.base import ElasticitySection
from contact_study.physics.solids.half_space import HalfSpace
from contact_study.study.schema.keys import key, quantity, sequence
from contact_study.study.schema.sections import MaterialSection


@dataclass(frozen=True)
class Viscoelastic(HalfSpace):
    """A half-space that relaxes; its :meth:`stiffness`, and the E* that it quotes, are those after all time.

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

    def keys(self, poissons_ratio: float) -> dict[str, Any]:
        moduli = [modulus * (1 - poissons_ratio**2) for modulus in self.branch_moduli]
        return {
            "kind": "viscoelastic",
            "branch_youngs_moduli": moduli,
            "relaxation_times": self.relaxation_times,
        }

    def scaled(self, length: float, stress: float) -> Self:
        return replace(super().scaled(length, stress), branch_moduli=tuple(np.array(self.branch_moduli) / stress))


@dataclass(frozen=True, kw_only=True)
class ViscoelasticSection(ElasticitySection):
    """A half-space with the material's E after all time, and branches that relax."""

    words = "relaxing from branches of moduli {branch_youngs_moduli} in times {relaxation_times}, "

    branch_youngs_moduli: tuple[float, ...] = key(
        sequence(quantity("Pa", positive=True)), "Young's moduli E_i of the branches, beside material.youngs_modulus"
    )
    relaxation_times: tuple[float, ...] = key(
        sequence(quantity("s", positive=True)), "times τ_i in which the branches relax, one for each"
    )

    def solid(self, material: MaterialSection) -> Viscoelastic:
        if len(self.branch_youngs_moduli) != len(self.relaxation_times):
            raise InputError(
                f"elasticity: {len(self.branch_youngs_moduli)} branch_youngs_moduli and {len(self.relaxation_times)} "
                "relaxation_times; give one of each for every branch"
            )
        plane_strain = 1 - material.poissons_ratio**2
        moduli = tuple(modulus / plane_strain for modulus in self.branch_youngs_moduli)
        try:
            return Viscoelastic(material.contact_modulus, moduli, self.relaxation_times)
        except ValueError as error:
            raise InputError(f"elasticity: {error}") from None
