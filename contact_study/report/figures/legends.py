"""Legends and headings of the figures: letter and state of a panel, colours, lines and markers."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import ScaledTranslation

from contact_study.plots.paths import Curve
from contact_study.report.align.curves import Band, Strips
from contact_study.report.figures.style import look_of, typeset
from contact_study.report.models import entry_of

_HEADING = 14 / 72  # inches that a panel's letter and state take above its axes
_GREY = "#404040"
STRIP = 0.4  # opacity of the scatter between surfaces


def panel_heading(axes: Axes, letter: str, state: str = "") -> None:
    """Letter of a panel, and the state that all its curves share."""
    place: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points"}
    if letter:
        axes.annotate(f"({letter})", (0, 1), xytext=(-22, 4), weight="bold", fontsize=9, **place)
    axes.annotate(typeset(state), (0, 1), xytext=(0, 4), fontsize=8, **place)


def colour_legend(axes: Axes, curves: Sequence[Curve], colours: Sequence[Any], width: float) -> None:
    """Explain the colours of one panel above its heading, in rows of at most ``width`` inches."""
    handles = _colour_handles(curves, colours)
    figure = axes.figure
    above = axes.transAxes + ScaledTranslation(0, _HEADING, figure.dpi_scale_trans)

    def legend(**options: Any) -> Legend:
        return axes.legend(loc="lower left", bbox_to_anchor=(0, 1), bbox_transform=above, borderaxespad=0, **options)

    _fitted(legend, handles, width, figure, columnspacing=1.0, handlelength=0.8, handletextpad=0.6, borderpad=0.2)


def shared_colour_legend(figure: Figure, curves: Sequence[Curve], colours: Sequence[Any]) -> None:
    """Explain the colours of all panels above them."""
    handles = _colour_handles(curves, colours)

    def legend(**options: Any) -> Legend:
        return figure.legend(loc="outside upper center", **options)

    width = 0.96 * figure.get_figwidth()
    _fitted(legend, handles, width, figure, columnspacing=1.0, handlelength=0.8, handletextpad=0.6, borderpad=0.2)


def band_label(model: str) -> str:
    """The band between the metastable branches of a theory."""
    return f"{entry_of(model).label.removesuffix(' theory')} metastable band"


def model_legend(
    figure: Figure,
    curves: Sequence[Curve],
    densities: bool = False,
    bands: Sequence[Band] = (),
    colours: Mapping[str, Any] | None = None,
    strips: Strips | None = None,
) -> None:
    """Line and marker of each model below the axes, and the meaning of markers; grey where colours have another one."""
    colours = colours or {}
    handles: list[Artist] = []
    names = list(dict.fromkeys(curve.model for curve in curves))
    for model in names:
        look = look_of(model, names)
        alone = look.line == "none"
        colour = colours.get(model, _GREY)
        handles.append(
            Line2D(
                [],
                [],
                color=colour,
                linestyle=look.line,
                marker=look.marker if alone or not densities else "",
                mfc="none" if look.hollow else colour,
                ms=2.5 if alone and densities else look.marker_size,
                lw=max(look.line_width, 1.0),
                label=entry_of(model).label,
            )
        )
    for model in dict.fromkeys(band.model for band in bands):
        handles.append(Patch(color=colours.get(model, _GREY), alpha=0.15, lw=0, label=band_label(model)))
    if strips:
        handles.append(Patch(color=colours.get(strips.model, _GREY), alpha=STRIP, lw=0, label=strips.label))
    if not densities and any(curve.unloading is not None and curve.unloading.any() for curve in curves):
        handles.append(Line2D([], [], color=_GREY, ls="none", marker="o", mfc="white", ms=3.5, label="unloading"))
    if any(curve.fit is not None and (~curve.fit & np.isfinite(curve.x + curve.y)).any() for curve in curves):
        handles.append(Line2D([], [], color=_GREY, ls="none", marker="x", ms=5, label="not converged"))

    def legend(**options: Any) -> Legend:
        return figure.legend(loc="outside lower center", **options)

    _fitted(legend, handles, 0.96 * figure.get_figwidth(), figure, columnspacing=1.2, handletextpad=0.6)


def _colour_handles(curves: Sequence[Curve], colours: Sequence[Any]) -> list[Artist]:
    """One patch of colour for each label; a common beginning of the labels is shown before the first only."""
    names = dict(sorted({curve.colour: curve.label for curve in curves if curve.label}.items()))
    heads = {label.partition(" = ")[0] for label in names.values()}
    single = len(heads) == 1 and all(label.count(" = ") == 1 for label in names.values())
    handles: list[Artist] = []
    for number, label in names.items():
        words = label.partition(" = ")[2] if single and handles else label
        handles.append(Line2D([], [], color=colours[number], lw=3, label=typeset(words)))
    return handles


def _fitted(
    legend: Callable[..., Legend], handles: Sequence[Artist], width: float, figure: Any, **options: Any
) -> None:
    """Put up the legend with as many columns as fit ``width`` (inches), read along its rows."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    for columns in range(len(handles), 0, -1):
        # A legend fills its columns one after the other.
        ordered = [handle for first in range(columns) for handle in handles[first::columns]]
        made = legend(handles=ordered, ncols=columns, **options)
        if columns == 1 or made.get_window_extent(renderer).width <= width * figure.dpi:
            return
        made.remove()
