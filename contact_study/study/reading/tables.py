"""Columns of numbers from a text file, such as a measured law, as they go into a study."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.inputs import units
from contact_study.inputs.errors import InputError
from contact_study.inputs.files import refuse_endless

# Letters of a line that a message shows.
_SHOWN = 40


def read_columns(path: Path, name: str, column_units: Sequence[tuple[str, str, str]]) -> list[list[float]]:
    """Read the columns of a text table, between blanks, tabs or commas, in SI; ``#`` begins a comment.

    ``name`` is the key that names the file; ``column_units`` gives for each column the key of its unit, that unit and
    the SI unit. Raises InputError if the file cannot be read, holds other than that many columns of finite numbers, or
    a unit is of another kind.
    """
    lines = [(number, line.split("#")[0]) for number, line in enumerate(text_of(path, name).splitlines(), 1)]
    rows = [(number, line) for number, line in lines if line.strip()]
    if not rows:
        raise InputError(f"{name}: {path} is empty; expected {len(column_units)} columns of numbers")
    table = numbers_of(rows, f"{name}: {path}", r"[\s,]+")
    if table.shape[1] != len(column_units) or not np.all(np.isfinite(table)):
        raise InputError(
            f"{name}: {path} holds a table of shape {table.shape}; expected {len(column_units)} columns of finite "
            "numbers"
        )
    sizes = [_size(*unit) for unit in column_units]
    return [[float(value) * size for value in column] for column, size in zip(table.T, sizes, strict=True)]


def numbers_of(rows: Sequence[tuple[int, str]], where: str, separator: str) -> np.ndarray:
    """Read the numbers of numbered lines, a row a line, between separators (a regular expression).

    Raises InputError if a line holds a word, or more or fewer numbers than the first; ``where`` names key and file.
    """
    table: list[list[float]] = []
    first = 0
    for number, line in rows:
        words = [word for word in re.split(separator, line) if word]
        if not words:
            continue
        first = first or number
        try:
            table.append([float(word) for word in words])
        except ValueError:
            raise InputError(
                f"{where} is no table of numbers: line {number} is {line.strip()[:_SHOWN]!r}; remove words, or put "
                "# before them, and part columns by blanks, tabs or commas"
            ) from None
        if len(words) != len(table[0]):
            raise InputError(
                f"{where} is no table of numbers: line {number} has {len(words)} of them, line {first} has "
                f"{len(table[0])}"
            )
    return np.array(table, ndmin=2)


def _size(key: str, unit: str, si: str) -> float:
    """Size in SI of a unit that a key names."""
    try:
        return units.quantity(f"1 {unit}", si, key)
    except InputError:
        raise InputError(f"{key} = {unit!r}: is no unit that can be converted to {si}") from None


def text_of(path: Path, name: str) -> str:
    """Read the text of a file; raise InputError, in the name of a key, if that is not possible."""
    try:
        refuse_endless(path)
        return path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "is no text"
        raise InputError(f"{name}: {path} cannot be read ({reason})") from None


def with_columns(
    table: Mapping[str, Any], section: str, columns: Mapping[str, tuple[str, str, str]], directory: Path
) -> dict[str, Any]:
    """Replace the key ``path`` of a section by the columns of the file that it names.

    A study then contains all that decides its numbers. ``columns`` gives for each column's key the key of its unit, the
    default unit and the SI unit. Raises InputError as :func:`read_columns`, and for columns beside the file.
    """
    if not isinstance(table.get("path"), str):
        return dict(table)
    beside = [name for name in columns if name in table]
    if beside:
        raise InputError(f"{section}.path and {section}.{beside[0]}: give the file or its numbers, not both")
    given = [(f"{section}.{key}", str(table.get(key, default)), si) for key, default, si in columns.values()]
    read = read_columns(directory / table["path"], f"{section}.path", given)
    left_behind = {"path", *(key for key, _, _ in columns.values())}
    kept = {name: value for name, value in table.items() if name not in left_behind}
    return {**kept, **dict(zip(columns, read, strict=True))}
