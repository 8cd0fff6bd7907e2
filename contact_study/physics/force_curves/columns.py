"""Quantities of a measured force curve: the names that files give them, their units, and the curve as a file has it."""

import re
from dataclasses import dataclass, field

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.inputs.number_tables import TableError
from contact_study.inputs.units import quantity

# SI units of each quantity, one if it has one kind of unit, and names for it in a file.
QUANTITIES: dict[str, tuple[tuple[str, ...], str]] = {
    "force": (("N",), "force|load|normal force|f|fn"),
    "displacement": (("m",), "displacement|indentation|approach|penetration|depth|delta|δ"),
    "separation": (("m",), "separation|tip sample separation|distance|tip position"),
    "z": (("m",), "z|piezo|z piezo|z position|z sensor|zsnsr|stage"),
    "height": (("m",), "height|height measured|height piezo"),
    "deflection": (("m", "V"), "deflection|defl|vertical deflection"),
    "contact_radius": (("m",), "contact radius|radius|a"),
    "contact_area": (("m^2",), "contact area|area"),
    "time": (("s",), "time|t"),
    "branch": (("1",), "branch|segment|direction"),
}
LEFT_OUT = "-"  # name of a column to leave out
_NAMES = {name: known for known, (_, names) in QUANTITIES.items() for name in names.split("|")}
_UNCERTAIN = re.compile(r"\b(uncertainty|standard error|error|standard deviation|std|sigma)\b( of)?|σ|±")
_BRACKETED = re.compile(r"(?P<name>.*?)\s*[\[(]\s*(?P<unit>[^\[\]()]*?)\s*[\])]\s*")
_SLASHED = re.compile(r"(?P<name>[^/]*?[^/\s])\s*/\s*(?P<unit>[^\s/]+(?:/[^\s/]+)?)\s*")
_JOINED = re.compile(r"(?P<name>.+)_(?P<unit>[^\W_]+)")


@dataclass
class RawCurve:
    """Columns of a file in SI by their quantity, those of their uncertainties, and options that the file gives."""

    columns: dict[str, np.ndarray]
    uncertainties: dict[str, np.ndarray] = field(default_factory=dict)
    options: dict[str, str] = field(default_factory=dict)
    spring_constant: float | None = None  # N/m
    baseline: bool = False  # whether the zero of its force is that of a detector, and not of the force


def named(cell: str, unit: str = "") -> tuple[str, bool, float, str]:
    """Quantity of a column, whether it is its uncertainty, the factor of its numbers to SI, and the SI unit.

    The cell is a name with a unit, ``force (nN)``, ``force [nN]``, ``force / nN`` or ``force_nN``, or a name whose unit
    is given.
    """
    cell = cell.strip().strip("\"'").strip()
    if cell == LEFT_OUT:
        return LEFT_OUT, False, 1.0, ""
    found = _BRACKETED.fullmatch(cell) or _SLASHED.fullmatch(cell)
    # "height (measured)" names no unit.
    if found and (known := known_name(found["name"])) and not (unit and known_name(cell)):
        return *known, *_factor(cell, known[0], found["unit"])
    if known := known_name(cell):
        return *known, *_factor(cell, known[0], unit)
    if (found := _JOINED.fullmatch(cell)) and (known := known_name(found["name"])):
        return *known, *_factor(cell, known[0], found["unit"])
    raise TableError(
        f"{{path}} has an unknown column, {cell!r}; name it {', '.join(QUANTITIES)}, or {LEFT_OUT} to leave it out, "
        'as in columns = "displacement (nm), force (nN)"'
    )


def known_name(name: str) -> tuple[str, bool] | None:
    """Quantity that a name without a unit means, and whether it is its uncertainty; None for other names."""
    plain = re.sub(r"[_\-()\[\]\s]+", " ", name).strip().lower()
    certain = " ".join(_UNCERTAIN.sub(" ", plain).split())
    return (_NAMES[certain], certain != plain) if certain in _NAMES else None


def _factor(cell: str, known: str, unit: str) -> tuple[float, str]:
    kinds = QUANTITIES[known][0]
    if kinds == ("1",):
        return 1.0, "1"
    if not unit.strip():
        raise TableError(f"{{path}} does not give the unit of {cell!r}; write it as in {known} ({_example(known)})")
    spelt = re.sub(r"([^\W\d])([²2])$", r"\1^2", unit.strip())
    for kind in kinds:
        try:
            return quantity(f"1 {spelt}", kind, cell), kind
        except InputError as error:
            fault = error
    raise TableError(f"{{path}}, column {fault}") from None


def _example(known: str) -> str:
    return {"N": "nN", "m": "nm", "m^2": "um^2", "s": "s"}[QUANTITIES[known][0][0]]
