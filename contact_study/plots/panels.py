"""Figures of several models side by side, of curves along the path or of densities, and of one state.

Colour distinguishes the points of the sweep (or the states), line and marker the models; without labels the colour
distinguishes the models, too.
"""

import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import ScaledTranslation

from contact_study import plots
from contact_study.plots.paths import ERROR, Curve, Look, draw_path, draw_strip, error_band
from contact_study.plots.selection import extent
from contact_study.plots.style import COLOURS, DOUBLE, RESOLUTION, SINGLE, STYLE, plain_decades, styled

STATE_COLOURS = ("#000000", "#CC79A7", "#E69F00", "#56B4E9", "#0072B2", "#D55E00")
"""Colours of the states of one point of a sweep."""

BAND, STRIP = 0.15, 0.4  # opacity of what lies between two branches, and of the scatter between surfaces
_GREY = "#404040"
_HEADING = 14 / 72  # inches that a panel's letter and state take above its axes
_TICKS = 6  # along x: six numbers such as −0.075 fit half a page
_ROW = 0.16  # inches that a row of the legend takes
_DECADES = 8.0  # of densities that are shown, at most
_FRAME, _BAR = 0.75, 0.95  # inches around a map, and for the bar of colours
_SYMBOLS = {"h_rms": r"$h_\mathrm{rms}$", "d_c": r"$d_c$", "q_L": r"$q_L$", "ū": r"$\bar{u}$"}
# Metadata of files that would differ between equal figures.
_UNDATED: dict[str, dict[str, None]] = {
    "png": {"Software": None},
    "pdf": {"Creator": None, "Producer": None, "CreationDate": None},
    "svg": {"Creator": None, "Date": None},
}


@dataclass(frozen=True)
class Band:
    """Region between two branches of a theory at one point of the sweep."""

    look: Look  # of the theory
    colour: int  # number of the colour
    along: np.ndarray  # increasing, in the units of the figure
    low: np.ndarray
    high: np.ndarray


@dataclass(frozen=True)
class Panel:
    """Curves on one pair of axes."""

    curves: Sequence[Curve]
    x_label: str
    y_label: str
    scale: str = "linear"  # or "log" along y, "loglog" along both
    heading: str = ""  # state that all curves share
    bands: Sequence[Band] = ()
    strips: Sequence[Curve] = ()  # scatter between surfaces: means whose errors are standard deviations
    densities: bool = False  # whether it is of distributions; else of curves along the path
    upright: bool = False  # whether pressures are along y
    colours: tuple[str, ...] = COLOURS

    @cached_property
    def palette(self) -> list[Any]:
        """Colours of the points of the sweep."""
        return palette(self.colours, [*self.curves, *self.strips])


