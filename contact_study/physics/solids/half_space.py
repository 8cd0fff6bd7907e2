"""The elastic half-space, homogeneous and isotropic: K(q) = E* q/2.

A frictionless pressure of wavenumber q on a half-space of contact modulus E* displaces its surface by 2p/(E* q)
(K. L. Johnson, Contact Mechanics, Cambridge 1985, ch. 13; A. Stanley & T. Kato, J. Tribol. 119, 481 (1997)).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_study.physics.solids.base import Elasticity, ElasticitySection
from contact_study.study.schema.sections import MaterialSection


@dataclass(frozen=True)
class HalfSpace(Elasticity):
    """A half-space of contact modulus E* = E/(1 − ν²); the compression of its depth is left out."""

    def stiffness(self, wavenumber: np.ndarray | float) -> np.ndarray:
        return 0.5 * self.contact_modulus * np.asarray(wavenumber)

    def keys(self, poissons_ratio: float) -> dict[str, Any]:
        return {"kind": "half_space"}


@dataclass(frozen=True, kw_only=True)
class HalfSpaceSection(ElasticitySection):
    """The default, which needs no key."""

    words = ""
    may_be_free = True

    def solid(self, material: MaterialSection) -> HalfSpace:
        return HalfSpace(material.contact_modulus)
