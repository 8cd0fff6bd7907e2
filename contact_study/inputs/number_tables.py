"""Numbers in a text: rows between blanks, tabs, semicolons or commas, with decimal points or commas."""

import re
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from contact_study.inputs.errors import InputError

NUMBER = re.compile(r"\s*[-+]?\.?\d|\s*nan\b", re.IGNORECASE)  # how a row of numbers begins
_MANY = 30  # fractions, of which a tenth begins with 0, among which one does so for certain


class TableError(InputError):
    """A fault of a file of numbers, in words after its name, or around ``{path}``."""

    def of_file(self, path: Path) -> str:
        """The fault with the name of the file."""
        words = str(self) if "{path}" in str(self) else f"{{path}} {self}"
        return words.replace("{path}", str(path))


def lines_of(path: Path) -> list[str]:
    """The lines of a text; instruments still write the micro sign in Latin-1."""
    content = path.read_bytes()
    try:
        return content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        return content.decode("latin-1").splitlines()


def first_row(lines: Sequence[str]) -> int:
    """Number of the first line that begins with a number, from 0; that of all lines without one."""
    return next((number for number, line in enumerate(lines) if NUMBER.match(line)), len(lines))


def numbers_of(lines: Sequence[str], commas_part: bool = False) -> np.ndarray:
    """Rows of numbers between blanks, tabs, semicolons or commas, NaN in empty places; ValueError for other things.

    ``commas_part``: whether names above them are between commas, so that no comma alone is a decimal sign.
    """
    separator, decimal = separation_of([line for line in lines if NUMBER.match(line)][:30], commas_part)
    if (separator, decimal) == (", ", ","):
        lines, separator = [re.sub(r",([ \t]+|$)", ";", line.rstrip()) for line in lines], ";"
    if decimal == ",":
        lines = [line.replace(",", ".") for line in lines]
    if separator:  # what all lines end with parts nothing; empty places hold NaN
        lines = [line.strip() for line in lines if line.strip() and not line.lstrip().startswith("#")]
        if all(line.endswith(separator) for line in lines):
            lines = [line.removesuffix(separator) for line in lines]
        lines = [separator.join(cell if cell.strip() else "nan" for cell in line.split(separator)) for line in lines]
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # of no rows
        try:
            table = np.loadtxt(lines, ndmin=2, delimiter=separator)
        except ValueError as error:
            words = next((line for line in lines if line.strip()[:1] not in ("", "#") and not NUMBER.match(line)), "")
            reason = str(error).partition(";")[0]  # followed by NumPy's own arguments
            raise ValueError(f"it has the line {words.strip()[:40]!r}" if words else reason) from None
    if not table.size:
        raise TableError("holds no numbers")
    return table


def separation_of(lines: Sequence[str], commas_part: bool) -> tuple[str | None, str]:
    """Separator of the numbers in these lines, None for blanks and tabs, and decimal sign; InputError if open."""
    text = "\n".join(lines)
    if ";" in text:
        return ";", "," if "," in text and "." not in text else "."
    if "," not in text:
        return None, "."
    inside, blank_after = re.search(r"\d,\d", text), re.search(r",[ \t]", text)
    if inside and not re.search(r",\s|,$|\.\d", text, re.MULTILINE) and re.search(r"\d[ \t]+[-+]?\d", text):
        return None, ","  # between blanks a comma inside of every number is its decimal sign
    if inside and blank_after and "." not in text:
        return ", ", ","
    if (
        not commas_part
        and "." not in text
        and not blank_after
        and _may_be_decimal([line.strip().strip(",").split(",") for line in lines])
    ):
        raise TableError("looks like decimal commas between commas; use another separator, such as semicolons")
    return ",", "."


def _may_be_decimal(rows: Sequence[Sequence[str]]) -> bool:
    """Test whether every second cell may be digits behind a decimal comma; many like integers are integers."""
    whole, digits = ([cell.strip() for row in rows for cell in row[first::2]] for first in (0, 1))
    if any(len(row) % 2 for row in rows) or not all(cell.isdecimal() for cell in digits):
        return False
    lengths = set(map(len, digits))
    zeros = any(cell[0] == "0" and len(cell) > 1 for cell in digits)
    integers = not zeros and all(cell.isdecimal() for cell in whole) and lengths == set(map(len, whole))
    return not (integers and lengths != {1} and len(digits) >= _MANY)
