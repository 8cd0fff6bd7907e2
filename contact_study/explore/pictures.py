"""Pictures of a page: Bokeh figures whose data are replaced from state to state, in the browser or on a server.

A map travels on as many cells as a screen has, never point by point. Colours and units are those of
:mod:`contact_study.plots`; ink and ground are the page's (CSS variables of Bokeh).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from bokeh.models import ColorBar, ColumnDataSource, CustomJS, CustomJSHover, HoverTool, LinearColorMapper, Span
from bokeh.plotting import figure as bokeh_figure
from matplotlib import colormaps
from matplotlib.colors import to_hex

from contact_study.explore.selection import block_of, difference, field_of, load_path, reduced
from contact_study.plots import maps, style
from contact_study.plots.curves import PATHS
from contact_study.plots.densities import DENSITIES, LEAST
from contact_study.plots.force_curves import force_states, force_unit
from contact_study.plots.maps import Colouring
from contact_study.plots.measured_curves import measured_states
from contact_study.plots.paths import Look
from contact_study.plots.selection import along_line, extent, highest_row, touching
from contact_study.plots.style import COLOURS, Unit
from contact_study.report.models import look_of

CELLS = 512  # of a map along a side, at most: what a screen shows
FORCE = "force"
CURVES = {"relative_contact_area": "Contact area", "mean_gap": "Mean gap", FORCE: "Force curve"}
DISTRIBUTIONS = {"pressure": "Stress P(σ)", "gap": "Gap P(u)"}
"""Curves along the path, and distributions of a state, with their titles."""
# Properties of the page around a figure that Bokeh draws text and axes with, and the rest of its look.
INKS = [f"--bk-{name}text-color" for name in ("", "title-", "axis-label-", "major-label-", "label-")]
INKS += [f"--bk-{name}-line-color" for name in ("axis", "major-tick", "minor-tick")]
GROUND = """--bk-background-fill-color: transparent; --bk-border-fill-color: transparent;
  --bk-outline-line-color: #8888; --bk-grid-line-color: #8883;"""
_ANY_GROUND = {"#000000": "#808080"}
_DASHES = {"-": "solid", "--": "dashed", ":": "dotted", "-.": "dotdash", "none": "solid"}
_MARKERS = {"s": "square", "o": "circle", "^": "triangle", "D": "diamond", "P": "plus", "": "dot"}
_SYMBOLS = {r"\bar{u}": "ū", r"\sigma": "σ", "A_0": "A₀", "$": ""}
_LENGTHS = {"mean_gap": style.length_unit}
_SHARE = Colouring(Unit("", 1.0), 0.0, 1.0, colormaps["gray_r"], "contact, share of a cell")
_LINES = ("xs", "ys", "colour", "dash", "alpha", "label")
_STATES = ("x", "y", "colour", "fill", "marker", "model", "place", "words")
_DRAG = """
if (fig.toolbar.gestures.pan.active || fig.toolbar.gestures.rect?.active) return
const here = [cb_obj.x, cb_obj.y], now = Date.now()
if (cb_obj.event_name == "panstart") { line.started = here; line.drawn = 0; return }
if (cb_obj.event_name == "pan" && now - line.drawn < 80) return
const start = line.started
line.drawn = now
line.data = {x: [start[0], here[0]], y: [start[1], here[1]]}
"""


def _no_unit(_: float) -> Unit:
    return Unit("", 1.0)


def plain(words: str) -> str:
    """Words of an axis without mathematical typesetting."""
    for typeset, symbol in _SYMBOLS.items():
        words = words.replace(typeset, symbol)
    return words


@dataclass(frozen=True)
class View:
    """Columns of the sources of a picture by their names, and the words of its axes."""

    sources: dict[str, dict[str, Any]]
    x_label: str
    y_label: str


@dataclass(frozen=True)
class MapView(View):
    """A field as it travels to the screen: cells (y, x) in a unit, minus infinity in contact, and its look."""

    cells: np.ndarray
    lengths: Unit
    look: Colouring

    def within(self, look: Colouring) -> "MapView":
        """The same in the colours, and the unit, of another state."""
        cells = self.cells * np.float32(self.look.unit.size / look.unit.size)
        return replace(self, cells=cells, look=look, sources={"image": self.sources["image"] | {"image": [cells]}})


