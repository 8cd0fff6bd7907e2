"""Dimensional input, parsed once at the edge into SI floats."""

import contextlib
import math
import re
from collections.abc import Sequence
from functools import cache, lru_cache
from typing import Any

from contact_study.inputs.errors import InputError
from contact_study.inputs.files import own_cache_folder

# Moments take the fifth power of a wavevector: within these limits no product over- or underflows.
SMALLEST, LARGEST = 1e-40, 1e40
# The spectrum C(q) is compared with q⁻⁴: atomic roughness, q = 1e10 1/m, has 1e-45 m⁴.
SMALLEST_OF = {"m^4": 1e-90}
# One number and a product of units. Pint alone would also calculate, for as long as "9**9**9 m" takes, and would read
# "GPa" as 1 GPa.
_LONGEST = 100
_FACTOR = r"[^\W\d]+(?:\s*(?:\^|\*\*)\s*-?\d)?"
_QUANTITY = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    rf"\s*(?P<unit>(?:{_FACTOR}(?:\s*[*/·]\s*|\s+))*{_FACTOR}|)\s*"
)
# Within a list each number has a unit: one without before a comma is a part of a number.
_DECIMAL_COMMA = re.compile(
    r"(?<![\w.,])(?<![eE][+-])(?P<whole>[+-]?\d+),(?P<rest>\d+(?:[eE][+-]?\d+)?\s*(?![eE][+-]?\d)[^\W\d].*)"
)

# Everyday units by the SI unit of their kind, each as pint converts it to the last bit: pint takes 0.3 s to import.
_COMMON = {
    "m": {
        **{"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "nm": 1e-9, "pm": 1e-12},
        **{"angstrom": 1e-10, "Å": 1e-10},
    },
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9},
    "J": {"J": 1.0, "eV": 1.602176634e-19, "meV": 1.6021766339999998e-22},
    "J/m^2": {"J/m^2": 1.0, "mJ/m^2": 1e-3, "N/m": 1.0},
    "N": {"N": 1.0, "mN": 1e-3, "uN": 1e-6, "nN": 1e-9},
    "K": {"K": 1.0},
    "kg": {"kg": 1.0, "g": 1e-3, "u": 1.66053906892e-27, "amu": 1.66053906892e-27, "Da": 1.66053906892e-27},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "ps": 1e-12, "fs": 1e-15},
    "m/s": {"m/s": 1.0},
    "rad": {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180},
    "N/m": {"N/m": 1.0, "mN/m": 1e-3, "nN/nm": 1.0},
    "m^-1": {"m^-1": 1.0, "um^-1": 1e6, "nm^-1": 999999999.9999999, "angstrom^-1": 1e10},
    "m^4": {"m^4": 1.0, "um^4": 9.999999999999997e-25, "nm^4": 1.0000000000000003e-36},
}


@cache
def _registry() -> Any:
    import pint  # slow to import

    try:
        return pint.UnitRegistry(cache_folder=own_cache_folder() / "units")  # the units' definitions, parsed
    except Exception:  # a damaged or forbidden folder raises many types
        return pint.UnitRegistry()


