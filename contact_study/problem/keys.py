"""Keys of a study file: how each is read, checked and described, in one declaration beside the dataclass field.

A section of the study file is a frozen dataclass whose fields carry a :class:`Key`; :func:`bind` turns a TOML table
into the dataclass and names the culprit of any mistake; the commands' ``--help`` is made from the same declarations.
"""

import contextlib
import dataclasses
import difflib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from contact_study.problem import units
from contact_study.problem.errors import InputError

Section = TypeVar("Section")
Reader = tuple[Callable[[Any, str], Any], str]  # how a value is read, and its kind in words


@dataclass(frozen=True)
class Key:
    """How one key is read and described."""

    read: Callable[[Any, str], Any]
    kind: str
    description: str


def key(reader: Reader, description: str, default: Any = dataclasses.MISSING) -> Any:
    """A dataclass field bound to a key of the study file; without a default the key must be given."""
    read, kind = reader
    return dataclasses.field(default=default, metadata={"key": Key(read, kind, description)})


def quantity(
    unit: str, *, positive: bool = False, minimum: float | None = None, maximum: float | None = None
) -> Reader:
    """A dimensional number, in SI or as a string with a unit; ``positive`` excludes zero."""

    def read(value: Any, name: str) -> float:
        number = units.quantity(value, unit, name)
        if positive and number <= 0:
            raise InputError(f"{name} = {value!r}: must be positive")
        if minimum is not None and number < minimum:
            raise InputError(f"{name} = {value!r}: must be at least {minimum:g}")
        if maximum is not None and number > maximum:
            raise InputError(f"{name} = {value!r}: must be at most {maximum:g}")
        return number

    return read, unit if unit != "1" else "number"


def integer(minimum: int | None = None, maximum: int | None = None) -> Reader:
    """A whole number."""

    def read(value: Any, name: str) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise InputError(f"{name} = {value!r}: expected a whole number")
        if minimum is not None and value < minimum:
            raise InputError(f"{name} = {value!r}: must be at least {minimum}")
        if maximum is not None and value > maximum:
            raise InputError(f"{name} = {value!r}: must be at most {maximum}")
        return value

    return read, "integer"


def choice(*allowed: str) -> Reader:
    """One of a few words."""

    def read(value: Any, name: str) -> str:
        if value not in allowed:
            raise InputError(f"{name} = {value!r}: expected one of {', '.join(allowed)}{suggestion(value, allowed)}")
        return value

    return read, " | ".join(allowed)


def flag() -> Reader:
    """True or false."""

    def read(value: Any, name: str) -> bool:
        if not isinstance(value, bool):
            raise InputError(f"{name} = {value!r}: expected true or false")
        return value

    return read, "true | false"


def text() -> Reader:
    """Free text."""

    def read(value: Any, name: str) -> str:
        if not isinstance(value, str):
            raise InputError(f"{name} = {value!r}: expected text")
        return value

    return read, "text"


def pair(reader: Reader, *, broadcast: bool = False, names: str = "[y, x]") -> Reader:
    """Two values, along y and x unless named otherwise; with ``broadcast`` one value stands for both."""
    read_one, kind = reader

    def read(value: Any, name: str) -> tuple[Any, Any]:
        if isinstance(value, str) and "," in value:
            value = listed(value)
        if broadcast and not isinstance(value, list):
            value = [value, value]
        if not isinstance(value, list) or len(value) != 2:
            raise InputError(f"{name} = {value!r}: expected two values, {names}")
        return read_one(value[0], f"{name}[0]"), read_one(value[1], f"{name}[1]")

    return read, f"{kind} or {names}" if broadcast else f"{names} in {kind}"


def sequence(reader: Reader) -> Reader:
    """A list of at least one value."""
    read_one, kind = reader

    def read(value: Any, name: str) -> tuple[Any, ...]:
        if isinstance(value, str):
            value = listed(value)
        if not isinstance(value, list):
            value = [value]
        if not value:
            raise InputError(f"{name} = []: is empty; give at least one value")
        return tuple(read_one(item, f"{name}[{i}]") for i, item in enumerate(value))

    return read, f"list of {kind}"


def listed(text: str) -> list[Any]:
    """The values of a list written as text: bare numbers, "512, 512", or each with its unit, "1 nm, 2 um"."""
    parts = [part.strip() for part in text.split(",")]
    numbers = [_number(part) for part in parts]
    with_unit = any(isinstance(number, str) and number[:1] in set("+-.0123456789") for number in numbers)
    return parts if with_unit else numbers


def _number(text: str) -> Any:
    for kind in (int, float):
        with contextlib.suppress(ValueError):
            return kind(text)
    return text


def keys_of(section: type) -> dict[str, Key]:
    """The keys of a section, in the order of declaration."""
    return {field.name: field.metadata["key"] for field in dataclasses.fields(section)}


def bind(section: type[Section], table: Mapping[str, Any], name: str) -> Section:
    """Build a section from a TOML table.

    Raises
    ------
    InputError
        If a key is unknown, missing, of the wrong kind or out of range.
    """
    known = keys_of(section)
    for given in table:
        if given not in known:
            raise InputError(f"unknown key {name}.{given}{suggestion(given, known)}; known: {', '.join(known)}")
    values = {given: known[given].read(value, f"{name}.{given}") for given, value in table.items()}
    for field in dataclasses.fields(section):  # type: ignore[arg-type]
        if field.name not in values and field.default is dataclasses.MISSING:
            raise InputError(
                f"missing key {name}.{field.name} ({known[field.name].kind}: {known[field.name].description})"
            )
    return section(**values)


def suggestion(given: Any, known: Iterable[str]) -> str:
    """A known name close to the one given, for the end of a message; empty if there is none."""
    close = difflib.get_close_matches(str(given), list(known), n=1)
    return f" (did you mean {close[0]}?)" if close else ""


def shown(value: Any) -> str:
    """A value of a key for a message."""
    if isinstance(value, tuple | list):
        return "[" + ", ".join(shown(item) for item in value) + "]"
    return "not given" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
