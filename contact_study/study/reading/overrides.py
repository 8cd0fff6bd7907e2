"""Keys given beside a study file, on the command line, in place of the file's."""

from collections.abc import Mapping
from typing import Any

from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, is_sweep, split
from contact_study.study.schema.keys import TaggedUnion, keys_of, listed


def replace_keys(table: dict[str, Any], overrides: Mapping[str, Any]) -> None:
    """Put keys, by their dotted names, in place of those of a study's table; raise InputError for unknown ones.

    A swept key takes a value or a list; a list for a key that takes one value sweeps it. The table loses its exceptions
    for these keys, and keys of other kinds than one chosen here.
    """
    for dotted, value in overrides.items():
        _leave_kind(table, dotted, value)
    for dotted, value in overrides.items():
        _replace(table, dotted, value)


def _leave_kind(table: dict[str, Any], dotted: str, value: Any) -> None:
    """Drop what a file says of other kinds than the one that the command line chooses."""
    section, _, name = dotted.partition(".")
    kinds = SECTIONS.get(section)
    if not isinstance(kinds, TaggedUnion) or name != kinds.tag or dotted in table.get("sweep", {}):
        return
    chosen = {name: value}
    for content, prefix in ((table.get(section, {}), ""), *((part, f"{section}.") for part in _sweeping(table))):
        for key in [key for key in content if key.startswith(prefix)]:
            if key.removeprefix(prefix) in keys_of(kinds) and not kinds.has(chosen, key.removeprefix(prefix)):
                del content[key]


def _sweeping(table: dict[str, Any]) -> list[dict[str, Any]]:
    """The parts of a table that hold dotted keys."""
    return [table.get("sweep", {}), *table.get("override", [])]


def _replace(table: dict[str, Any], dotted: str, value: Any) -> None:
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
