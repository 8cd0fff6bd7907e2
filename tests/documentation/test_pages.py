"""What the documentation says to type is what the commands take, its links lead somewhere, its sources were read."""

import argparse
import csv
import importlib
import re
import shlex
import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest

import contact_study
from contact_study import start
from contact_study.study.examples import example_names
from contact_study.study.schema.dotted_keys import all_keys, read, split
from contact_study.study.schema.keys import bind
from contact_study.study.schema.measurement import MeasurementSection

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
_BLOCK = re.compile(r"^(?:<!-- not run: (.+) -->\n)?```(.*)\n((?:.*\n)*?)```$", re.MULTILINE)
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
TARGETS = re.search(r"^\.PHONY: (.*)$", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)[1].split()
DEBTS = re.compile(
    r"from memory[,;)]|named from memory|unchecked[,;).]|(paper|text) itself was not"
    r"|abstract[s]? (was|were|is) read|was read, not|looked up|not confirmed",
    re.IGNORECASE,
)
PACKAGES = ("bem_adhesion", "contact_study", "md_reference", "research", "scripts", "theory")
SOURCES = sorted(file for package in PACKAGES for file in (ROOT / package).rglob("*.py"))


class Block(NamedTuple):
    """A fenced block of a page; ``reason`` says why no test can run it."""

    reason: str
    language: str
    text: str


def blocks(page):
    """The blocks of a page in their order, without tables of results."""
    return [Block(*found) for found in _BLOCK.findall(_TABLE.sub("", page.read_text(encoding="utf-8")))]


class Parsed(BaseException):
    """The arguments were taken, but for these."""


def parsed(monkeypatch, main, *arguments):
    """Let a command read its arguments, and no more; returns those that it does not know."""
    take = argparse.ArgumentParser.parse_known_args

    def take_only(*given, **options):
        raise Parsed(take(*given, **options)[1])

    monkeypatch.setattr(argparse.ArgumentParser, "parse_known_args", take_only)
    with pytest.raises(Parsed) as found:
        main(*arguments)
    return found.value.args[0]


def slug(heading):
    """The anchor of a heading, as GitHub and MyST make it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def leads_somewhere(page, link):
    name, _, anchor = link.partition("#")
    target = page.parent / name if name else page
    if "://" in link or link.startswith("mailto:") or not (anchor and target.suffix == ".md"):
        return "://" in link or link.startswith("mailto:") or target.exists()
    text = re.sub(r"```.*?```", "", target.read_text(encoding="utf-8"), flags=re.DOTALL)
    return anchor in map(slug, re.findall(r"^#{1,6} (.+)$", text, flags=re.MULTILINE))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_keys_and_examples_exist(page):
    text = page.read_text(encoding="utf-8")
    assert [link for link in re.findall(r"\]\(([^)\s]+)\)", text) if not leads_somewhere(page, link)] == []
    keys = {f"{section}.{name}" for section, name, *_ in all_keys()} | {"section.key"}
    assert set(re.findall(r"--([a-z]+\.[a-z_]+)", text)) <= keys
    assert set(re.findall(r"--example ([a-z]\w*)(?=`| >|$)", text, re.MULTILINE)) <= {*example_names()}


@pytest.mark.parametrize("files", [PAGES, SOURCES], ids=["pages", "docstrings"])
def test_no_source_is_cited_unread(files):
    found = {
        str(file.relative_to(ROOT)): match.group()
        for file in files
        if (match := DEBTS.search(" ".join(file.read_text(encoding="utf-8").split())))
    }
    assert not found


def section_of(page, anchor):
    """The text below a heading, down to the next one of its rank or above."""
    parts = re.split(r"^(#{1,6}) (.+)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    places = [k for k in range(1, len(parts), 3) if slug(parts[k + 1]) == anchor]
    first = places[0] if places else len(parts)
    last = next((k for k in range(first + 3, len(parts), 3) if len(parts[k]) <= len(parts[first])), len(parts))
    return "".join(parts[first:last])


def test_questions_of_users_have_answers():
    """Each has a page and a heading, whose text holds the words that one would look for."""
    with (Path(__file__).parent / "questions.csv").open(encoding="utf-8", newline="") as stream:
        questions = list(csv.DictReader(stream))
    assert len(questions) >= 60
    for one in questions:
        section = section_of(ROOT / "docs" / f"{one['page']}.md", one["anchor"])
        assert one["words"].lower() in section.lower(), one


def test_the_site_has_every_page_and_public_name_and_the_citation_is_of_this_version():
    def listed(file, line):
        return set(re.findall(line, (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE))

    pages = {page.stem for page in (ROOT / "docs").glob("*.md")}
    assert pages - {"index"} == listed("docs/index.md", r"^([a-z_0-9]+)$")
    assert listed("CITATION.cff", r"^version: (.+)$") == {contact_study.__version__}
    packages = ("contact_study", "contact_study.plots", "bem_adhesion", "md_reference", "theory")
    public = {f"{name}.{one}" for name in packages for one in importlib.import_module(name).__all__}
    # The theories hand out laws and solids of bem_adhesion, which have their pages there.
    shared = {f"theory.{one}" for one in importlib.import_module("bem_adhesion").__all__}
    named = {name for name in public - shared if not name.endswith("__version__")}
    assert listed("docs/api.md", r"^   ([a-z_]+(?:\.\w+)+)$") == named


def commands():
    """Every command for a shell, in words."""
    for page in PAGES:
        for line in "\n".join(block.text for block in blocks(page) if block.language in SHELL).splitlines():
            words = shlex.split(line, comments=True)
            while words:
                end = words.index("&&") if "&&" in words else len(words)
                yield pytest.param(words[:end], id=f"{page.stem}: {' '.join(words[:end])}")
                words = words[end + 1 :]


@pytest.mark.parametrize("words", list(commands()))
def test_a_command_of_the_documentation_is_one(words, monkeypatch):
    command, *arguments = words
    command = command.removeprefix(".venv/bin/")
    if command in COMMANDS:
        if ">" in arguments:
            arguments = arguments[: arguments.index(">")]
        assert parsed(monkeypatch, COMMANDS[command], arguments) == []
    elif command == "make":
        assert arguments[0] in TARGETS
    elif command == "pip":
        extra = re.fullmatch(r"\.(?:\[(\w+)\])?", arguments[1])[1]
        assert extra is None or extra in PROJECT["optional-dependencies"]
    elif command == "eval":  # shells complete every program
        assert set(PROJECT["scripts"]) == set(arguments[0].strip("$()").split()[1:])
    else:
        assert command == "dask"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_code_of_the_documentation_can_be_read(page):
    for block in blocks(page):
        assert block.language in (*SHELL, "python", "toml") or block.language.startswith("{")
        if block.language == "python":
            compile(block.text, page.name, "exec")
    for table in [tomllib.loads(block.text) for block in blocks(page) if block.language == "toml"]:
        given = [(dotted, value) for dotted, values in table.pop("sweep", {}).items() for value in values]
        for item in table.pop("override", []):
            given += (item.pop("when") | item).items()
        uncertain = table.get("uncertainty", {})
        for dotted in [name for name in uncertain if "." in name]:
            distribution = uncertain.pop(dotted)
            given += [(dotted, value) for value in distribution.get("values", [])]
            split(dotted, page.name)
        for measurement in table.pop("measurement", []):
            bind(MeasurementSection, measurement, "measurement")
        given += [(f"{section}.{name}", value) for section, own in table.items() for name, value in own.items()]
        for dotted, value in given:
            read(dotted, value)
