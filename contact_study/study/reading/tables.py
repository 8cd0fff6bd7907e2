"""Columns of numbers from a text file, such as a measured law, as they go into a study."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from contact_study import units
from contact_study.errors import InputError
from contact_study.files import refuse_endless

# Letters of a line that a message shows.
_SHOWN = 40


def read_columns(path: Path, name: str, column_units: Sequence[tuple[str, str, str]]) -> list[list[float]]:
    """The columns of a text table, in SI.

    Parameters
    ----------
    path : pathlib.Path
        Numbers separated by blanks, tabs or commas, a row a line; what follows ``#`` is left out.
    name : str
        The key that named the file, for messages.
    column_units : sequence of (str, str, str)
        Of each column the key that gives its unit, for messages, that unit, and the SI unit of its kind.

    Raises
    ------
    InputError
        If the file cannot be read, holds other than that many columns of finite numbers, or a unit is of another kind.
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
    """The numbers of lines, a row a line.

    Parameters
    ----------
    rows : sequence of (int, str)
        Lines with something on them, each with its number in the file.
    where : str
        The key and the file, for messages.
    separator : str
        Regular expression of what stands between two numbers, and may at either end of a line.

    Raises
    ------
    InputError
        If a line holds a word, or more or fewer numbers than the first.
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
    """The text of a file.

    Parameters
    ----------
    path : pathlib.Path
        The file.
    name : str
        The key that named it, for the message.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    try:
        refuse_endless(path)
        return path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "is no text"
        raise InputError(f"{name}: {path} cannot be read ({reason})") from None


def with_columns(
    table: Mapping[str, Any], section: str, columns: Mapping[str, tuple[str, str, str]], directory: Path
) -> dict[str, Any]:
    """A section of a study with the content of the file that its key ``path`` names in that key's place.

    A study then holds all that decides its numbers, wherever it goes.

    Parameters
    ----------
    table : mapping
        The section as TOML holds it.
    section : str
        Its name.
    columns : mapping
        For each column's key: the key of its unit, that key's default, the SI unit.
    directory : pathlib.Path
        Where a relative path starts.

    Raises
    ------
    InputError
        As :func:`read_columns`; also if columns are given beside the file.
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
