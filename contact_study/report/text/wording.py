"""Numbers, keys of a study and lists in words: few digits, true minus signs, symbols and units of the field."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from contact_study.inputs.units import quantity
from contact_study.physics.laws import LAWS
from contact_study.plots.style import Unit, largest, length_unit, pressure_unit

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float, digits: int, plus: bool = False) -> str:
    """So many significant digits; a power of ten in place of an exponent."""
    mantissa, _, exponent = f"{value:{'+' if plus else ''}.{digits}g}".partition("e")
    if not exponent:
        return mantissa.replace("-", "−")
    power = f"10{str(int(exponent)).translate(_RAISED)}"
    return power if mantissa == "1" else f"{mantissa} · {power}".replace("-", "−")


def fixed(value: float, decimals: int, plus: bool = False) -> str:
    """So many decimals, and no minus sign before a zero."""
    return f"{value:{'+' if plus else ''}z.{decimals}f}".replace("-", "−")


def with_error(value: float, error: float, decimals: int, plus: bool = False) -> str:
    """A number with its standard error: so many decimals, more where the error would read as zero; NaN is none."""
    if not np.isfinite(error):
        return fixed(value, decimals, plus)
    if error > 0:
        decimals = max(decimals, -int(np.floor(np.log10(error))))
    return f"{fixed(value, decimals, plus)} ± {fixed(error, decimals)}"


def percent_of(value: float, error: float = np.nan, plus: bool = False) -> str:
    """A fraction in per cent; at most one digit behind the point, which is as much as it can mean."""
    return f"{with_error(100 * value, 100 * error, 0 if abs(value) >= 0.1 else 1, plus)} %"


def length(value: float) -> str:
    """A length in the unit that suits it."""
    unit = length_unit(value)
    return f"{value / unit.size:.6g} {unit.name}"


def pressure(value: float, digits: int = 6) -> str:
    """A pressure in the unit that suits it."""
    unit = pressure_unit(abs(value))
    return f"{number(value / unit.size, digits)} {unit.name}"


def force(value: float) -> str:
    """A force to four digits, in newtons, or in nN or µN or mN."""
    for name, size in (("nN", 1e-9), ("µN", 1e-6), ("mN", 1e-3)):
        if abs(value) < 1e3 * size:
            return f"{number(value / size, 4)} {name}"
    return f"{number(value, 4)} N"


def span(low: str, high: str) -> str:
    """Two numbers with a unit as the ends of a range, the unit once where it is the same."""
    (first, _, unit), (last, _, other) = low.rpartition(" "), high.rpartition(" ")
    if low == high:
        return high
    return f"{first} to {last} {unit}" if unit == other and first and last else f"{low} to {high}"


PRESCRIBED = {"pressure": "p", "gap": "ū", "approach": "δ"}
"""Symbol of what a path prescribes."""


def control_unit(models: Mapping[str, xr.Dataset], control: str) -> Unit:
    """The unit of what was prescribed, for a whole study."""
    most = max(largest(dataset[f"applied_{control}"]) for dataset in models.values())
    return pressure_unit(most) if control == "pressure" else length_unit(most)


def listed(words: Iterable[str], last: str = "and") -> str:
    """Different words in a row: "a, b and c"."""
    *head, tail = dict.fromkeys(words)
    return f"{', '.join(head)} {last} {tail}" if head else tail


def varied(values: Iterable[str], last: str = "and", most: int = 8) -> str:
    """The different values of a key over a sweep: all of them, or the first and last of many."""
    different = list(dict.fromkeys(values))
    if len(different) > most:
        return f"{different[0]} to {different[-1]} ({len(different)} values)"
    return listed(different, last)


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
    """A value of a study's key (SI) with the unit that suits it."""
    if name == "law":
        return LAWS[value].title
    if isinstance(value, str | bool | np.bool_):
        return str(value).replace("_", " ")
    if units == "m":
        return length(value)
    if units == "Pa":
        return pressure(value)
    if units == "J":
        return f"{number(value / quantity('1 meV', 'J', name), 6)} meV"
    return f"{number(value, 6)}{'' if units == '1' else ' ' + units.replace(' m-2', '/m²')}"
