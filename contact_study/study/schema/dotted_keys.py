"""The sections that a study file may have, and their keys by dotted names, such as ``interaction.length``."""

import math
import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

from contact_study.inputs.errors import InputError
from contact_study.study.schema import sections
from contact_study.study.schema.adhesion_map import ADHESION_MAPS
from contact_study.study.schema.bodies import ADDED, ADDED_SECTIONS
from contact_study.study.schema.elasticity import ELASTICITIES
from contact_study.study.schema.form import FORMS
from contact_study.study.schema.interaction import INTERACTIONS
from contact_study.study.schema.keys import Key, TaggedUnion, default_of, keys_of, listed, replacement
from contact_study.study.schema.loading import LoadingSection
from contact_study.study.schema.surface import SURFACES

SECTIONS: dict[str, type | TaggedUnion] = {
    "study": sections.StudySection,
    "surface": SURFACES,
    "form": FORMS,
    **dict.fromkeys(ADDED_SECTIONS, ADDED),
    "material": sections.MaterialSection,
    "elasticity": ELASTICITIES,
    "interaction": INTERACTIONS,
    "adhesion_map": ADHESION_MAPS,
    "loading": LoadingSection,
    "solver": sections.SolverSection,
    "atomistic": sections.AtomisticSection,
    "overdamped": sections.OverdampedSection,
    "sampling": sections.SamplingSection,
    "dynamics": sections.DynamicsSection,
    "theory": sections.TheorySection,
    "uncertainty": sections.UncertaintySection,
    "output": sections.OutputSection,
}
WHOLE_STUDY = ("study", "output")  # sections that every point of a sweep shares

_SHOWN = 3  # keys that a message shows


def all_keys() -> Iterator[tuple[str, str, Key, Any]]:
    """Section, key, declaration and default of everything a study file may hold."""
    for section, declared in SECTIONS.items():
        for name, declaration in keys_of(declared).items():
            yield section, name, declaration, default_of(declared, name)


def split(dotted: str, where: str) -> tuple[str, str]:
    """Section and name of a dotted key; InputError if there is no such key in what ``where`` names."""
    section, _, name = dotted.partition(".")
    if section not in SECTIONS or name not in keys_of(SECTIONS[section]):
        meant = replacement(dotted) or "; expected section.key, such as interaction.well_depth_ratio"
        raise InputError(f"{where}: unknown key {dotted!r}{meant}")
    return section, name


def typed(text: str) -> Any:
    """The value of a key from what someone typed: TOML, or else the text itself, such as ``2 GPa``."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except ValueError:
        return text


def read(dotted: str, value: Any, where: str = "") -> Any:
    """The value of a key as its section will hold it."""
    section, name = split(dotted, where)
    return keys_of(SECTIONS[section])[name].read(value, where + dotted)


def is_sweep(dotted: str, value: Any, several: Any) -> bool:
    """Test whether a value is a list of values for a key that takes one."""
    if not isinstance(several, list) or not several or _reads(dotted, value):
        return False
    # A list for a key of lists has its own message.
    return not _reads(dotted, several[:1]) and all(_reads(dotted, one) for one in several)


def _reads(dotted: str, value: Any) -> bool:
    try:
        return read(dotted, value) is not None
    except InputError:
        return False


def same(one: Any, other: Any) -> bool:
    """Compare two values of a key up to the rounding of a unit's conversion."""
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-12)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(same(*pair) for pair in zip(one, other, strict=True))
    return bool(one == other)


def replace_keys(table: dict[str, Any], overrides: Mapping[str, Any]) -> None:
    """Put keys, by their dotted names, in place of those of a study's table; a list may sweep a key of one value.

    The table loses its exceptions for these keys, and keys of other kinds than one chosen here.
    """
    dotted_parts = [table.get("sweep", {}), *table.get("override", [])]
    for dotted, value in overrides.items():
        section, _, name = dotted.partition(".")
        kinds = SECTIONS.get(section)
        if not isinstance(kinds, TaggedUnion) or name != kinds.tag or dotted in table.get("sweep", {}):
            continue
        for content, prefix in ((table.get(section, {}), ""), *((part, f"{section}.") for part in dotted_parts)):
            for key in [key for key in content if key.startswith(prefix)]:
                own = key.removeprefix(prefix)
                if own in keys_of(kinds) and not kinds.has({name: value}, own):
                    del content[key]
    for dotted, value in overrides.items():
        section, name = split(dotted, "command line")
        several = listed(value) if isinstance(value, str) and "," in value else value
        if dotted in table.get("sweep", {}):
            table["sweep"][dotted] = several if isinstance(several, list) else [several]
        elif section not in WHOLE_STUDY and is_sweep(dotted, value, several):
            table.setdefault("sweep", {})[dotted] = several
        else:
            table.setdefault(section, {})[name] = value
        for item in table.get("override", []):  # the command line has the last word
            item.pop(dotted, None)


def written(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield each dotted key of a study's table with its value; of a sweep and of exceptions too, a sweep's list whole.

    The table need not be checked.
    """
    for section in SECTIONS:
        if isinstance(table.get(section), dict):
            yield from ((f"{section}.{name}", value) for name, value in table[section].items())
    for part in (table.get("sweep", {}), *table.get("override", [])):
        if isinstance(part, dict):
            yield from ((dotted, value) for dotted, value in part.items() if dotted != "when")


def bare_numbers(table: Mapping[str, Any], loading: LoadingSection) -> tuple[str, ...]:
    """A line on the keys of a checked study file whose numbers are taken in SI for want of a unit, if there are."""
    found = {}
    for dotted, value in written(table):
        section, _, name = dotted.partition(".")
        if name not in keys_of(SECTIONS[section]):  # a distribution of [uncertainty]
            continue
        unit = loading.unit_of_key(name) if section == "loading" else None
        unit = unit or keys_of(SECTIONS[section])[name].unit
        number = _number(value)
        if unit is not None and number is not None:
            found[dotted] = f"{dotted} = {number!r} is {number!r} {unit}"
    if not found:
        return ()
    more = f", and {len(found) - _SHOWN} keys more" if len(found) > _SHOWN else ""
    shown = ", ".join(list(found.values())[:_SHOWN])
    return (f'numbers without a unit are taken in SI: {shown}{more}; write the unit, as in "2 GPa" or "10 um"',)


def _number(value: Any) -> int | float | None:
    """The first number of a value but for zero, which is the same in every unit."""
    if isinstance(value, list):
        return next((number for item in value if (number := _number(item)) is not None), None)
    return value if isinstance(value, int | float) and not isinstance(value, bool) and value != 0 else None
