"""List the keys of a study file."""

import argparse
import dataclasses
from typing import Any

from contact_study.campaign.model import WORDS
from contact_study.command_line.frame import epilog, print_table, say
from contact_study.inputs.errors import DONE, InputError

USAGE = "[SECTION] [--kind KIND]"
END = epilog("bem-adhesion keys", "bem-adhesion keys surface --kind file", "bem-adhesion keys interaction.length")
_LONG = 24  # characters of the words that a key takes, beyond which they follow its meaning


def add(parser: argparse.ArgumentParser) -> None:
    section = parser.add_argument("section", nargs="?", metavar="SECTION", help="section, or one section.key")
    section.completer = lambda **_: list(_sections())  # type: ignore[attr-defined]
    parser.add_argument("--kind", metavar="KIND", help="only keys that this kind, or law, reads")


def run(given: argparse.Namespace) -> int:
    from contact_study.inputs import plugins
    from contact_study.study.schema.dotted_keys import all_keys
    from contact_study.study.schema.keys import TaggedUnion, as_written, default_of, keys_of, suggestion

    plugins.load()
    sections = _sections()
    if given.section is None:
        if given.kind is not None:
            raise InputError(f"--kind {given.kind}: of which section? bem-adhesion keys surface --kind {given.kind}")
        rows = [(name, str(len(keys_of(one))), _readers(name), _summary(one)) for name, one in sections.items()]
        print_table(("section", "keys", "read by", "meaning"), rows)
        return DONE
    name, _, only = given.section.partition(".")
    declared = sections.get(name)
    if declared is None or (only and only not in keys_of(declared)):
        known = [*sections, *(f"{section}.{key}" for section, key, *_ in all_keys())]
        # A key of several sections, without its own, is most likely that of the first.
        known = [one for one in known if one.partition(".")[2] == given.section][:1] or known
        raise InputError(f"unknown section {given.section}{suggestion(given.section, known)}; see bem-adhesion keys")
    title, tagged, inherited = f"[{name}]", {}, getattr(declared, "inherited", ())
    if isinstance(declared, TaggedUnion) and given.kind is not None:
        if given.kind not in declared.declared:
            kinds = ", ".join(declared.declared)
            raise InputError(f"--kind {given.kind}: {name} has {kinds}{suggestion(given.kind, declared.declared)}")
        tag, declared = declared.tag, declared.declared[given.kind]
        title, tagged = f'{title} with {tag} = "{given.kind}"', {tag: given.kind}
    elif given.kind is not None:
        raise InputError(f"--kind {given.kind}: section {name} has no kinds")
    say(f"{title}: {_summary(declared)}. Read by: {_readers(name)}.", "bold")
    listed = []
    for key, one in [(key, one) for key, one in keys_of(declared).items() if only in ("", key)]:
        default, kind, meaning = tagged.get(key, default_of(declared, key)), one.kind, one.description
        if key in inherited:
            default = f"surface.{key}"
        words = "required" if default is dataclasses.MISSING else "none" if default is None else as_written(default)
        if " | " in kind and len(kind) > _LONG:
            kind, meaning = "word", f"{meaning}: {kind.replace(' | ', ', ')}"
        listed.append((f"{name}.{key}", kind, words, meaning))
    print_table(("key", "value", "default", "meaning"), listed)
    if isinstance(declared, TaggedUnion) and not only:
        say(f"--kind shows the keys of one alone: {', '.join(declared.declared)}.")
    return DONE


def _sections() -> dict[str, Any]:
    from contact_study.study.schema.dotted_keys import SECTIONS

    return SECTIONS


def _readers(section: str) -> str:
    from contact_study.campaign import model as models

    readers = [words for words, kind in WORDS.items() if section not in models.MODELS[kind].ignores]
    return "all models" if len(readers) == len(WORDS) else ", ".join(readers)


def _summary(declared: Any) -> str:
    """Return the first line of a section's docstring; of several kinds their common one."""
    from contact_study.study.schema.keys import TaggedUnion

    if isinstance(declared, TaggedUnion):
        common = next(iter(declared.declared.values())).__mro__
        declared = next(one for one in reversed(common) if one.__name__.endswith("Section"))
    return str(declared.__doc__).partition("\n")[0].partition(";")[0].rstrip(".")
