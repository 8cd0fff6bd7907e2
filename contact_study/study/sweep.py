"""The points of a study's sweep, and the exceptions, ``[[override]]``, that single points make."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from contact_study.inputs.errors import InputError
from contact_study.study.case import Case
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, read, same, split
from contact_study.study.schema.interaction import AUTO, LENGTH
from contact_study.study.schema.keys import TaggedUnion, default_of, keys_of
from contact_study.study.uncertainty import DRAW, SECTION, uncertainty_of


@dataclass(frozen=True)
class SweptKey:
    """A key that a study varies: its values in SI, their unit (UDUNITS) and meaning."""

    values: tuple[Any, ...]
    units: str
    description: str


def check(table: dict[str, Any]) -> None:
    """Raise InputError unless the sweep and the exceptions of a study's table can be made."""
    swept: dict[str, Any] = table.get("sweep", {})
    for dotted, values in swept.items():
        section, name = split(dotted, "sweep")
        if section in WHOLE_STUDY:
            raise InputError(f"sweep.{dotted}: section [{section}] is one for the whole study and cannot be swept")
        if dotted == "loading.path":
            raise InputError(
                "sweep.loading.path: a path cannot be swept; give points of a sweep their own by [[override]]"
            )
        if not isinstance(values, list) or not values:
            raise InputError(f"sweep.{dotted} = {values!r}: expected a list of at least one value")
        if dotted == LENGTH and AUTO in values:
            raise InputError(f'sweep.{dotted}: "{AUTO}" is no number to sweep over; give it in [[override]]')
        if any(isinstance(value, list | dict) for value in values):
            raise InputError(f"sweep.{dotted}: each value must be a number or a text")
        if sum(other.rpartition(".")[2] == name for other in swept) > 1:
            raise InputError(f"sweep: two swept keys are called {name}")
        if name in table.get(section, {}):  # a value that the sweep replaces is written there to be read, too
            read(dotted, table[section][name])
    exceptions = table.get("override", [])
    if not isinstance(exceptions, list) or not all(isinstance(item, dict) for item in exceptions):
        raise InputError('override: expected tables, [[override]] with when = { "section.key" = value }')
    for item in exceptions:
        if not isinstance(item.get("when"), dict) or not item["when"]:
            raise InputError('override: needs when = { "section.key" = value }')
        for dotted, value in [*item["when"].items(), *item.items()]:
            if dotted != "when":
                split(dotted, "override")
                read(dotted, value, "override: ")
        for dotted in item:
            if dotted in swept:
                raise InputError(f"override: {dotted} is swept; an override may change other keys only")
            if dotted.partition(".")[0] in WHOLE_STUDY:
                raise InputError(f"override: {dotted} is one for the whole study and cannot differ between points")


def sections_at(
    table: dict[str, Any], points: Sequence[dict[str, Any]]
) -> tuple[list[dict[str, Any]], tuple[str, ...]]:
    """The sections at each point, with swept values and exceptions, and in words the exceptions that no point makes."""
    merged, exceptions, made = [], table.get("override", []), {0}
    draws = [point.get(DRAW, table.get(SECTION, {}).get("draw", 0)) for point in points]
    uncertain = uncertainty_of(table)
    drawn = [{}] * len(points) if uncertain is None else uncertain.values(draws)
    for point, values in zip(points, drawn, strict=True):
        one: dict[str, Any] = {name: dict(table.get(name, {})) for name in SECTIONS}
        one[SECTION] = {name: one[SECTION][name] for name in ("seed", "draw") if name in one[SECTION]}
        for number, item in enumerate([{"when": {}, **point, **values}, *exceptions]):
            if _matches(one, item["when"]):
                made.add(number)
                for dotted in [name for name in item if name != "when"]:
                    section, _, name = dotted.partition(".")
                    one[section][name] = item[dotted]
        merged.append(one)
    for section, kinds in SECTIONS.items():
        if isinstance(kinds, TaggedUnion):
            present = [kind for one in merged if (kind := kinds.section_of(one[section])) is not None]
            used = {name for kind in set(present) for name in keys_of(kind)}
            for one in merged:  # keys of other points' kinds go; what no kind of them has stays, to be refused
                other = [name for name in one[section] if name in used and not kinds.has(one[section], name)]
                one[section] = {name: value for name, value in one[section].items() if name not in other}
    return merged, tuple(
        f"override {number} ({', '.join(f'{k} = {v!r}' for k, v in item['when'].items())}) matches no point"
        for number, item in enumerate(exceptions, 1)
        if number not in made
    )


def _matches(merged: dict[str, Any], when: dict[str, Any]) -> bool:
    """Test whether a point has these values, however they are written: 8, 8.0; "1 nm", "10 angstrom"."""
    for dotted, wanted in when.items():
        section, name = split(dotted, "override")
        given = merged[section]
        value = read(dotted, given[name]) if name in given else default_of(SECTIONS[section], name)
        if not same(value, read(dotted, wanted)):
            return False
    return True


def points(cases: Sequence[Case], study_size: int) -> str:
    """Which part of the sweep is meant, in brackets; nothing for all of it."""
    if len(cases) == study_size:
        return ""
    return f" ({len(cases)} of {study_size} points of the sweep, such as {cases[0].label})"


def swept_key(dotted: str, written: Sequence[Any], cases: Sequence[Case]) -> SweptKey:
    """A key that the cases vary over the values written in the file; InputError if two of the values are one."""
    section, name = split(dotted, "sweep")
    declaration = keys_of(SECTIONS[section])[name]
    values = tuple(dict.fromkeys(case.coordinates[name] for case in cases))
    numbers = sorted(value for value in values if isinstance(value, int | float))
    if len(values) < len(written) or any(same(*pair) for pair in itertools.pairwise(numbers)):
        raise InputError(f"sweep.{dotted} = {written!r}: holds a value twice")
    unit = declaration.unit
    if section == "loading" and numbers:
        unit = cases[0].loading.unit_of_key(name) or unit
    return SweptKey(values, _as_in_datasets(unit or "1"), declaration.description)


def _as_in_datasets(unit: str) -> str:
    """Spell a key's unit as the conventions do: J/m^2 is J m-2."""
    above, _, below = unit.partition("/")
    name, _, power = below.partition("^")
    return f"{above} {name}-{power or 1}" if below else unit


def coordinates_of(point: dict[str, Any]) -> dict[str, Any]:
    """Value of each swept key at a point, in SI, by the key's name; one number for a key of both axes."""
    found = {}
    for dotted, written in point.items():
        value = read(dotted, written)
        if isinstance(value, tuple):
            if len(value) != 2:
                raise InputError(
                    f"sweep.{dotted}: a list cannot be swept; give points of a sweep their own by [[override]]"
                )
            if value[0] != value[1]:
                raise InputError(f"sweep.{dotted}: holds {list(value)}; a swept pair must have two equal values")
            value = value[0]
        found[dotted.rpartition(".")[2]] = value
    return found
