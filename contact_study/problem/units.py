"""Dimensional input, parsed once at the edge into SI floats."""

import math
from functools import cache
from typing import Any

from contact_study.problem.errors import InputError


@cache
def _registry() -> Any:
    import pint  # takes a noticeable fraction of a second: only where input is parsed

    return pint.UnitRegistry()


def quantity(value: Any, unit: str, name: str) -> float:
    """A number in SI, or a string with a unit, as an SI float.

    Parameters
    ----------
    value : float, int or str
        For instance ``1e-9`` or ``"10 angstrom"``.
    unit : str
        The SI unit, for instance ``"m"``; ``"1"`` for a pure number.
    name : str
        The key, for the message.

    Raises
    ------
    InputError
        If the value is no finite number or has another dimension.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise InputError(f"{name} = {value!r}: expected {_expected(unit)}")
    number = _from_text(value, unit, name) if isinstance(value, str) else float(value)
    if not math.isfinite(number):
        raise InputError(f"{name} = {value!r}: must be a finite number")
    return number


def unit_of(text: str) -> str:
    """The unit that a string such as ``"0.1 GPa"`` carries, in a normal form."""
    return str(_registry().parse_expression(text).units)


def _from_text(text: str, unit: str, name: str) -> float:
    import pint

    try:
        parsed = _registry().parse_expression(text)
        if isinstance(parsed, int | float):
            parsed = _registry().Quantity(parsed)
        if parsed.dimensionless and unit not in ("1", ""):
            raise InputError(f"{name} = {text!r}: has no unit; expected {_expected(unit)}")
        return float(parsed.to("" if unit == "1" else unit).magnitude)
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
}


def _expected(unit: str) -> str:
    if unit == "1":
        return "a number"
    example = f', such as "{EXAMPLES[unit]}"' if unit in EXAMPLES else ""
    return f"a number in {unit} or a string with a unit{example}"
