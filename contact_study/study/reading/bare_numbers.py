"""Numbers of a study file that have a dimension and no unit: a person who writes 2 seldom means 2 Pa."""

from collections.abc import Iterator, Mapping
from typing import Any

from contact_study.study.schema.dotted_keys import SECTIONS, split
from contact_study.study.schema.keys import keys_of

# Keys that a message shows.
_SHOWN = 3


def bare_numbers(table: Mapping[str, Any]) -> tuple[str, ...]:
    """A line on the keys of a study file, checked, whose numbers are taken in SI for want of a unit, if there are."""
    found = {dotted: f"{dotted} = {number!r} is {number!r} {unit}" for dotted, number, unit in _bare(table)}
    if not found:
        return ()
    more = f", and {len(found) - _SHOWN} keys more" if len(found) > _SHOWN else ""
    shown = ", ".join(list(found.values())[:_SHOWN])
    return (f'numbers without a unit are taken in SI: {shown}{more}; write the unit, as in "2 GPa" or "10 um"',)


def _bare(table: Mapping[str, Any]) -> Iterator[tuple[str, int | float, str]]:
    """Dotted key, first number without a unit, and the SI unit that it is taken in."""
    for dotted, value in _keys(table):
        section, name = split(dotted, "")
        unit = keys_of(SECTIONS[section])[name].unit
        if dotted == "loading.path":
            unit = "Pa" if table["loading"].get("control", "pressure") == "pressure" else "m"
        number = next(_numbers(value), None)
        if unit is not None and number is not None:
            yield dotted, number, unit


def _keys(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for section in SECTIONS:
        for name, value in table.get(section, {}).items():
            yield f"{section}.{name}", value
    for part in (table.get("sweep", {}), *table.get("override", [])):
        yield from ((dotted, value) for dotted, value in part.items() if dotted != "when")


def _numbers(value: Any) -> Iterator[int | float]:
    """The numbers of a value but for zero, which is the same in every unit."""
    if isinstance(value, list):
        for item in value:
            yield from _numbers(item)
    elif isinstance(value, int | float) and not isinstance(value, bool) and value != 0:
        yield value
