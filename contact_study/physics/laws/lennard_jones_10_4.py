"""Lennard-Jones atoms smeared over two facing layers: the 10-4 law.

One layer of the block and one of the substrate interact through V(r) = 4ε[(r0/r)¹² − (r0/r)⁶]; integrating over both
areal densities n_a, n_b gives φ(d) = −Δγ (5/3)[(r0/d)⁴ − (2/5)(r0/d)¹⁰] with Δγ = (6π/5) n_a n_b ε r0².
"""

from dataclasses import dataclass

import numpy as np

from contact_study.physics.laws.lennard_jones import LennardJones


def work_of_adhesion(well_depth: float, length: float, block_density: float, substrate_density: float) -> float:
    """Δγ = (6π/5) n_a n_b ε r0² of two smeared layers (J/m²).

    Parameters
    ----------
    well_depth : float
        ε of the pair potential (J).
    length : float
        r0 of the pair potential (m).
    block_density, substrate_density : float
        Atoms per area of each layer (1/m²).
    """
    return 6 * np.pi / 5 * block_density * substrate_density * well_depth * length**2


@dataclass(frozen=True)
class LennardJones104(LennardJones):
    """The 10-4 law: σ(d) = (20Δγ/3r0)[(r0/d)⁵ − (r0/d)¹¹]; ``length`` is r0, the equilibrium distance."""

    title = "10-4"
    words = "smeared into the 10-4"
    of_pairs = True
    exponent = 5
