"""Text for a terminal: tables, and colours by rich where it is installed. Files and pipes get the same text plain."""

import shutil
import sys
import textwrap
from collections.abc import Sequence
from typing import Any

_WIDTH = 100  # columns where there is no terminal


def print_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table; the last column is folded where lines are too long."""
    console = _console()
    if console is not None:
        from rich.table import Table
        from rich.text import Text

        table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 3, 0, 0))
        for number, name in enumerate(head):
            last = number == len(head) - 1
            table.add_column(name, style="cyan" if number == 0 else "", no_wrap=not last, overflow="fold")
        for row in rows:
            table.add_row(*map(Text, row))
        console.print(table)
        return
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head) - 1)]
    before = sum(width + 3 for width in widths)
    for row in (head, *rows):
        start = "".join(f"{cell:{width + 3}}" for cell, width in zip(row, widths, strict=False))
        folded = textwrap.wrap(row[-1], max(30, _columns() - before)) or [""]
        print("\n".join((start + folded[0], *(" " * before + line for line in folded[1:]))).rstrip())


def say(text: str, style: str = "") -> None:
    """Print a line, in a style of rich on a terminal."""
    console = _console() if style else None
    if console is None:
        print(text)
    else:
        console.print(text, style=style, markup=False, highlight=False, soft_wrap=True)


def _console() -> Any:
    """Console of rich; None without it, or if nobody sees colours."""
    if not sys.stdout.isatty():
        return None
    try:
        from rich.console import Console
    except ImportError:  # an extra
        return None
    return Console(width=min(_columns(), 140), highlight=False)


def _columns() -> int:
    return shutil.get_terminal_size((_WIDTH, 24)).columns if sys.stdout.isatty() else _WIDTH
