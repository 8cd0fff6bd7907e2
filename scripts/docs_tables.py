"""Tables of the documentation, written by the scripts that compute them.

A table stands in a block whose first line names the command that prints it:

    <!-- table: python -m research.two_starts data/yang2008.toml -->
    <!-- end -->

Without options every command is run and its output replaces the block. With ``--check`` only the commands of blocks
that begin with ``checked table`` are run, and what they print is compared with what stands there: words must be equal,
numbers to one unit of their last digit, counts exactly or to the margin that the block states (``checked table within
5 %``): some depend on how the transforms round.

    python -m scripts.docs_tables                       # all, an hour
    python -m scripts.docs_tables --check               # the cheap ones, a minute
    python -m scripts.docs_tables --only adhesive       # those whose command has the word
"""

import argparse
import itertools
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from scripts.harness import ROOT, Option, program

_BLOCK = re.compile(
    r"<!-- (?P<checked>checked )?table(?: within (?P<margin>[\d.]+) %)?: (?P<command>[^\n]*?) -->\n"
    r"(?P<content>.*?)<!-- end -->",
    re.DOTALL,
)
_MARKER = re.compile(r"<!-- (?:end|.*\btable\b).*?-->")
_NUMBER = re.compile(r"[-+−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?: %)?")


@dataclass(frozen=True)
class Block:
    """One table of a document: its command, its content, whether the check runs it, the relative margin of counts."""

    command: str
    content: str
    checked: bool = False
    margin: float = 0.0


def documents(root: Path = ROOT) -> list[Path]:
    """Every document that may hold tables."""
    folders = (root / "docs", root / "research" / "notes")
    return [root / "README.md", *(page for folder in folders for page in sorted(folder.glob("*.md")))]


def blocks(text: str) -> list[Block]:
    """The blocks of a document; ``ValueError`` if one is not closed or its first line is not as it should be."""
    found = [
        Block(each["command"], each["content"], bool(each["checked"]), float(each["margin"] or 0) / 100)
        for each in _BLOCK.finditer(text)
    ]
    left = _MARKER.search(_BLOCK.sub("", text))
    if left:
        raise ValueError(f"{left[0]}: is no complete block; expected <!-- table: command --> … <!-- end -->")
    return found


def filled(text: str, command: str, printed: str) -> str:
    """The document with new content in the blocks of one command."""

    def content(each: re.Match[str]) -> str:
        if each["command"] != command:
            return each[0]
        first_line = each[0].partition("\n")[0]
        return f"{first_line}\n{shown(command, printed)}<!-- end -->"

    return _BLOCK.sub(content, text)


def shown(command: str, printed: str) -> str:
    """What stands in a block: the command, and what it printed."""
    return f"\n```\n{command}\n```\n\n{printed.strip()}\n\n"


def differences(stands: str, printed: str, margin: float = 0.0) -> Iterator[str]:
    """What differs between two texts, line by line; numbers to a unit of their last digit, counts to the margin."""
    for number, (old, new) in enumerate(itertools.zip_longest(stands.splitlines(), printed.splitlines()), 1):
        if old is None or new is None or not _same(old, new, margin):
            yield f"line {number}:\n- {'' if old is None else old}\n+ {'' if new is None else new}"


def _same(old: str, new: str, margin: float) -> bool:
    if _NUMBER.sub("#", old) != _NUMBER.sub("#", new):
        return False
    pairs = zip(_NUMBER.findall(old), _NUMBER.findall(new), strict=True)
    return all(abs(_value(one) - _value(other)) <= _allowed(one, margin) for one, other in pairs)


def _value(number: str) -> float:
    return float(number.replace("−", "-").removesuffix(" %"))


def _allowed(number: str, margin: float) -> float:
    """How far another may be: one unit of the last digit, or the margin for a whole number that is no percentage."""
    mantissa, _, exponent = number.removesuffix(" %").partition("e")
    decimals = len(mantissa.partition(".")[2])
    if not decimals and not number.endswith("%"):
        return margin * abs(_value(number))
    return 1.0001 * 10.0 ** (int(exponent or 0) - decimals)


def output_of(command: str) -> str:
    """What a command prints; ``python`` is this interpreter."""
    words = shlex.split(command)
    program = sys.executable if words[0] == "python" else words[0]
    return subprocess.run([program, *words[1:]], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout


def run(given: argparse.Namespace) -> int:
    wrong = 0
    for path in documents():
        for block in blocks(path.read_text(encoding="utf-8")):
            if given.only not in block.command or (given.check and not block.checked):
                continue
            print(f"{path.name}: {block.command}", file=sys.stderr, flush=True)
            try:
                printed = output_of(block.command)
            except subprocess.CalledProcessError as error:
                print(f"{path.name}: {block.command}: ended with status {error.returncode}", file=sys.stderr)
                return 1
            if given.check:
                found = list(differences(block.content, shown(block.command, printed), block.margin))
                print(*found, sep="\n", end="\n" if found else "")
                wrong += bool(found)
            else:
                path.write_text(filled(path.read_text(encoding="utf-8"), block.command, printed), encoding="utf-8")
    if wrong:
        print(f"{wrong} tables differ from what their commands print; rewrite them with make docs-tables")
    return 1 if wrong else 0


main = program(
    run,
    Option("--check", False, "compare the cheap ones, write nothing"),
    Option("--only", "", "commands that hold this word", metavar="WORD"),
)

if __name__ == "__main__":
    sys.exit(main())
