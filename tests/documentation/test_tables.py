"""Tables of the documentation: written by commands that run, compared as they should be."""

import importlib
import re
import shlex
import sys
from pathlib import Path

import pytest

from scripts import docs_tables
from scripts.docs_tables import ROOT, blocks, differences, documents, filled, main, shown
from tests.documentation.pages import parsed

TEXT = """before

<!-- table: python -m scripts.one "1 GPa" -->
old
<!-- end -->

between
<!-- checked table within 5 %: python -m scripts.two -->
<!-- end -->
after
"""


def test_blocks_name_their_commands():
    one, two = blocks(TEXT)
    assert (one.command, one.content, one.checked, one.margin) == ('python -m scripts.one "1 GPa"', "old\n", False, 0)
    assert (two.command, two.content, two.checked, two.margin) == ("python -m scripts.two", "", True, 0.05)


def test_only_the_blocks_of_the_command_are_rewritten():
    new = filled(TEXT, "python -m scripts.two", "| a |\n|---|\n| \\1 |\n")
    one, two = blocks(new)
    assert one == blocks(TEXT)[0]
    assert two.content == shown("python -m scripts.two", "| a |\n|---|\n| \\1 |")
    assert "```\npython -m scripts.two\n```" in new
    assert filled(new, "python -m scripts.two", "| a |\n|---|\n| \\1 |\n") == new
    assert new.startswith("before\n\n<!-- table")
    assert new.endswith("<!-- end -->\nafter\n")


@pytest.mark.parametrize("text", ["<!-- table: a -->\n", "<!-- table -->\n<!-- end -->\n", "<!-- end -->\n"])
def test_a_block_must_be_whole(text):
    with pytest.raises(ValueError, match="no complete block"):
        blocks(TEXT + text)


@pytest.mark.parametrize(
    ("old", "new", "margin", "same"),
    [
        ("A = 0.9200", "A = 0.9201", 0, True),
        ("A = 0.9200", "A = 0.9189", 0, False),
        ("A = 0.9200", "A = 0.9189", 0.05, False),
        ("| −0.006 |", "| −0.005 |", 0, True),
        ("| -0.000 |", "| +0.000 |", 0, True),
        ("| −0.006 |", "| 0.006 |", 0, False),
        ("14 %", "15 %", 0, True),
        ("14 %", "16 %", 0, False),
        ("41 steps", "42 steps", 0, False),
        ("41 steps", "42 steps", 0.05, True),
        ("41 steps", "44 steps", 0.05, False),
        ("7.7e-09", "7.8e-09", 0, True),
        ("7.7e-09", "7.7e-08", 0, False),
        ("atoms", "continuum", 0.5, False),
        ("1 2", "1 2 3", 0.5, False),
    ],
)
def test_what_counts_as_the_same(old, new, margin, same):
    assert (list(differences(old, new, margin)) == []) is same


