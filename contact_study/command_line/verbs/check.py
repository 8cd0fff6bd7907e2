"""Check a study: what it holds, what it needs, what to expect. No solver runs."""

import argparse
import sys
from pathlib import Path

from contact_study.campaign.model import WORDS
from contact_study.command_line.frame import epilog, print_table, say
from contact_study.inputs.errors import DONE, WRONG_INPUT, InputError

KEYS = True
USAGE = "STUDY.toml [--model NAME] [--section.key VALUE ...]"
END = epilog("bem-adhesion check study.toml", "bem-adhesion check study.toml --model atoms --surface.shape 512,512")


def add(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("study", type=Path, metavar="STUDY.toml", help="study file")
    add("--model", choices=WORDS, metavar="NAME", help="continuum, atoms or theory; default: all that can run it")
    add("--section.key", metavar="VALUE", help="any key of the study, as of `bem-adhesion run`")


def run(given: argparse.Namespace) -> int:
    """Check; the exit status is 1 if no model that is asked for can run the study."""
    from contact_study.campaign import expectation
    from contact_study.study.checks import describe_maps
    from contact_study.study.study import read_study

    study = read_study(given.study, given.keys)
    rows, notes = [], dict[str, list[str]]()
    for name in [given.model] if given.model else WORDS:
        try:
            possible, memory, time, remark, found = expectation.judged(WORDS[name], study)
            row = name, possible, memory, time, remark
        except InputError as error:
            if given.model:
                raise
            row, found = (name, "no", "", "", str(error)), []
        rows.append(row)
        for note in found:
            notes.setdefault(note, []).append(name)
    able = [name for name, possible, *_ in rows if possible == "yes"]
    say(f"{given.study}: {study.title}", "bold")
    for line in (*expectation.extent(study), *study.choices, *describe_maps(study.cases)):
        say(line)
    print()
    print_table(("model", "possible", "memory per case", "time on one core", "remark"), rows)
    if numbers := list(expectation.numbers(study.cases)):
        print()
        print_table(("number", "value", "what to expect"), numbers)
    print("", end="\n" if notes else "")
    for note, whose in notes.items():
        who = "" if whose == able else f" ({', '.join(whose)})"
        say(f"warning{who}: {note}", "yellow")
    if not able:
        print(f"{given.command}: no model can run this study", file=sys.stderr)
    return DONE if able else WRONG_INPUT
