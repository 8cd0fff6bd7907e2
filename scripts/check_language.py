"""Check the words that users and readers meet: pages, docstrings, comments, messages, help texts and long names.

The rules are those of the style guide in CONTRIBUTING: no banned words, sentences of at most 25 words on the first
line of a docstring and 40 elsewhere, ``long_name`` and help texts of at most 90 characters, and numpydoc sections with
an example for every public function and class.

    python -m scripts.check_language            # every finding, exit status 1 if there is one
    python -m scripts.check_language --count    # findings by rule and package
"""

import argparse
import ast
import importlib
import inspect
import io
import re
import sys
import tokenize
from collections import Counter
from collections.abc import Iterator
from enum import Enum
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("contact_study", "bem_adhesion", "md_reference", "theory")
SUMMARY_WORDS, SENTENCE_WORDS, NAME_CHARACTERS = 25, 40, 90
BUDGETS = {"README.md": 700, "CHANGELOG.md": 1500, "docs": 47_950}  # words
BANNED = (
    "anew",
    "as ever",
    "at hand",
    "by hand",
    "comes? apart",
    "comes? off",
    "dear(?:er)?",
    "ere long",
    "for good",
    "from memory",
    "gives? way",
    "given way",
    "gone on",
    "goes on",
    "have come",
    "is said",
    "is told",
    "knows? (?:no|nothing|its|of)",
    "less the",
    "of one's own",
    "taken up",
    "tears? off",
    "tells? apart",
    "told apart",
    "tried without gain",
    "was told",
    "witness",
)
STARTS = ("What", "Of", "From", "Where")
_banned = re.compile(r"\b(" + "|".join(BANNED) + r")\b", re.IGNORECASE)
_starts = re.compile(rf"(?:^|(?<=[.:;] ))({'|'.join(STARTS)}) ")
_sentence_end = re.compile(r"(?<=[.!?:;])\s+")
_section = re.compile(r"^\s*(\w[\w ]*)\n\s*-{3,}\s*$", re.MULTILINE)


class Finding(NamedTuple):
    """One breach of a rule."""

    rule: str
    file: str
    line: int
    words: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.rule}: {self.words}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", action="store_true", help="number of findings by rule and package")
    given = parser.parse_args()
    findings = [*_texts(), *_public(), *_long_names(), *_pages()]
    if given.count:
        for (rule, package), number in sorted(Counter((f.rule, f.file.split("/")[0]) for f in findings).items()):
            print(f"{rule:24} {package:16} {number}")
    else:
        for finding in findings:
            print(finding)
    print(f"{len(findings)} findings", file=sys.stderr)
    return 1 if findings else 0


def _texts() -> Iterator[Finding]:
    """Findings in docstrings, comments and other strings of the packages."""
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            name, source = str(path.relative_to(ROOT)), path.read_text(encoding="utf-8")
            documented = _docstrings(ast.parse(source))
            for line, text in documented.items():
                yield from _prose(name, line, text)
            for token in tokenize.generate_tokens(io.StringIO(source).readline):
                if token.type == tokenize.COMMENT or (
                    token.type == tokenize.STRING and token.start[0] not in documented
                ):
                    yield from _words(name, token.start[0], token.string)


def _docstrings(tree: ast.Module) -> dict[int, str]:
    """Docstrings by the line where they begin."""
    nodes = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    return {
        node.body[0].lineno: ast.get_docstring(node) or ""
        for node in ast.walk(tree)
        if isinstance(node, nodes) and ast.get_docstring(node)
    }


def _words(name: str, line: int, text: str) -> Iterator[Finding]:
    for found in _banned.finditer(text):
        yield Finding("banned words", name, line, found.group())


def _prose(name: str, line: int, text: str) -> Iterator[Finding]:
    yield from _words(name, line, text)
    body = _section.sub("", text)
    first = body.split("\n\n")[0].replace("\n", " ")
    if len(first.split()) > SUMMARY_WORDS:
        yield Finding("long summary", name, line, f"{len(first.split())} words")
    if _starts.match(first):
        yield Finding("sentence start", name, line, first[:60])
    for paragraph in re.split(r"\n\s*\n|\n\s*- ", body):
        for sentence in _sentence_end.split(paragraph.replace("\n", " ")):
            if len(sentence.split()) > SENTENCE_WORDS and "|" not in sentence and ">>>" not in sentence:
                yield Finding("long sentence", name, line, f"{len(sentence.split())} words: {sentence[:60]}")


def _public() -> Iterator[Finding]:
    """Public functions and classes without the sections that they owe."""
    for package in (*PACKAGES, "contact_study.plots"):
        module = importlib.import_module(package)
        for name in module.__all__:
            thing = getattr(module, name)
            if not callable(thing) or (inspect.isclass(thing) and _has_no_arguments(thing)):
                continue
            text, file = inspect.getdoc(thing) or "", Path(inspect.getfile(thing))
            where = str(file.relative_to(ROOT)) if file.is_relative_to(ROOT) else package
            owed = {"Examples"}
            signature = inspect.signature(thing)
            if signature.parameters:
                owed.add("Parameters")
            if not inspect.isclass(thing):
                owed.add("Returns")
            for section in sorted(owed - set(_section.findall(text))):
                if not (section == "Parameters" and "Attributes" in text):
                    yield Finding("public docstring", where, inspect.getsourcelines(thing)[1], f"{name}: no {section}")


def _pages() -> Iterator[Finding]:
    """Findings in the pages of the site, and pages above their budget of words."""
    pages = [ROOT / name for name in BUDGETS if (ROOT / name).is_file()] + sorted((ROOT / "docs").glob("*.md"))
    for path in pages:
        name, text = str(path.relative_to(ROOT)), path.read_text(encoding="utf-8")
        prose = re.sub(r"```.*?```|<!-- (?:checked )?table.*?<!-- end -->|\$\$.*?\$\$", "", text, flags=re.DOTALL)
        prose = "\n\n".join(line if line.strip()[:1] not in "|#-!" else "" for line in prose.splitlines() if line)
        yield from _words(name, 1, prose)
    for name, budget in BUDGETS.items():
        path = ROOT / name
        files = sorted(path.glob("*.md")) if path.is_dir() else [path]
        words = sum(len(file.read_text(encoding="utf-8").split()) for file in files)
        if words > budget:
            yield Finding("word budget", name, 1, f"{words} words of {budget}")


def _has_no_arguments(thing: type) -> bool:
    """Whether nobody constructs a class with arguments: errors, enumerations, protocols."""
    return issubclass(thing, (Exception, Enum)) or getattr(thing, "_is_protocol", False)


def _long_names() -> Iterator[Finding]:
    """Long names of dataset variables and help texts of keys that are no short noun phrases."""
    from contact_study.results.schema import COORDINATES, VARIABLES
    from contact_study.study.schema.dotted_keys import all_keys

    for name, variable in {**VARIABLES, **COORDINATES}.items():
        yield from _short("long_name", "contact_study/results/schema.py", name, variable.long_name)
    for section, name, key, _ in all_keys():
        yield from _short("help text", "contact_study/study/schema", f"{section}.{name}", key.description)


def _short(rule: str, file: str, name: str, text: str) -> Iterator[Finding]:
    if len(text) > NAME_CHARACTERS:
        yield Finding(rule, file, 0, f"{name}: {len(text)} characters")


if __name__ == "__main__":
    sys.exit(main())
