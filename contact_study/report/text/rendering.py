"""Templates of the report, which turn facts into text and HTML."""

import re
from dataclasses import dataclass
from typing import Any

import jinja2
from markupsafe import Markup, escape

from contact_study.report.models import entry_of
from contact_study.report.text import wording

# Symbols whose subscripts are set as such; study text is full of underscores that are none.
_COLUMN = 400.0  # points: more than one column of a figure
_SUBSCRIPTS = re.compile(r"\b(h|U|σ|d|q)_(rms|full|max|eq|L|a)\b")
_BEFORE_UNITS = re.compile(r" (?=%|\(?[kMG]?Pa\b|h_rms|Å|[nµ]m\b|ε₀)")


@dataclass(frozen=True)
class Both:
    """Words in physical and in reduced units, of which a page shows one."""

    physical: str
    reduced: str

    def __html__(self) -> str:
        return f'<span class="si">{_symbols(self.physical)}</span><span class="rd">{_symbols(self.reduced)}</span>'

    def __str__(self) -> str:
        return self.physical


def render(template: str, **values: Any) -> str:
    """Fill in a template that gives HTML."""
    return _environment(autoescape=True).get_template(template).render(**values)


def paragraphs(template: str, **values: Any) -> list[str]:
    """Fill in a template of plain text and return its paragraphs, which lines of three hyphens separate.

    A template may break its lines anywhere: line breaks and spaces inside a paragraph become single spaces, and none
    remains inside brackets or before a punctuation mark.
    """
    text = _environment(autoescape=False).get_template(template).render(**values)
    joined = (re.sub(r"[ \t\n]+", " ", paragraph).strip() for paragraph in re.split(r"\n *---(?=\n|$)", text))
    tidy = (re.sub(r"(?<=\() | (?=[,;:.)](?:[\s,;:.)]|$))", "", paragraph) for paragraph in joined)
    return [paragraph for paragraph in tidy if paragraph]


def capitalised(words: str) -> str:
    """The words as the beginning of a sentence."""
    return words[:1].upper() + words[1:]


def _environment(autoescape: bool) -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("contact_study.report", "text"),
        autoescape=autoescape,
        trim_blocks=autoescape,  # of HTML alone: in paragraphs a line break is a space
        lstrip_blocks=autoescape,
        undefined=jinja2.StrictUndefined,
    )
    names = ("number", "fixed", "percent_of", "listed", "pressure", "force")
    environment.filters |= {name: getattr(wording, name) for name in names}
    environment.filters |= {"symbols": _symbols, "drawn": _drawn, "sentence": capitalised, "error": wording.with_error}
    environment.filters |= {"words": lambda name: entry_of(name).words, "label": lambda name: entry_of(name).label}
    return environment


def _drawn(svg: str, title: str) -> Markup:
    """An SVG element with its title for readers of screens; one of a single column is narrow."""
    width = float(svg.partition('width="')[2].partition("pt")[0])
    kind = ' class="narrow"' if width < _COLUMN else ""
    return Markup(svg.replace("<svg", f'<svg role="img" aria-label="{escape(title)}"{kind}', 1))


def _symbols(text: str | Both) -> Markup:
    if isinstance(text, Both):
        return Markup(text.__html__())
    unbroken = _BEFORE_UNITS.sub("\u00a0", str(escape(text)))
    return Markup(_SUBSCRIPTS.sub(r"\1<sub>\2</sub>", unbroken))
