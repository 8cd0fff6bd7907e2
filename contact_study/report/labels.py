"""Keys of a study and their values as a reader knows them: symbols of the field, units that suit."""

from typing import Any

import numpy as np

from contact_study.physics.laws import LAWS
from contact_study.report.wording import length, number, pressure
from contact_study.units import quantity

# Keys that have a symbol in the field; any other is called by its name.
_SYMBOLS = {
    "well_depth": "ε",
    "hurst_exponent": "H",
    "rms_height": "h_rms",
    "work_of_adhesion": "Δγ",
    "length": "r₀",
    "contact_distance": "d_c",
    "youngs_modulus": "E",
    "poissons_ratio": "ν",
    "low_mode": "q_L L/2π",
    "roll_off_mode": "q₀ L/2π",
    "cutoff_mode": "q₁ L/2π",
    "radius": "R",
}


def coordinate_label(name: str, value: Any, units: str = "1") -> str:
    """One swept coordinate (SI) in the symbols and units of the field."""
    if name == "well_depth_ratio":
        return "ε = ε₀" if value == 1 else f"ε = {number(value, 6)} ε₀"
    return f"{_SYMBOLS.get(name, name.replace('_', ' '))} = {key_value(name, value, units)}"


def key_value(name: str, value: Any, units: str = "1") -> str:
    """A value of a study's key (SI) with the unit that suits it.

    Parameters
    ----------
    name : str
        Key, by its last part.
    value : object
        A number or a word.
    units : str
        UDUNITS, "1" for a pure number or a word.
    """
    if name == "law":
        return law_name(value)
    if isinstance(value, str | bool | np.bool_):
        return str(value).replace("_", " ")
    if units == "m":
        return length(value)
    if units == "Pa":
        return pressure(value)
    if units == "J":
        return f"{number(value / quantity('1 meV', 'J', name), 6)} meV"
    return f"{number(value, 6)}{'' if units == '1' else ' ' + units.replace(' m-2', '/m²')}"


def law_name(law: str) -> str:
    """A traction-separation law in words: "10-4", "9-3", "hard wall"."""
    return LAWS[law].title