@styled
def panels_figure(panels: Sequence[Panel], strips: str = "", note: str = "", height: float = 3.5) -> Figure:
    """Draw panels side by side; in the legend ``strips`` names these and ``note`` stands above the models."""
    curves = [curve for panel in panels for curve in panel.curves]
    rows = max(0, -(-len({curve.colour for curve in panels[0].curves if curve.label}) // 3) - 1)
    width = DOUBLE if len(panels) > 1 else SINGLE + 0.6
    figure = Figure(figsize=(width, height + _ROW * rows), layout="constrained")
    densities = panels[0].densities
    every = list(figure.subplots(1, len(panels), squeeze=False, sharey=densities)[0])
    for letter, axes, panel in zip("abcd", every, panels, strict=False):
        panel_heading(axes, letter if len(panels) > 1 else "", panel.heading)
        if densities:
            _draw_densities(axes, panel)
            _colour_legend(axes, panel, 0.42 * DOUBLE)
        else:
            _draw_paths(axes, panel)
        axes.set(xlabel=panel.x_label, ylabel=panel.y_label if axes is every[0] or not densities else "")
        if panel.scale != "loglog":
            axes.locator_params(axis="x", nbins=_TICKS)
    if densities:
        lowest = _smallest_resolved(curves)
        for axes, panel in zip(every, panels, strict=True):
            # Tails of the theories have no end.
            seen = np.concatenate([np.empty(0), *(curve.x[curve.y > lowest] for curve in panel.curves)])
            if seen.size and np.ptp(seen) > 0:
                axes.set_xlim(seen.min() - 0.03 * np.ptp(seen), seen.max() + 0.03 * np.ptp(seen))
        axes.set_ylim(0.5 * lowest, 2 * max((float(np.nanmax(c.y, initial=lowest)) for c in curves), default=1.0))
    elif any(curve.label for curve in curves):
        _colour_legend(figure, panels[0], 0.96 * width)
    _model_legend(figure, panels, strips, note)
    return figure


@styled
def gap_maps(states: Mapping[str, xr.Dataset], words: str = "") -> Figure:
    """Local gap of several models in one state, contact in black, by the label of the model."""
    height, width = extent(next(iter(states.values())))
    count, aspect = len(states), height / width
    across, rows, columns = (DOUBLE if count > 1 else SINGLE + 1.2) - _FRAME - _BAR, 1, count
    if count > 1 and aspect < 0.5:
        rows, columns = count, 1
    else:
        across = min(across / count, 5.5 / aspect)
    size = columns * across + _FRAME + _BAR, max(rows * (across * aspect + 0.25) + _FRAME, 2.2)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    top = max(float(state["gap"].max()) for state in states.values())
    for axes, (label, state) in zip(panels.ravel(), states.items(), strict=True):
        plots.gap_map(state, axes, top=top, bar=list(panels.ravel()) if axes is panels[-1, -1] else None)
        axes.set_title(label, fontsize=8.5)
        axes.label_outer()
    if words:
        figure.suptitle(typeset(words), fontsize=8.5)
    return figure


@styled
def interface(state: xr.Dataset, words: str = "") -> Figure:
    """Pressure (a) and contact clusters (b) of a state, and a section through its highest point (c)."""
    figure = Figure(figsize=(DOUBLE, 5.2), layout="constrained")
    panels: dict[str, Axes] = figure.subplot_mosaic([["a", "b"], ["c", "c"]], height_ratios=[2.6, 1])
    plots.pressure_map(state, panels["a"])
    plots.contact_map(state, panels["b"])
    plots.section(state, axes=panels["c"])
    for letter, axes in panels.items():
        panel_heading(axes, letter, words if letter == "a" else "")
    return figure


@styled
def wide(draw: Callable[..., Axes], dataset: xr.Dataset, height: float, words: str = "") -> Figure:
    """One picture across the page, ``height`` inches high."""
    figure = Figure(figsize=(DOUBLE, height), layout="constrained")
    draw(dataset, axes=figure.subplots())
    if words:
        figure.suptitle(typeset(words), fontsize=8.5)
    return figure


@styled
def magnification(states: xr.Dataset, mapped: xr.Dataset, words: str = "", named: str = "") -> Figure:
    """Area (a), detachment stress (b) and work of adhesion (c) of the states, P(σ, ζ) of one (d) if it was kept."""
    with_map = "pressure_pdf_at" in mapped
    figure = Figure(figsize=(DOUBLE, 5.2 if with_map else 2.7), layout="constrained")
    panels: dict[str, Axes] = figure.subplot_mosaic([["a", "b"], ["c", "d"]] if with_map else [["a", "b", "c"]])
    curves = plots.area_by_magnification, plots.detachment_stress, plots.effective_work_of_adhesion
    legends = [draw(states, panels[letter]).get_legend() for letter, draw in zip("abc", curves, strict=True)]
    for legend in filter(None, legends[1:]):
        legend.remove()
    for text in legends[0].get_texts() if legends[0] else ():
        text.set_text(typeset(text.get_text()))
    if with_map:
        plots.stress_by_magnification(mapped, panels["d"])
    for letter, axes in panels.items():
        panel_heading(axes, letter, {"a": words, "d": named}.get(letter, ""))
    return figure


@styled
def loops(cycles: Mapping[str, xr.Dataset]) -> Figure:
    """Loading and unloading of several points of a sweep, side by side, by their labels."""
    shown = dict(list(cycles.items())[:3])
    figure = Figure(figsize=(DOUBLE if len(shown) > 1 else SINGLE + 0.6, 3.6), layout="constrained")
    for axes, (label, cycle) in zip(figure.subplots(1, len(shown), squeeze=False)[0], shown.items(), strict=True):
        plots.hysteresis_loop(cycle, axes)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16))
        axes.set_title(typeset(label), fontsize=8.5)
    return figure


def panel_heading(axes: Axes, letter: str, state: str = "") -> None:
    """Letter of a panel, and the state that all its curves share."""
    place: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points"}
    if letter:
        axes.annotate(f"({letter})", (0, 1), xytext=(-22, 4), weight="bold", fontsize=9, **place)
    axes.annotate(typeset(state), (0, 1), xytext=(0, 4), fontsize=8, **place)


