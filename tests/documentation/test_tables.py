"""Tables of the documentation: written by commands that run, compared as they should be."""

import importlib
import re
import shlex
import sys

import pytest

from scripts import docs_tables
from scripts.docs_tables import ROOT, blocks, differences, documents, main, shown
from tests.documentation.test_pages import parsed


@pytest.mark.parametrize(
    ("old", "new", "margin", "same"),
    [
        ("A = 0.9200", "A = 0.9201", 0, True),
        ("A = 0.9200", "A = 0.9189", 0.05, False),
        ("| -0.000 |", "| +0.000 |", 0, True),
        ("| −0.006 |", "| 0.006 |", 0, False),
        ("41 steps", "42 steps", 0, False),
        ("41 steps", "42 steps", 0.05, True),
        ("7.7e-09", "7.8e-09", 0, True),
        ("atoms", "continuum", 0.5, False),
        ("a", "a\nb", 0, False),
    ],
)
def test_what_counts_as_the_same(old, new, margin, same):
    assert (list(differences(old, new, margin)) == []) is same


def test_tables_are_written_and_checked(tmp_path, monkeypatch, capsys):
    page = tmp_path / "README.md"
    page.write_text(
        "<!-- table: python -c \"print('dear 1.0')\" -->\n<!-- end -->\n"
        "<!-- checked table: python -c \"print('cheap 2.0')\" -->\n<!-- end -->\n"
    )
    monkeypatch.setattr(docs_tables, "documents", lambda: [page])
    assert main(["--check"]) == 1
    assert "cheap 2.0\n" not in page.read_text(), "a check writes nothing"
    assert main([]) == main(["--check"]) == 0
    page.write_text(page.read_text().replace("\ndear 1.0", "\ndear 9.0"))
    assert main(["--check"]) == 0, "the dear one is not run"
    page.write_text(page.read_text().replace("\ncheap 2.0", "\ncheap 2.2"))
    capsys.readouterr()
    assert main(["--check"]) == 1
    assert "- cheap 2.2\n+ cheap 2.0" in capsys.readouterr().out
    assert main(["--only", "dear"]) == 0
    assert "\ndear 1.0" in page.read_text()
    assert "\ncheap 2.2" in page.read_text()
    page.write_text('<!-- table: python -c "raise SystemExit(3)" -->\n<!-- end -->\n')
    assert main([]) == 1
    assert "ended with status 3" in capsys.readouterr().err
    for broken in ("<!-- table: a -->\n", "<!-- table -->\n<!-- end -->\n", "<!-- end -->\n"):
        with pytest.raises(ValueError, match="no complete block"):
            blocks(broken)


@pytest.mark.validation
def test_scripts_that_share_a_process_print_what_they_print_alone(tmp_path, monkeypatch, capfd):
    page, command = tmp_path / "README.md", "python -m scripts.reference_tables symbols"
    page.write_text(f"<!-- checked table: {command} -->\n<!-- end -->\n")
    monkeypatch.setattr(docs_tables, "documents", lambda: [page])
    assert main([]) == main(["--check"]) == 0
    page.write_text(page.read_text().replace("symbols", "no_such_table"))
    assert main(["--check"]) == 1
    assert "no_such_table: ended with status 1" in capfd.readouterr().err


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
        if script.startswith("examples/"):  # runs as it is imported, which tests/test_examples.py does
            assert not arguments
            return
        name = script.removesuffix(".py").replace("/", ".")
    monkeypatch.setattr(sys, "argv", [script, *arguments])
    assert parsed(monkeypatch, importlib.import_module(name).main) == []
    assert all((ROOT / name).is_file() for name in arguments if name.startswith("data/"))


# A percentage, or a number of three significant digits or more.
RESULT = re.compile(r"(?<![\d.:/])(?:\d+(?:\.\d+)? %|[1-9]\d*\.\d\d+|0\.0*[1-9]\d\d+)(?![\d.])")


@pytest.mark.parametrize("path", documents(), ids=lambda path: path.name)
def test_results_stand_in_the_blocks_alone(path):
    """A table of symbols or criteria may hold a number; one with several of three decimals in a row is of results."""
    for section in re.split(r"\n(?=#)", path.read_text(encoding="utf-8")):
        tables = "\n".join(line for block in blocks(section) for line in block.content.splitlines() if line[:1] == "|")
        for block in blocks(section):
            section = section.replace(block.content, "")
            assert block.content.startswith(shown(block.command, "").rstrip()), "the command shown is the one run"
        rows = [line for line in section.splitlines() if line.startswith("|")]
        assert not [line for line in rows if len(re.findall(r"\d\.\d{3}", line)) > 1]
        prose = re.sub(r"<!--.*?-->|```.*?```|\$[^$]*\$|`[^`]*`", "", section, flags=re.DOTALL)
        assert not {*RESULT.findall(prose)} & {*RESULT.findall(tables)}, "typed beside its table"
