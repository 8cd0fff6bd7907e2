"""How every figure looks: fonts, lines, colours, and the symbols in its words."""

import io
from collections.abc import Callable
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

RESOLUTION = 200  # dots per inch
SINGLE, DOUBLE = 3.46, 7.0  # inches: one and two columns of a journal

MODEL_NAMES = {
    "atomistic": "atoms",
    "continuum": "continuum",
    "theory": "Persson's theory",
    "gap_flow": "gap-flow theory",
}
LINES = {"atomistic": "none", "continuum": "-", "theory": "--", "gap_flow": ":"}
MARKERS = {"atomistic": "s", "continuum": "o", "theory": "", "gap_flow": ""}

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