def saved(figure: Figure, kind: str, name: str = "contact") -> bytes:
    """The figure as "png", "pdf" or "svg", of which the last two keep text as text, or for a "page".

    That is an SVG element whose identifiers begin with a name, and that takes ink and ground from the page around it.
    """
    stream, page = io.BytesIO(), kind == "page"
    text = {"pdf.fonttype": 42, "svg.fonttype": "path" if page else "none", "svg.hashsalt": name}
    with matplotlib.rc_context(STYLE | text):
        kind = "svg" if page else kind
        figure.savefig(stream, format=kind, dpi=RESOLUTION, metadata=_UNDATED[kind], transparent=page)
    if not page:
        return stream.getvalue()
    svg = stream.getvalue().decode()
    svg = svg[svg.index("<svg") :]
    inks = {"#000000": "currentColor", _GREY: "currentColor", "#606060": "var(--faint)"}
    inks |= {"#e6e6e6": "var(--rule)", "#f2f2f2": "var(--ground)", "#ffffff": "var(--card)"}
    for ink, own in inks.items():
        svg = svg.replace(f": {ink}", f": {own}")
    for before in ('id="', 'href="#', "url(#"):
        svg = svg.replace(before, f"{before}{name}-")
    return svg.encode()


def typeset(words: str) -> str:
    """Words of a label with their symbols set as such."""
    for plain, symbol in _SYMBOLS.items():
        words = words.replace(plain, symbol)
    return words


def palette(colours: tuple[str, ...], curves: Sequence[Curve]) -> list[Any]:
    """Colours by their number: the given ones if there are enough, else a row of growing brightness."""
    count = max((curve.colour for curve in curves), default=0) + 1
    if count <= len(colours):
        return list(colours)
    return list(matplotlib.colormaps["viridis"](np.linspace(0, 0.93, count)))


def _colour(panel: Panel, drawn: Curve | Band) -> Any:
    """The colour of a curve or band: that of its point of the sweep, or with a single point of its model."""
    swept = panel.densities or any(curve.label for curve in panel.curves)
    return panel.palette[drawn.colour] if swept else drawn.look.colour


def _draw_paths(axes: Axes, panel: Panel) -> None:
    shade = axes.fill_betweenx if panel.upright else axes.fill_between
    for band in panel.bands:
        shown = band.along > (-np.inf if panel.scale == "linear" else 0)
        shade(band.along[shown], band.low[shown], band.high[shown], color=_colour(panel, band), alpha=BAND, lw=0)
    for curve in panel.strips:
        draw_strip(axes, error_band(curve), _colour(panel, curve), STRIP, 0.5)
    for curve in panel.curves:
        draw_path(axes, _shown(curve, panel.scale), curve.look, _colour(panel, curve))
    low, high = _window(panel)
    if panel.scale == "linear" and not panel.upright:
        low[1] = 0
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    along, up = {"linear": ("linear", "linear"), "log": ("linear", "log"), "loglog": ("log", "log")}[panel.scale]
    axes.set(xscale=along, yscale=up)
    for axis, (least, most) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        if axis.get_scale() == "log" and most < 100 * least:  # powers of ten would be one or none
            plain_decades(axis, True)
    if panel.upright and low[0] < 0:
        axes.axvline(0, color="#909090", lw=0.7, zorder=1)


def _draw_densities(axes: Axes, panel: Panel) -> None:
    axes.set_yscale("log")
    for curve in panel.curves:
        colour, look = _colour(panel, curve), curve.look
        if curve.y_error is not None:
            low, high = curve.y - curve.y_error, curve.y + curve.y_error
            there = low > 0  # else the density may be zero
            axes.fill_between(curve.x, low, high, where=there, color=colour, alpha=ERROR, lw=0, zorder=1)
        if look.line == "none":
            axes.plot(curve.x, curve.y, look.marker, color=colour, ms=2.0, mfc="none", mew=0.6, zorder=2)
        else:
            axes.plot(curve.x, curve.y, linestyle=look.line, color=colour, lw=max(look.line_width, 1.0), zorder=3)


def _shown(curve: Curve, scale: str) -> Curve:
    """A curve without the states that logarithmic axes do not show."""
    positive = (curve.y > 0) & ((curve.x > 0) | (scale == "log")) | (scale == "linear")
    return replace(curve, x=np.where(positive, curve.x, np.nan))


def _window(panel: Panel) -> np.ndarray:
    """Limits of x and y (two rows) that hold every state; on logarithmic axes they end where the simulations do.

    Theories give numbers at any distance: they would press all else into a corner.
    """
    logarithms = np.array([panel.scale == "loglog", panel.scale != "linear"])
    states = []
    for curve in panel.curves:
        shown = _shown(curve, panel.scale)
        own = np.stack([shown.x, shown.y])[:, shown.finite]
        own[logarithms] = np.log10(own[logarithms])
        states.append(own)
    every, along = np.concatenate(states, axis=1), int(panel.upright)
    if panel.scale != "linear":
        simulated = [own for curve, own in zip(panel.curves, states, strict=True) if own.size and curve.simulated]
        every = every[:, every[along] >= min((own[along].min() for own in simulated), default=-np.inf)]
    low, high = every.min(axis=1), every.max(axis=1)
    margin = np.where(high > low, 0.04 * (high - low), 0.5)
    limits = np.stack([low - margin, high + margin])
    limits[:, logarithms] = 10.0 ** limits[:, logarithms]
    return limits


