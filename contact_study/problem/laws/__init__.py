"""Traction-separation laws, one a file."""

from contact_study.problem.laws.base import TractionLaw
from contact_study.problem.laws.hard_wall import HardWall
from contact_study.problem.laws.lennard_jones_9_3 import LennardJones93
from contact_study.problem.laws.lennard_jones_10_4 import LennardJones104

_ADHESIVE: dict[str, type[TractionLaw]] = {
    "lennard_jones_10_4": LennardJones104,
    "lennard_jones_9_3": LennardJones93,
}


def make_law(name: str, work_of_adhesion: float, length: float) -> TractionLaw | HardWall:
    """The law called ``name`` in a study file, with Δγ (J/m²) and its length (m); a hard wall has neither.

    Raises
    ------
    ValueError
        If there is no law of that name, or an adhesive one is given other than positive numbers.
    """
    if name == "hard_wall":
        return HardWall()
    if name not in _ADHESIVE:
        raise ValueError(f"law = {name!r}: expected one of {', '.join((*_ADHESIVE, 'hard_wall'))}")
    return _ADHESIVE[name](work_of_adhesion, length)
