"""Templates of the report, which turn facts into text and HTML."""

import re
from typing import Any

import jinja2
from markupsafe import Markup, escape

from contact_study.inputs.units import quantity
from contact_study.report.models import entry_of
from contact_study.report.text import wording

# Symbols whose subscripts are set as such; study text is full of underscores that are none.
_SUBSCRIPTS = re.compile(r"\b(h|U|σ|d|q)_(rms|full|max|eq|L|a)\b")
_BEFORE_UNITS = re.compile(r" (?=%|\(?GPa|h_rms|Å|nm\b|ε₀)")


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
    names = ("number", "fixed", "percent", "percent_of", "listed", "listed_points", "varied", "modulus")
    environment.filters |= {name: getattr(wording, name) for name in names}
    environment.filters |= {"symbols": _symbols, "sentence": capitalised, "error": wording.with_error}
    environment.filters |= {"words": lambda name: entry_of(name).words, "label": lambda name: entry_of(name).label}
    environment.filters |= {"metres": wording.length, "lookup": lambda key, table: table[key]}
    environment.globals["meV"] = quantity("1 meV", "J", "well_depth")
    return environment


def _symbols(text: str) -> Markup:
    unbroken = _BEFORE_UNITS.sub("\u00a0", str(escape(text)))
    return Markup(_SUBSCRIPTS.sub(r"\1<sub>\2</sub>", unbroken))
