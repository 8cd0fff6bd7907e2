"""How the models look beside one another: lines, markers, colours, symbols in words, file formats."""

import io
from collections.abc import Iterable, Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from contact_study.plots.paths import Curve, Look
from contact_study.plots.style import COLOURS, RESOLUTION, STYLE
from contact_study.report.models import FORMATS, entry_of, kind_of

# Panels whose colours mean pressures use other ones than those of a sweep.
SWEEP_COLOURS = COLOURS
PRESSURE_COLOURS = ("#000000", "#CC79A7", "#E69F00", "#56B4E9", "#0072B2", "#D55E00")

_SHORT = 100.0  # ratio of the ends of a logarithmic axis

# For several datasets of one model: the first has the model's own line and marker.
_OTHER_LINES: tuple[Any, ...] = ((0, (7, 1.5)), (0, (4, 1, 1, 1)), (0, (4, 1, 1, 1, 1, 1)))
_OTHER_MARKERS = ("^", "D", "v")

_SYMBOLS = {"h_rms": r"$h_\mathrm{rms}$", "d_c": r"$d_c$", "q_L": r"$q_L$", "ū": r"$\bar{u}$"}

# Metadata of files that would differ between equal figures.
_UNDATED: dict[str, dict[str, None]] = {
    "png": {"Software": None},
    "pdf": {"Creator": None, "Producer": None, "CreationDate": None},
    "svg": {"Creator": None, "Date": None},
}


def look_of(model: str, beside: Iterable[str]) -> Look:
    """How a model is drawn in a figure beside others; datasets of one model take turns."""
    entry = entry_of(model)
    line, marker = entry.line, entry.marker
    turn = [name for name in dict.fromkeys(beside) if kind_of(name) == kind_of(model)].index(model)
    if turn:
        line = line if line == "none" else _OTHER_LINES[(turn - 1) % len(_OTHER_LINES)]
        marker = _OTHER_MARKERS[(turn - 1) % len(_OTHER_MARKERS)] if marker else marker
    return Look(line, marker, entry.marker_size, entry.line_width, entry.hollow, not entry.simulation)


def looks_of(curves: Sequence[Curve]) -> dict[str, Look]:
    """How the models of a figure are drawn, by their names."""
    names = list(dict.fromkeys(curve.model for curve in curves))
    return {name: look_of(name, names) for name in names}


def png(figure: Figure) -> bytes:
    """The figure as a PNG file."""
    return saved(figure, "png")


def saved(figure: Figure, kind: str) -> bytes:
    """The figure as a file of one of the formats; text stays text where the format has any."""
    assert kind in FORMATS
    stream = io.BytesIO()
    text = {"pdf.fonttype": 42, "svg.fonttype": "none", "svg.hashsalt": "contact"}
    with matplotlib.rc_context(STYLE | text):
        figure.savefig(stream, format=kind, dpi=RESOLUTION, metadata=_UNDATED[kind])
    return stream.getvalue()


def label_short_decades(axes: Axes) -> None:
    """Put plain numbers at 1, 2 and 5 on logarithmic axes below two decades, where powers of ten would overlap."""
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        if high < _SHORT * low:
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axis.set_minor_formatter(NullFormatter())


def palette(colours: tuple[str, ...], curves: Sequence[Curve]) -> list[Any]:
    """Colours by their number: the given ones if there are enough, else a row of growing brightness."""
    count = max((curve.colour for curve in curves), default=0) + 1
    if count <= len(colours):
        return list(colours)
    return list(matplotlib.colormaps["viridis"](np.linspace(0, 0.93, count)))


def typeset(words: str) -> str:
    """Words of a label with their symbols set as such."""
    for plain, symbol in _SYMBOLS.items():
        words = words.replace(plain, symbol)
    return words
