"""Lennard-Jones half-spaces facing each other: the 9-3 law.

All atoms of the one half-space attract all of the other, where the 10-4 law knows the two outermost layers only:
φ(d) = −Δγ[(4/3)(z0/d)² − (1/3)(z0/d)⁸], σ(d) = (8Δγ/3z0)[(z0/d)³ − (z0/d)⁹]; used for
adhesive spheres since V. M. Muller, V. S. Yushchenko & B. V. Derjaguin, J. Colloid Interface Sci. 77, 91 (1980).
"""

from dataclasses import dataclass

from contact_study.errors import InputError
from contact_study.physics.laws.lennard_jones import LennardJones
from contact_study.study.schema.interaction import SmoothInteraction


@dataclass(frozen=True, kw_only=True)
class HalfSpacesInteraction(SmoothInteraction):
    """Keys of the 9-3 law, whose adhesion no pair of layers gives."""

    def __post_init__(self):
        super().__post_init__()
        if self.well_depth is not None:
            raise InputError(
                'interaction.well_depth: law = "lennard_jones_9_3" is that of two half-spaces, whose adhesion needs '
                "the number of atoms per volume of both; give interaction.work_of_adhesion and length = z0 "
                "(docs/conventions.md has both from ε, r0 and the densities)"
            )


@dataclass(frozen=True)
class LennardJones93(LennardJones):
    """The 9-3 law; ``length`` is z0, the equilibrium distance."""

    title = "9-3"
    words = "in the 9-3"
    of_pairs = True
    section = HalfSpacesInteraction
    exponent = 3