def test_lines_that_are_missing_or_new_are_differences():
    assert len(list(differences("a\nb", "a"))) == 1
    assert len(list(differences("a", "a\nb"))) == 1


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A folder with one document of two tables."""
    page = tmp_path / "README.md"
    page.write_text(
        "<!-- table: python -c \"print('dear 1.0')\" -->\n<!-- end -->\n"
        "<!-- checked table: python -c \"print('cheap 2.0')\" -->\n<!-- end -->\n"
    )
    monkeypatch.setattr(docs_tables, "documents", lambda: [page])
    return page


def test_written_and_checked(project, capsys):
    assert main(["--check"]) == 1
    assert "cheap 2.0" in capsys.readouterr().out
    assert "cheap 2.0\n" not in project.read_text(), "a check writes nothing"
    assert main([]) == 0
    dear, cheap = blocks(project.read_text())
    assert "dear 1.0" in dear.content
    assert "cheap 2.0" in cheap.content
    assert main(["--check"]) == 0
    project.write_text(project.read_text().replace("\ndear 1.0", "\ndear 9.0"))
    assert main(["--check"]) == 0, "the dear one is not run"
    project.write_text(project.read_text().replace("\ncheap 2.0", "\ncheap 2.2"))
    capsys.readouterr()
    assert main(["--check"]) == 1
    assert "- cheap 2.2\n+ cheap 2.0" in capsys.readouterr().out
    assert main(["--only", "dear"]) == 0
    assert "\ndear 1.0" in project.read_text()
    assert "\ncheap 2.2" in project.read_text()


def test_a_command_that_fails_is_named(project, capsys):
    project.write_text('<!-- table: python -c "raise SystemExit(3)" -->\n<!-- end -->\n')
    assert main([]) == 1
    assert "ended with status 3" in capsys.readouterr().err


def commands():
    """Every command of the documents' blocks and of the Makefile that runs one of the scripts."""
    found = [block.command for path in documents() for block in blocks(path.read_text(encoding="utf-8"))]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for name, value in re.findall(r"^(\w+) \?= (.*)$", makefile, re.MULTILINE):
        makefile = makefile.replace(f"$({name})", value)
    return found + [line.strip().removeprefix("$(BIN)/") for line in makefile.splitlines() if "-m scripts" in line]


@pytest.mark.parametrize("command", commands())
def test_every_command_is_one_that_its_script_takes(monkeypatch, command):
    _, script, *arguments = shlex.split(command)
    if script == "-m":  # a script that takes something from its neighbour
        name, *arguments = arguments
    else:
        assert (ROOT / script).is_file()
        name = script.removesuffix(".py").replace("/", ".")
    monkeypatch.setattr(sys, "argv", [script, *arguments])
    assert parsed(monkeypatch, importlib.import_module(name).main) == []
    for name in arguments:
        if name.startswith("data/"):
            assert (ROOT / name).is_file()


@pytest.mark.parametrize("path", documents(), ids=lambda path: path.name)
def test_no_table_of_results_stands_outside_a_block(path):
    """A table of symbols or criteria may hold a number; one with several of three decimals in a row is of results."""
    text = path.read_text(encoding="utf-8")
    for block in blocks(text):
        text = text.replace(block.content, "")
        assert block.content.startswith(shown(block.command, "").rstrip()), "the command that is shown is the one run"
    rows = [line for line in text.splitlines() if line.startswith("|") and len(re.findall(r"\d\.\d{3}", line)) > 1]
    assert rows == []


# A percentage, or a number of three significant digits or more.
RESULT = re.compile(r"(?<![\d.:/])(?:\d+(?:\.\d+)? %|[1-9]\d*\.\d\d+|0\.0*[1-9]\d\d+)(?![\d.])")


def repeated(text):
    """Numbers of a page's prose that stand in a table of results of the same section."""
    for section in re.split(r"\n(?=#)", text):
        tables = "\n".join(line for block in blocks(section) for line in block.content.splitlines() if line[:1] == "|")
        for block in blocks(section):
            section = section.replace(block.content, "")
        prose = re.sub(r"<!--.*?-->|```.*?```|\$[^$]*\$|`[^`]*`", "", section, flags=re.DOTALL)
        yield from {*RESULT.findall(prose)} & {*RESULT.findall(tables)}


@pytest.mark.parametrize("path", documents(), ids=lambda path: path.name)
def test_no_number_of_a_table_is_typed_beside_it(path):
    assert list(repeated(path.read_text(encoding="utf-8"))) == []


def test_a_number_that_is_typed_beside_its_table_is_found():
    table = "<!-- table: a -->\n| 12.5 % | 0.123 | 0.01 |\n<!-- end -->\n"
    prose = "By 12.5 %, 0.123 at `0.123`, H = 0.01.\n"
    assert set(repeated(f"# A\n{table}{prose}")) == {"12.5 %", "0.123"}
    assert list(repeated(f"# A\n{table}\n# B\n{prose}")) == []


def test_the_check_runs_the_tables():
    assert "make docs-check" in Path(ROOT / ".ci" / "run").read_text(encoding="utf-8")
