"""Links of the documentation lead somewhere, what it says to type exists, and its sources were read."""

import csv
import importlib
import re
from pathlib import Path

import pytest

import contact_study
from contact_study.command_line.verbs.init import example_names
from contact_study.study.schema.dotted_keys import all_keys
from tests.documentation.pages import PAGES, ROOT

_LINK = re.compile(r"\]\(([^)\s]+)\)")
_OPTION = re.compile(r"--([a-z]+\.[a-z_]+)")
DEBTS = re.compile(
    r"from memory[,;)]|named from memory|unchecked[,;).]|(paper|text) itself was not"
    r"|abstract[s]? (was|were|is) read|was read, not|looked up|not confirmed",
    re.IGNORECASE,
)
PACKAGES = ("bem_adhesion", "contact_study", "md_reference", "research", "scripts", "theory")
SOURCES = sorted(file for package in PACKAGES for file in (ROOT / package).rglob("*.py"))


def anchors(page):
    """Anchors of a page's headings, as GitHub and MyST make them."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return {slug(heading) for heading in re.findall(r"^#{1,6} (.+)$", text, flags=re.MULTILINE)}


def slug(heading):
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def faults(page):
    """Links of a page that lead nowhere."""
    for link in _LINK.findall(page.read_text(encoding="utf-8")):
        if "://" in link or link.startswith("mailto:"):
            continue
        name, _, anchor = link.partition("#")
        target = page if not name else page.parent / name
        if not target.exists() or (anchor and target.suffix == ".md" and anchor not in anchors(target)):
            yield link


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_local_links_lead_somewhere(page):
    assert not list(faults(page))


def test_a_link_that_leads_nowhere_is_found(tmp_path):
    (tmp_path / "other.md").write_text("# One heading: here\n\n```\n# no heading\n```\n")
    page = tmp_path / "page.md"
    page.write_text(
        "# Mine\n[a](other.md) [b](other.md#one-heading-here) [c](#mine) [d](https://example.org/none)\n"
        "[e](none.md) [f](other.md#no-heading) [g](#not-mine)\n"
    )
    assert list(faults(page)) == ["none.md", "other.md#no-heading", "#not-mine"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_keys_and_examples_that_are_to_be_typed_exist(page):
    text = page.read_text(encoding="utf-8")
    keys = {f"{section}.{name}" for section, name, *_ in all_keys()} | {"section.key"}
    assert set(_OPTION.findall(text)) <= keys
    assert set(re.findall(r"--example ([a-z]\w*)(?=`| >|$)", text, re.MULTILINE)) <= {*example_names()}


@pytest.mark.parametrize("files", [PAGES, SOURCES], ids=["pages", "docstrings"])
def test_no_source_is_cited_unread(files):
    found = {
        str(file.relative_to(ROOT)): match.group()
        for file in files
        if (match := DEBTS.search(" ".join(file.read_text(encoding="utf-8").split())))
    }
    assert not found


def test_the_citation_is_of_this_version():
    said = re.search(r"^version: (.+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert said[1] == contact_study.__version__


def test_every_page_of_the_site_is_in_its_contents():
    listed = re.findall(r"^([a-z_0-9]+)$", (ROOT / "docs" / "index.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert {page.stem for page in (ROOT / "docs").glob("*.md")} == {*listed, "index"}


def section_of(page, anchor):
    """The text below a heading, down to the next one of its rank or above."""
    lines, rank, found = page.read_text(encoding="utf-8").splitlines(), 0, []
    for line in lines:
        heading = re.match(r"(#{1,6}) (.+)$", line)
        if heading and rank and len(heading[1]) <= rank:
            break
        if heading and slug(heading[2]) == anchor:
            rank = len(heading[1])
        if rank:
            found.append(line)
    return "\n".join(found)


def test_questions_of_users_have_answers():
    """Each has a page and a heading, whose text holds the words that one would look for."""
    with (Path(__file__).parent / "questions.csv").open(encoding="utf-8", newline="") as stream:
        questions = list(csv.DictReader(stream))
    assert len(questions) >= 60
    for one in questions:
        section = section_of(ROOT / "docs" / f"{one['page']}.md", one["anchor"])
        assert one["words"].lower() in section.lower(), one


def test_every_public_name_has_a_page_of_its_own():
    listed = set(re.findall(r"^   ([a-z_]+(?:\.\w+)+)$", (ROOT / "docs" / "api.md").read_text(), re.MULTILINE))
    packages = ("contact_study", "contact_study.plots", "bem_adhesion", "md_reference", "theory")
    public = {f"{name}.{one}" for name in packages for one in importlib.import_module(name).__all__}
    # The theories hand out laws and solids of bem_adhesion, which have their pages there.
    shared = {f"theory.{one}" for one in importlib.import_module("bem_adhesion").__all__}
    assert listed == {name for name in public - shared if not name.endswith("__version__")}