def map_view(
    state: xr.Dataset,
    name: str,
    window: tuple[float, float, float, float] | None = None,
    minus: xr.Dataset | None = None,
    cells: int = CELLS,
) -> MapView:
    """A field of a state, or its difference to another state ``minus``, as a map.

    ``window`` is the part to show: x, y, width, height (m).
    """
    patches = name == "clusters" and minus is None
    if minus is not None:
        name = "contact" if name == "clusters" else name
        field = difference(state, minus, name)
        limit = style.largest(field) or 1.0
        units = {"pressure": style.pressure_unit, "contact": _no_unit}
        unit = units.get(name, style.length_unit)(limit)
        words = f"difference ({unit.name})" if unit.name else "difference"
        look = Colouring(unit, -limit, limit, colormaps["RdBu_r"], words)
    else:
        field = maps.contact_clusters(state)[0] if patches else field_of(state, name)
        look = {
            "gap": lambda gap: maps.gap_colouring(gap, touching(state), float(state["contact_distance"])),
            "clusters": lambda _: maps.cluster_colouring(),
            "height": maps.height_colouring,
            "pressure": maps.pressure_colouring,
        }.get(name, lambda _: _SHARE)(field)
    size, shape = extent(state), field.shape
    x, y, dx, dy = window or (0.0, 0.0, size[1], size[0])
    cut, image = [], {}
    for axis, (first, length) in enumerate(((y, dy), (x, dx))):
        step = size[axis] / shape[axis]
        ends = np.clip([int(first / step), int(np.ceil((first + length) / step))], 0, shape[axis])
        block = block_of(ends[1] - ends[0], cells)
        cut.append(slice(*ends))
        image["yx"[axis]], image[("dh", "dw")[axis]] = ends[0] * step, -(-(ends[1] - ends[0]) // block) * block * step
    part = field[tuple(cut)]
    if patches:  # the largest patch of a cell, not a mean of numbers
        values = reduced(np.where(part == 0, 99, part), cells, np.minimum)
        values = np.where(values == 99, 0, values)
    else:
        values = reduced(part, cells) / look.unit.size
    if name == "gap" and minus is None:
        values = np.where(reduced(touching(state)[tuple(cut)], cells) >= 0.5, -np.inf, values)
    values, lengths = values.astype(np.float32), style.length_unit(max(size))
    columns = {name: [end / lengths.size] for name, end in image.items()} | {"image": [values]}
    return MapView({"image": columns}, f"x ({lengths.name})", f"y ({lengths.name})", values, lengths, look)


def curve_view(cases: Mapping[str, xr.Dataset], kind: str, measured: Sequence[xr.Dataset] = ()) -> View | None:
    """Curves of the cases of models by their names, of :data:`CURVES`; None where no model has such a curve."""
    forces = kind == FORCE
    x_name, y_name = ("displacement", "total_force") if forces else ("mean_pressure", kind)
    shown = {name: case for name, case in cases.items() if x_name in case and y_name in case}
    others = [measured_states(one, "displacement") for one in measured] if forces else []
    if not shown and not others:
        return None
    most = (
        max(style.largest(values) for values in own)
        for own in (
            [*(case[x_name].values for case in shown.values()), *(other.x for other in others)],
            [*(case[y_name].values for case in shown.values()), *(other.force for other in others)],
        )
    )
    unit_of = (style.length_unit, force_unit) if forces else (style.pressure_unit, _LENGTHS.get(kind, _no_unit))
    along, up = (choose(value) for choose, value in zip(unit_of, most, strict=True))
    lines, points = [], []
    for name, case in shown.items():
        look, path = _look(name, shown), load_path(case)
        x, y = (np.where(path.fit, case[one].values[path.steps], np.nan) for one in (x_name, y_name))
        passed = force_states(case) if forces else (x, y, path.unloading)
        for side, alpha in ((~passed[2], 1.0), (passed[2] | np.append(passed[2][1:], False), 0.5)):
            if side.any():
                drawn = passed[0][side] / along.size, passed[1][side] / up.size
                lines.append((*drawn, look.colour, _dash(look), alpha, look.label))
        for place in np.flatnonzero(np.isfinite(x) & np.isfinite(y)):
            back = bool(path.unloading[place])
            marker = "inverted_triangle" if back else _MARKERS[look.marker]
            drawn = float(x[place] / along.size), float(y[place] / up.size)
            fill = "white" if back or look.hollow else look.colour
            points.append((*drawn, look.colour, fill, marker, name, int(place), f"{look.label}: {path.words[place]}"))
    for number, other in enumerate(others):
        colour = COLOURS[(len(shown) + 1 + number) % len(COLOURS)]
        drawn = other.x / along.size, other.force / up.size
        lines.append((*drawn, colour, "dotted", 1.0, other.title or "measured"))
    x_label, y_label = ("displacement δ", "force F") if forces else ("pressure p", plain(PATHS[kind]))
    sources = {"lines": _columns(_LINES, lines), "states": _columns(_STATES, points)}
    return View(sources, f"{x_label} ({along.name})", f"{y_label} ({up.name})" if up.name else y_label)


def states_now(view: View, places: Mapping[str, int]) -> dict[str, list[Any]]:
    """Columns of the states of a curve that are shown, a place on the path for each model."""
    states = view.sources["states"]
    pairs = zip(states["model"], states["place"], strict=True)
    chosen = [number for number, (model, place) in enumerate(pairs) if places.get(model) == place]
    return {name: [states[name][number] for number in chosen] for name in ("x", "y", "colour")}


def density_view(cases: Mapping[str, xr.Dataset], steps: Mapping[str, int], of: str) -> View | None:
    """Distributions of pressure or gap of one state of each model; None where no model has one."""
    unit_of, symbol, density = DENSITIES[of]
    name, bins = f"{of}_pdf", f"{of}_bin"
    shown = {model: case for model, case in cases.items() if name in case and np.nansum(case[name].values) > 0}
    if not shown:
        return None
    most = 0.0  # over the whole path: axes do not jump
    for case in shown.values():
        pdf = np.nan_to_num(case[name].values)
        most = max(most, style.largest(case[bins].values[(pdf > LEAST * pdf.max()).any(axis=0)]))
    unit, lines = unit_of(most), []
    for model, case in shown.items():
        look, pdf = _look(model, shown), case[name].isel(step=steps[model]).values
        there = pdf > LEAST * style.largest(pdf)
        drawn = case[bins].values[there] / unit.size, pdf[there] * unit.size
        lines.append((*drawn, look.colour, _dash(look), 1.0, look.label))
    sources = {"lines": _columns(_LINES, lines)}
    return View(sources, f"{plain(symbol)} ({unit.name})", f"{plain(density)} (1/{unit.name})")


def section_view(state: xr.Dataset, ends: tuple[tuple[float, float], tuple[float, float]] | None = None) -> View:
    """A section between two points (y, x) of a state, by default along x through the highest point of the surface."""
    if ends is None:
        y, x = float(state["y"].values[highest_row(state)]), state["x"].values
        ends = (y, float(x[0])), (y, float(x[-1]))
    x, surface, gap, contact = along_line(state, *ends)
    x, surface, gap, contact = (values[:: max(1, x.size // (2 * CELLS))] for values in (x, surface, gap, contact))
    block = np.where(np.isfinite(gap), surface + gap, np.nan)
    along, up = style.length_unit(float(x[-1])), style.length_unit(float(np.nanmax([surface, block]) - surface.min()))
    heights = {"surface": surface, "block": block, "contact": np.where(contact, surface, np.nan)}
    columns = {name: values / up.size for name, values in (heights | {"floor": 0 * x + surface.min()}).items()}
    return View({"section": {"x": x / along.size, **columns}}, f"along the line ({along.name})", f"height ({up.name})")


class Picture:
    """A figure and its sources, whose columns :meth:`show` replaces."""

    def __init__(self, view: View, size: tuple[int, int], title: str = "", **options: Any):
        self.view: Any = None
        self.sources = {name: ColumnDataSource(columns) for name, columns in view.sources.items()}
        tools = {"tools": "box_zoom,wheel_zoom,pan,reset,save", "active_drag": None, "toolbar_location": "above"}
        self.figure = bokeh_figure(frame_width=size[0], frame_height=size[1], title=title, **tools, **options)
        self.figure.toolbar.update(logo=None, autohide=True)
        self.figure.title.update(text_font_style="normal", text_font_size="13px")
        sizes = {"axis_label_text_font_size": "12px", "major_label_text_font_size": "11px"}
        for axis in self.figure.axis:
            axis.update(axis_label_text_font_style="normal", **sizes)

    def show(self, view: Any) -> None:
        """Replace what is shown."""
        self.view = view
        for name, columns in view.sources.items():
            self.sources[name].data = columns
        self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = view.x_label, view.y_label


class MapPicture(Picture):
    """A map with its bar of colours, values under the pointer, and the line of a section that a drag draws."""

    def __init__(self, view: MapView, title: str, height: int = 280):
        (width,), (tall,) = (view.sources["image"][side] for side in ("dw", "dh"))
        super().__init__(view, (int(np.clip(height * width / tall, 120, 2.2 * height)), height), title)
        self.line = ColumnDataSource({"x": [], "y": []})
        self.mapper = LinearColorMapper(palette=["#000000"], nan_color="#8888")
        for side, end in ((self.figure.x_range, width), (self.figure.y_range, tall)):
            side.update(start=0, end=end, bounds=(0, end))
        self.figure.grid.visible = False
        mapped = {"source": self.sources["image"], "color_mapper": self.mapper}
        image = self.figure.image("image", "x", "y", "dw", "dh", **mapped)
        shown = CustomJSHover(code="return value == -Infinity ? 'contact' : value.toPrecision(4)")
        tips = [("value", "@image{custom}"), ("x, y", "$x, $y")]
        self.figure.add_tools(HoverTool(renderers=[image], tooltips=tips, formatters={"@image": shown}))
        self.bar = ColorBar(color_mapper=self.mapper, width=10, padding=4, title_text_font_style="normal")
        self.figure.add_layout(self.bar, "right")
        for colour, thick in (("white", 4), (COLOURS[1], 2)):
            self.figure.line("x", "y", source=self.line, line_color=colour, line_width=thick)
        drag = CustomJS(args={"line": self.line, "fig": self.figure}, code=_DRAG)
        for event in ("panstart", "pan", "panend"):
            self.figure.js_on_event(event, drag)
        self.show(view)

    @property
    def window(self) -> tuple[float, float, float, float]:
        """The part in view: x, y, width, height (m)."""
        (x, to_x), (y, to_y) = ((own.start, own.end) for own in (self.figure.x_range, self.figure.y_range))
        return tuple(one * self.view.lengths.size for one in (x, y, to_x - x, to_y - y))

    def show(self, view: Any) -> None:
        look, unit = view.look, view.look.unit.size
        if self.view is None or self.view.look.colours != look.colours:
            self.mapper.palette = palette(look)
        black = "#010101" if look.extend == "min" else None  # contact
        self.mapper.update(low=look.low / unit, high=look.high / unit, low_color=black)
        self.bar.update(title=look.words, visible=bool(look.words))
        super().show(view)


class CurvePicture(Picture):
    """Curves of several models; those along the path have a dot on each at the state that is shown."""

    def __init__(self, view: View, size: tuple[int, int] = (380, 250)):
        path = "states" in view.sources
        super().__init__(view, size, y_axis_type="linear" if path else "log")
        drawn = {"line_color": "colour", "line_dash": "dash", "line_alpha": "alpha", "line_width": 1.6}
        self.figure.multi_line("xs", "ys", **drawn, legend_field="label", source=self.sources["lines"])
        if path:
            self.now = ColumnDataSource({"x": [], "y": [], "colour": []})
            self.figure.add_layout(Span(location=0, dimension="height", line_color="#909090", line_width=0.7))
            look = {"line_color": "colour", "fill_color": "fill", "marker": "marker", "size": 7}
            states = self.figure.scatter("x", "y", **look, source=self.sources["states"])
            self.figure.add_tools(HoverTool(renderers=[states], tooltips=[("", "@words"), ("x, y", "@x, @y")]))
            dot = {"fill_color": "colour", "line_color": "white", "line_width": 2, "size": 15}
            self.figure.scatter("x", "y", **dot, source=self.now)
        self.figure.legend.update(location="top_left" if path else "top_right", label_text_font_size="11px")
        self.figure.legend.update(background_fill_alpha=0.0, border_line_alpha=0.0)
        self.show(view)

    def show(self, view: Any) -> None:
        super().show(view)
        self.figure.legend.visible = len(set(view.sources["lines"]["label"])) > 1


class SectionPicture(Picture):
    """A section with the rigid surface below and the deformed block above."""

    def __init__(self, view: View, size: tuple[int, int] = (380, 130), title: str = "Section: drag a line on the map"):
        super().__init__(view, size, title)
        draw = {"x": "x", "source": self.sources["section"]}
        self.figure.varea(y1="floor", y2="surface", fill_color="#b0b0b0", fill_alpha=0.6, **draw)
        self.figure.line(y="surface", line_color="#808080", legend_label="rigid surface", **draw)
        self.figure.line(y="block", line_color=COLOURS[0], line_width=1.5, legend_label="block", **draw)
        self.figure.scatter(y="contact", color=COLOURS[1], size=3, legend_label="contact", **draw)
        self.figure.y_range.range_padding = 0.35  # for the legend
        self.figure.legend.update(orientation="horizontal", location="top_left", padding=2, border_line_alpha=0.0)
        self.figure.legend.update(background_fill_alpha=0.0, label_text_font_size="11px", margin=2)
        self.show(view)


def palette(look: Colouring) -> list[str]:
    """The colours of a map."""
    return [to_hex(one) for one in look.colours(np.linspace(0, 1, min(look.colours.N, 256)))]


def _columns(names: Sequence[str], rows: Sequence[tuple[Any, ...]]) -> dict[str, list[Any]]:
    return {name: [row[number] for row in rows] for number, name in enumerate(names)}


def _look(model: str, beside: Mapping[str, Any]) -> Look:
    """How a model is drawn on light and on dark ground."""
    look = look_of(model, beside)
    return replace(look, colour=_ANY_GROUND.get(look.colour, look.colour))


def _dash(look: Look) -> Any:
    return _DASHES[look.line] if isinstance(look.line, str) else [round(3 * one) for one in look.line[1]]
