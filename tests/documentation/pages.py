"""The documentation's pages, and the blocks in them that a reader is to type."""

import argparse
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from contact_study import start

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
COMMANDS = {
    "bem-adhesion": start.bem_adhesion,
    "md-reference": start.md_reference,
    "persson-theory": start.persson_theory,
    "contact-compare": start.contact_compare,
    "contact-merge": start.contact_merge,
}
SHELL = ("", "bash")
# A table of results: its command is run by scripts/docs_tables.py, see test_tables.py.
_TABLE = re.compile(r"<!-- (?:checked )?table.*?<!-- end -->", re.DOTALL)
_BLOCK = re.compile(
    r"^(?:<!-- not run: (?P<reason>.+) -->\n)?```(?P<language>.*)\n(?P<text>(?:.*\n)*?)```$", re.MULTILINE
)


@dataclass(frozen=True)
class Block:
    """A fenced block of a page; ``reason`` says why no test can run it."""

    language: str
    text: str
    reason: str | None

    @property
    def lines(self) -> list[str]:
        """Its commands, without comments."""
        return [line for line in self.text.splitlines() if line.strip() and not line.startswith("#")]


def blocks_of(text: str) -> list[Block]:
    """The blocks of a page in their order, without tables of results."""
    return [Block(one["language"], one["text"], one["reason"]) for one in _BLOCK.finditer(_TABLE.sub("", text))]


def blocks(page: Path) -> list[Block]:
    """The blocks of a page's file."""
    return blocks_of(page.read_text(encoding="utf-8"))


class Parsed(BaseException):
    """The arguments were taken, but for these."""


def parsed(monkeypatch, main: Callable[..., int], *arguments: list[str]) -> list[str]:
    """Let a command read its arguments, and no more; returns those that it does not know."""
    take = argparse.ArgumentParser.parse_known_args

    def take_only(*given, **options):
        raise Parsed(take(*given, **options)[1])

    monkeypatch.setattr(argparse.ArgumentParser, "parse_known_args", take_only)
    with pytest.raises(Parsed) as found:
        main(*arguments)
    return found.value.args[0]
