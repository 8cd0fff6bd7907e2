"""Traction-separation laws, one a file."""

from contact_study.problem.keys import Kinds
from contact_study.problem.laws.base import TractionLaw
from contact_study.problem.laws.exponential import Exponential
from contact_study.problem.laws.hard_wall import HardWall
from contact_study.problem.laws.lennard_jones_9_3 import LennardJones93
from contact_study.problem.laws.lennard_jones_10_4 import LennardJones104

__all__ = [
    "INTERACTIONS",
    "LAWS",
    "Exponential",
    "HardWall",
    "LennardJones93",
    "LennardJones104",
    "TractionLaw",
    "make_law",
]

LAWS: dict[str, type[TractionLaw]] = {
    "lennard_jones_10_4": LennardJones104,
    "lennard_jones_9_3": LennardJones93,
    "exponential": Exponential,
    "hard_wall": HardWall,
}
INTERACTIONS = Kinds("law", {name: law.section for name, law in LAWS.items()})


def make_law(name: str, work_of_adhesion: float, length: float) -> TractionLaw:
    """The law called ``name`` in a study file, with Δγ (J/m²) and its length (m); a hard wall has neither.

    Raises
    ------
    ValueError
        If there is no law of that name, or an adhesive one is given other than positive numbers.
    """
    if name not in LAWS:
        raise ValueError(f"law = {name!r}: expected one of {', '.join(LAWS)}")
    return LAWS[name](work_of_adhesion, length) if LAWS[name].attracts else HardWall()
