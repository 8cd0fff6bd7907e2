"""A table of the report: text in rows and columns, a dash where there is no number."""

from dataclasses import dataclass, field

import numpy as np

from contact_study.report.text.wording import fixed

NOTHING = "–"


@dataclass(frozen=True)
class Table:
    """Text in rows and columns.

    Attributes
    ----------
    title : str
        Title.
    header : list of str
        Names and units of the columns.
    rows : list of list of str
        Cells.
    groups : list of tuple
        Words over neighbouring columns and how many each spans.
    """

    title: str
    header: list[str]
    rows: list[list[str]]
    groups: list[tuple[str, int]] = field(default_factory=list)


def fixed_or_nothing(value: float, decimals: int) -> str:
    """So many decimals, or a dash for what is no number."""
    return fixed(value, decimals) if np.isfinite(value) else NOTHING
