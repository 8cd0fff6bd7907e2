"""Traction-separation laws: interaction energy per area as a function of the local gap."""

from dataclasses import MISSING, fields

from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.laws.exponential import Dugdale, DugdaleCore, Exponential, ExponentialCore, Morse
from contact_study.physics.laws.lennard_jones import HardWall, LennardJones, LennardJones93, LennardJones104, Repulsive
from contact_study.physics.laws.tabulated import TabulatedLaw

__all__ = [
    "LAWS",
    "Dugdale",
    "DugdaleCore",
    "Exponential",
    "ExponentialCore",
    "HardWall",
    "LennardJones",
    "LennardJones93",
    "LennardJones104",
    "Morse",
    "Repulsive",
    "TabulatedLaw",
    "TractionLaw",
    "make_law",
]

LAWS: dict[str, type[TractionLaw]] = {
    "lennard_jones_10_4": LennardJones104,
    "lennard_jones_9_3": LennardJones93,
    "morse": Morse,
    "exponential_core": ExponentialCore,
    "dugdale_core": DugdaleCore,
    "tabulated": TabulatedLaw,
    "exponential": Exponential,
    "dugdale": Dugdale,
    "repulsive": Repulsive,
    "hard_wall": HardWall,
}


def make_law(name: str, work_of_adhesion: float, length: float, **own: float) -> TractionLaw:
    """Make the law called ``name`` in a study file from Δγ (J/m²), its length (m) and its further fields.

    A hard wall has none of these, a soft repulsion no Δγ; a tabulated law is made by :meth:`TabulatedLaw.through`.

    Raises ValueError if there is no law of that name, or it is given other than positive numbers or the fields it has.
    """
    by_name = [known for known in LAWS if known != "tabulated"]
    if name not in by_name:
        raise ValueError(f"law = {name!r}: expected one of {', '.join(by_name)}")
    law = LAWS[name]
    if law is HardWall:
        return HardWall()
    known = {field.name: field.default for field in fields(law)[2:]}
    if unknown := [given for given in own if given not in known]:
        raise ValueError(f"{unknown[0]}: law = {name!r} has no such field; its own: {', '.join(known) or 'none'}")
    if needed := [field for field, default in known.items() if default is MISSING and field not in own]:
        raise ValueError(f"{needed[0]}: law = {name!r} needs it")
    return law(work_of_adhesion if law.attracts else 0.0, length, **own)
