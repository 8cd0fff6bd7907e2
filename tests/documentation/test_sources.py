"""Sources are read or not cited: nothing that a user reads says of one that it was not."""

import re

import pytest

from tests.documentation.pages import PAGES, ROOT

DEBTS = re.compile(
    r"from memory[,;)]|named from memory|unchecked[,;).]|(paper|text) itself was not"
    r"|abstract[s]? (was|were|is) read|was read, not|looked up|not confirmed",
    re.IGNORECASE,
)
PACKAGES = ("bem_adhesion", "contact_study", "md_reference", "research", "scripts", "theory")
SOURCES = sorted(file for package in PACKAGES for file in (ROOT / package).rglob("*.py"))


@pytest.mark.parametrize("files", [PAGES, SOURCES], ids=["pages", "docstrings"])
def test_no_source_is_cited_unread(files):
    found = {
        str(file.relative_to(ROOT)): match.group()
        for file in files
        if (match := DEBTS.search(" ".join(file.read_text(encoding="utf-8").split())))
    }
    assert not found
