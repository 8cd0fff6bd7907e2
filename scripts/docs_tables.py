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
import importlib
import itertools
import multiprocessing
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from scripts.harness import ROOT, Option, program

_BLOCK = re.compile(
    r"<!-- (?P<checked>checked )?table(?: within (?P<margin>[\d.]+) %)?: (?P<command>[^\n]*?) -->\n"
    r"(?P<content>.*?)<!-- end -->",
    re.DOTALL,
)
_MARKER = re.compile(r"<!-- (?:end|.*\btable\b).*?-->")
_COMMON = ("contact_study.plots", "netCDF4")  # imports that most scripts leave for later
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
    done = subprocess.run([program, *words[1:]], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise subprocess.CalledProcessError(done.returncode, command)
    return done.stdout


def outputs_of(commands: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Commands with what they print, as many at a time as there are cores; scripts find their imports done."""
    modules = {words[2] for words in map(shlex.split, commands) if words[1] == "-m"}
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([*sorted(modules), *(_COMMON if modules else ())])
    with ProcessPoolExecutor(os.cpu_count(), context, max_tasks_per_child=1) as pool:
        yield from zip(commands, pool.map(_output_in_this_process, commands), strict=True)


def _output_in_this_process(command: str) -> str:
    _, option, *words = shlex.split(command)
    if option != "-m":
        return output_of(command)
    os.chdir(ROOT)
    with tempfile.TemporaryFile("w+") as printed:
        os.dup2(printed.fileno(), sys.stdout.fileno())
        sys.argv = words
        if status := importlib.import_module(words[0]).main():
            raise subprocess.CalledProcessError(status, command)
        sys.stdout.flush()
        printed.seek(0)
        return printed.read()


def run(given: argparse.Namespace) -> int:
    found = [(path, block) for path in documents() for block in blocks(path.read_text(encoding="utf-8"))]
    chosen = [
        (path, block) for path, block in found if given.only in block.command and (block.checked or not given.check)
    ]
    commands = list(dict.fromkeys(block.command for _, block in chosen))
    # Some of those that are not checked measure times: one after the other, each in a process of its own.
    printed = outputs_of(commands) if given.check else ((command, output_of(command)) for command in commands)
    wrong = 0
    try:
        for command, content in printed:
            for path, block in chosen:
                if block.command != command:
                    continue
                print(f"{path.name}: {command}", file=sys.stderr, flush=True)
                if given.check:
                    differing = list(differences(block.content, shown(command, content), block.margin))
                    print(*differing, sep="\n", end="\n" if differing else "")
                    wrong += bool(differing)
                else:
                    path.write_text(filled(path.read_text(encoding="utf-8"), command, content), encoding="utf-8")
    except subprocess.CalledProcessError as error:
        print(f"{error.cmd}: ended with status {error.returncode}", file=sys.stderr)
        return 1
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