def _smallest_resolved(curves: Sequence[Curve]) -> float:
    """The smallest density that a simulation shows; theories reach below any sampling."""
    shown = [curve.y for curve in curves if curve.simulated] or [curve.y for curve in curves]
    values = np.concatenate([np.empty(0), *shown])
    values = values[np.isfinite(values) & (values > 0)]
    return float(max(values.min(), values.max() / 10**_DECADES)) if values.size else 1.0


def _colour_legend(place: Axes | Figure, panel: Panel, width: float) -> None:
    """Explain the colours above a panel's heading, or above all panels; a common beginning of labels is shown once."""
    named = dict(sorted({curve.colour: curve for curve in panel.curves if curve.label}.items())).values()
    heads = {one.label.partition(" = ")[0] for one in named}
    single = len(heads) == 1 and all(one.label.count(" = ") == 1 for one in named)
    handles: list[Artist] = []
    for one in named:
        words = one.label.partition(" = ")[2] if single and handles else one.label
        handles.append(Line2D([], [], color=_colour(panel, one), lw=3, label=typeset(words)))
    where: dict[str, Any] = {"loc": "outside upper center"}
    if isinstance(place, Axes):
        above = place.transAxes + ScaledTranslation(0, _HEADING, place.figure.dpi_scale_trans)
        where = {"loc": "lower left", "bbox_to_anchor": (0, 1), "bbox_transform": above, "borderaxespad": 0}
    options = {"columnspacing": 1.0, "handlelength": 0.8, "handletextpad": 0.6, "borderpad": 0.2}
    _fitted(place.legend, handles, width, place.figure, **where, **options)


def _model_legend(figure: Figure, panels: Sequence[Panel], strips: str, note: str) -> None:
    """Explain line and marker of each model below the axes, and the meaning of markers; grey where colours have one."""
    curves = [curve for panel in panels for curve in panel.curves]
    densities, swept = panels[0].densities, panels[0].densities or any(curve.label for curve in curves)
    handles: list[Artist] = []
    for look in {curve.look.label: curve.look for curve in curves}.values():
        alone, colour = look.line == "none", _GREY if swept else look.colour
        marker, size = look.marker if alone or not densities else "", 2.5 if alone and densities else look.marker_size
        line = {"color": colour, "ls": look.line, "lw": max(look.line_width, 1.0), "label": look.label}
        handles.append(Line2D([], [], marker=marker, ms=size, mfc="none" if look.hollow else colour, **line))
    for look in {own.look.label: own.look for panel in panels for own in panel.bands}.values():
        words = f"{look.label.removesuffix(' theory')} metastable band"
        handles.append(Patch(color=_GREY if swept else look.colour, alpha=BAND, lw=0, label=words))
    if any(panel.strips for panel in panels):
        colour = _GREY if swept else panels[0].strips[0].look.colour
        handles.append(Patch(color=colour, alpha=STRIP, lw=0, label=strips))
    marks: dict[str, Any] = {"color": _GREY, "ls": "none"}
    if not densities and any(curve.back[curve.finite].any() for curve in curves):
        handles.append(Line2D([], [], marker="v", mfc="white", ms=5, label="unloading", **marks))
    if any((~curve.fits & curve.finite).any() for curve in curves):
        handles.append(Line2D([], [], marker="x", ms=5, label="not converged", **marks))
    spacing = {"columnspacing": 1.2, "handletextpad": 0.6}
    below = {"loc": "outside lower center", "title": typeset(note) or None, **spacing}
    _fitted(figure.legend, handles, 0.96 * figure.get_figwidth(), figure, **below)


def _fitted(legend: Callable[..., Legend], handles: list[Artist], width: float, figure: Any, **options: Any) -> None:
    """Put up the legend with as many columns as fit ``width`` (inches), read along its rows."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    for columns in range(len(handles), 0, -1):
        # A legend fills its columns one after the other.
        ordered = [handle for first in range(columns) for handle in handles[first::columns]]
        made = legend(handles=ordered, ncols=columns, **options)
        if columns == 1 or made.get_window_extent(renderer).width <= width * figure.dpi:
            return
        made.remove()
