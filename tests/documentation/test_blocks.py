"""What the documentation says to type is what the commands take."""

import re
import shlex
import tomllib

import pytest

from contact_study.study.schema.dotted_keys import SECTIONS, read
from tests.documentation.pages import COMMANDS, PAGES, ROOT, SHELL, blocks, blocks_of, parsed

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
TARGETS = re.search(r"^\.PHONY: (.*)$", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)[1].split()


def commands():
    """Every command for a shell, in words."""
    for page in PAGES:
        for line in (line for block in blocks(page) if block.language in SHELL for line in block.lines):
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
    elif command == "eval":
        assert {*PROJECT["scripts"]} <= {*shlex.split(arguments[0].strip("$()"))}
    else:
        assert command == "dask"


@pytest.mark.parametrize("option", ["--surface.sede=1", "--sede"])
def test_an_option_that_is_none_is_found(option, capsys):
    assert COMMANDS["bem-adhesion"](["study.toml", option]) == 1
    assert option.partition("=")[0] in capsys.readouterr().err


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_blocks_are_of_languages_that_are_checked(page):
    for block in blocks(page):
        assert block.language in (*SHELL, "python", "toml") or block.language.startswith("{")
        if block.language == "python":
            compile(block.text, page.name, "exec")


def study_blocks():
    return [
        pytest.param(block.text, id=f"{page.stem} {number}")
        for page in PAGES
        for number, block in enumerate(blocks(page))
        if block.language == "toml"
    ]


@pytest.mark.parametrize("text", study_blocks())
def test_keys_of_the_documentation_can_be_read(text):
    for section, content in tomllib.loads(text).items():
        if section == "sweep":
            for dotted, values in content.items():
                for value in values:
                    read(dotted, value)
        elif section == "override":
            for item in content:
                for dotted, value in {**item, **item["when"]}.items():
                    if dotted != "when":
                        read(dotted, value)
        else:
            assert section in SECTIONS
            for name, value in content.items():
                read(f"{section}.{name}", value)


def test_blocks_are_found_with_their_reasons():
    text = "a\n```\nmake env\n# not this\n\n```\n<!-- table: x -->\n```\nx\n```\n<!-- end -->\n"
    text += "<!-- not run: no cluster -->\n```python\nimport none\n```\n"
    one, two = blocks_of(text)
    assert (one.language, one.lines, one.reason) == ("", ["make env"], None)
    assert (two.language, two.text, two.reason) == ("python", "import none\n", "no cluster")
