"""Force curves as text: a line of names and units above columns of numbers, and options in comments."""

import re
from collections.abc import Collection, Sequence
from pathlib import Path

from contact_study.inputs.number_tables import TableError, first_row, lines_of, numbers_of
from contact_study.physics.force_curves.columns import LEFT_OUT, RawCurve, known_name, named

_HEADER = 'give a line of names and units, "displacement (nm), force (nN)", in the file or as columns'
_OPTION = re.compile(r"#?\s*(?P<name>[a-z]+(?:_[a-z]+)+)\s*[:=]\s*(?P<value>.+?)\s*$")
_WITH_UNIT = re.compile(r"[^\[\](),;]+[\[(][^\[\]()]*[\])]")
_SPLITS = (r"\t", ";", ",", r"\s{2,}", r"\s+")


def read_text(path: Path, columns: str | None, options: Collection[str]) -> RawCurve:
    """Read a text under its own header or another one, and those of some options that its comments give."""
    lines = lines_of(path)
    first = first_row(lines)
    above = [line.strip().lstrip("#").strip() for line in lines[:first] if not _OPTION.match(line)]
    header = above if columns is None else [columns]
    try:
        table = numbers_of(lines[first:], commas_part=any("," in line for line in header[-1:]))
    except ValueError as error:
        raise error if isinstance(error, TableError) else TableError(f"cannot be read ({error})") from None
    said = {found["name"]: found["value"] for line in lines if (found := _OPTION.match(line))}
    cells, units = _cells(header, table.shape[1])
    curve = RawCurve({}, options={name: value for name, value in said.items() if name in options})
    for cell, unit, values in zip(cells, units, table.T, strict=True):
        known, uncertain, factor, kind = named(cell, unit)
        if known == LEFT_OUT:
            continue
        held = curve.uncertainties if uncertain else curve.columns
        if known in held:
            raise TableError(f"{{path}} has two columns of {known}; name one of them {LEFT_OUT}")
        held[known] = values * factor
        if kind == "V":
            curve.options["deflection_in"] = "V"
    return curve


def _cells(header: Sequence[str], count: int) -> tuple[list[str], list[str]]:
    """Names of the columns, and the units of a line of its own below them."""
    lines = [cells for line in header if (cells := _split(line, count))]
    if not lines:
        raise TableError(f"has {count} columns of numbers without names; {_HEADER}")
    last = lines[-1]
    if len(lines) > 1 and all(map(known_name, lines[-2])) and not any(map(known_name, last)):
        return lines[-2], [cell.strip("[]()") for cell in last]
    return last, [""] * count


def _split(line: str, count: int) -> list[str]:
    for separator in _SPLITS:
        cells = [cell.strip() for cell in re.split(separator, line.strip())]
        if len(cells) == count:
            return cells
    cells = _WITH_UNIT.findall(line)
    return cells if len(cells) == count else []