def quantity(value: Any, unit: str, name: str) -> float:
    """Convert a number in SI, or a string with a unit, to an SI float; ``unit`` is ``"1"`` for a pure number."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise InputError(f"{name} = {value!r}: expected {_expected(unit)}")
    try:
        number = _from_text(value, unit, name) if isinstance(value, str) else float(value)
    except OverflowError:
        digits = int(value.bit_length() * math.log10(2)) + 1  # type: ignore[union-attr]
        raise InputError(
            f"{name}: a number of {digits} digits is far from any size of use; expected {_expected(unit)}"
        ) from None
    if not math.isfinite(number):
        raise InputError(f"{name} = {value!r}: must be a finite number")
    if number and not SMALLEST_OF.get(unit, SMALLEST) <= abs(number) <= LARGEST:
        raise InputError(f"{name} = {value!r}: is far from any size of use; expected {_expected(unit)}")
    return number


def unit_of(text: str) -> str:
    """Return the unit of a string such as ``"0.1 GPa"`` as it is written."""
    return _parts(text)[1]


def refuse_decimal_comma(text: str, name: str) -> None:
    """Raise InputError if a text has a comma where its number has a decimal sign, as in "10,5 um"."""
    found = _DECIMAL_COMMA.search(text)
    if found:
        meant = f"{found['whole']}.{found['rest']}"
        raise InputError(
            f'{name} = {text!r}: use a decimal point, "{meant}"; of several values each has a unit, "10 um, 5 um"'
        )


def is_a(value: Any, unit: str) -> bool:
    """Test whether a value is a string with a unit of the same kind as another unit."""
    if not isinstance(value, str):
        return False
    written = _parts(value)[1]
    if any(written in known for known in _COMMON.values()):
        return written in _COMMON.get(unit, ())
    with contextlib.suppress(InputError):
        quantity(value, unit, "")
        return True
    return False


def length(*metres: float) -> str:
    """Write lengths in the unit that suits the largest, to four digits: ``1.024 x 2 µm``."""
    return _suited(metres, ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"), (1e-12, "pm")), 4)


def stress(pascals: float) -> str:
    """Write a stress in the unit that suits it, to three digits."""
    return _suited((pascals,), ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa")), 3)


def force(newtons: float) -> str:
    """Write a force in the unit that suits it, to three digits."""
    return _suited((newtons,), ((1.0, "N"), (1e-3, "mN"), (1e-6, "µN"), (1e-9, "nN"), (1e-12, "pN")), 3)


def _suited(values: Sequence[float], known: Sequence[tuple[float, str]], digits: int) -> str:
    largest = max(abs(value) for value in values)
    size, unit = next((pair for pair in known if largest >= 0.9995 * pair[0]), known[-1])
    return " x ".join(f"{value / size:.{digits}g}" for value in values) + f" {unit}"


def _parts(text: str) -> tuple[str, str]:
    """Number and unit, empty if the text is anything else."""
    match = _QUANTITY.fullmatch(text) if len(text) <= _LONGEST else None
    return (match["number"], match["unit"]) if match else ("", "")


@lru_cache(maxsize=10_000)
def _from_text(text: str, unit: str, name: str) -> float:
    refuse_decimal_comma(text, name)
    number, written = _parts(text)
    if factor := _COMMON.get(unit, {}).get(written):
        return float(number) * factor
    import pint  # slow to import

    try:
        size = float(number)
        if unit == "1" and written:
            raise InputError(f"{name} = {text!r}: must be a pure number, without a unit")
        if unit != "1" and not written:
            raise InputError(f"{name} = {text!r}: has no unit; expected {_expected(unit)}")
        return float(_registry().Quantity(size, written).to("" if unit == "1" else unit).magnitude)
    except pint.DimensionalityError as error:
        raise InputError(
            f"{name} = {text!r}: a unit of {error.units1} cannot be converted; expected {_expected(unit)}"
        ) from None
    except pint.UndefinedUnitError as error:
        raise InputError(f"{name} = {text!r}: unknown unit {error.unit_names!r}; expected {_expected(unit)}") from None
    except InputError:
        raise
    except Exception:  # pint's parser raises several unrelated types on malformed text
        raise InputError(f"{name} = {text!r}: cannot be read; expected {_expected(unit)}") from None


EXAMPLES = {
    "m": "10 nm",
    "Pa": "1 GPa",
    "J": "18.6 meV",
    "J/m^2": "0.69 J/m^2",
    "kg": "197 u",
    "N": "10 nN",
    "K": "300 K",
    "s": "10 fs",
    "m/s": "10 m/s",
    "N/m": "0.2 N/m",
    "s^-1": "0.1 ps^-1",
    "m^-1": "0.3 nm^-1",
    "m^4": "2 nm^4",
    "Pa/m": "2 GPa/nm",
    "rad": "30 deg",
}


def _expected(unit: str) -> str:
    if unit == "1":
        return "a number"
    example = f', such as "{EXAMPLES[unit]}"' if unit in EXAMPLES else ""
    return f"a number in {unit} or a string with a unit{example}"
