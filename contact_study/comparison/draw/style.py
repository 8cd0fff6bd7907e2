"""How every figure looks: fonts, lines, colours, and the symbols in its words."""

import io
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from contact_study.comparison.models import entry_of, kind_of

RESOLUTION = 200  # dots per inch
SINGLE, DOUBLE = 3.46, 7.0  # inches: one and two columns of a journal

# Okabe and Ito: told apart with any colour vision. Panels whose colours mean pressures use other ones.
SWEEP_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
PRESSURE_COLOURS = ("#000000", "#CC79A7", "#E69F00", "#56B4E9", "#0072B2", "#D55E00")

STYLE = {
    "font.size": 8,
    "axes.labelsize": 8.5,
    "legend.fontsize": 7.5,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.2,
    "mathtext.fontset": "dejavusans",
    "legend.frameon": False,
    "legend.handlelength": 2.0,
    "savefig.dpi": RESOLUTION,
}


# Where several datasets of one model stand side by side: the first has the model's own line and marker.
_OTHER_LINES: tuple[Any, ...] = ((0, (7, 1.5)), (0, (4, 1, 1, 1)), (0, (4, 1, 1, 1, 1, 1)))
_OTHER_MARKERS = ("^", "D", "v")


@dataclass(frozen=True)
class Look:
    """Line and marker of one model in one figure; neither "none" nor empty where it has any."""

    line: Any
    marker: str
    marker_size: float
    line_width: float
    hollow: bool


def look_of(model: str, beside: Iterable[str]) -> Look:
    """How a model is drawn in a figure beside others; datasets of one model take turns."""
    entry = entry_of(model)
    line, marker = entry.line, entry.marker
    turn = [name for name in dict.fromkeys(beside) if kind_of(name) == kind_of(model)].index(model)
    if turn:
        line = line if line == "none" else _OTHER_LINES[(turn - 1) % len(_OTHER_LINES)]
        marker = _OTHER_MARKERS[(turn - 1) % len(_OTHER_MARKERS)] if marker else marker
    return Look(line, marker, entry.marker_size, entry.line_width, entry.hollow)


def styled(draw: Callable[..., Figure]) -> Callable[..., Figure]:
    """Draw in the common style without changing the caller's settings."""

    def drawn(*arguments: Any, **options: Any) -> Figure:
        with matplotlib.rc_context(STYLE):
            return draw(*arguments, **options)

    drawn.__doc__, drawn.__name__ = draw.__doc__, draw.__name__
    return drawn


def png(figure: Figure) -> bytes:
    """The figure as a PNG file; equal figures give equal bytes."""
    stream = io.BytesIO()
    with matplotlib.rc_context(STYLE):
        figure.savefig(stream, format="png", dpi=RESOLUTION, metadata={"Software": None})
    return stream.getvalue()


def palette(colours: tuple[str, ...], count: int) -> list[Any]:
    """So many colours: the given ones while they last, else a row of growing brightness."""
    if count <= len(colours):
        return list(colours)
    return list(matplotlib.colormaps["viridis"](np.linspace(0, 0.93, count)))


def typeset(words: str) -> str:
    """Words of a label with their symbols set as such."""
    for plain, symbol in (("h_rms", r"$h_\mathrm{rms}$"), ("d_c", r"$d_c$"), ("q_L", r"$q_L$"), ("ū", r"$\bar{u}$")):
        words = words.replace(plain, symbol)
    return words
