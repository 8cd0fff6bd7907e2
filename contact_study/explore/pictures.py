"""Pictures of a page: Bokeh figures whose data are replaced from state to state, in the browser or on a server.

A map travels on as many cells as a screen has, never point by point. Colours and units are those of
:mod:`contact_study.plots`; ink and ground are the page's (CSS variables of Bokeh).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from bokeh.models import ColorBar, ColumnDataSource, CustomJS, CustomJSHover, HoverTool, LinearColorMapper, Span
from bokeh.plotting import figure as bokeh_figure
from matplotlib import colormaps
from matplotlib.colors import to_hex

from contact_study.explore.selection import LoadPath, Model, difference, field_of, load_path, reduced
from contact_study.plots import maps, style
from contact_study.plots.curves import PATHS
from contact_study.plots.densities import DENSITIES, LEAST
from contact_study.plots.force_curves import force_states, force_unit
from contact_study.plots.maps import Colouring
from contact_study.plots.measured_curves import measured_states
from contact_study.plots.selection import along_line, extent, highest_row, touching
from contact_study.plots.style import COLOURS, Unit
from contact_study.report.models import look_of

CELLS = 480  # of a map along a side, at most: what a screen shows
FORCE = "force"
CURVES = {"relative_contact_area": "Contact area", "mean_gap": "Mean gap", FORCE: "Force curve"}
"""Curves along the path, and their titles."""
# Bokeh draws with these properties of the page around it.
INK = """:host { --ink: var(--panel-on-background-color, #1b1e23); --bk-background-fill-color: transparent;
  --bk-border-fill-color: transparent; --bk-title-text-color: var(--ink); --bk-axis-label-text-color: var(--ink);
  --bk-major-label-text-color: var(--ink); --bk-label-text-color: var(--ink); --bk-axis-line-color: var(--ink);
  --bk-major-tick-line-color: var(--ink); --bk-outline-line-color: #8888; --bk-grid-line-color: #8883; }"""
_DASHES = {"-": "solid", "--": "dashed", ":": "dotted", "-.": "dotdash", "none": "solid"}
_MARKERS = {"s": "square", "o": "circle", "^": "triangle", "D": "diamond", "P": "plus", "": "dot"}
_SYMBOLS = {r"\bar{u}": "ū", r"\sigma": "σ", "A_0": "A₀", "$": ""}
_SHARE = Colouring(Unit("", 1.0), 0.0, 1.0, colormaps["gray_r"], "contact, share of a cell")
_TOOLS = "box_zoom,wheel_zoom,pan,reset,save"
_DRAG = """
if (fig.toolbar.gestures.pan.active || fig.toolbar.gestures.rect?.active) return
const start = this.origin, here = [cb_obj.x, cb_obj.y], now = Date.now()
if (cb_obj.event_name == "panstart") { this.origin = here; this.last = 0; return }
if (!start || (cb_obj.event_name == "pan" && now - this.last < 80)) return
this.last = now
line.data = {x: [start[0], here[0]], y: [start[1], here[1]]}
"""


def plain(words: str) -> str:
    """Words of an axis without mathematical typesetting."""
    for typeset, symbol in _SYMBOLS.items():
        words = words.replace(typeset, symbol)
    return words


@dataclass(frozen=True)
class MapView:
    """A field as it travels to the screen: cells (y, x) in a unit, NaN in contact, and the window that they fill."""

    cells: np.ndarray
    window: tuple[float, float, float, float]  # x, y, width, height in the unit of lengths
    lengths: Unit
    look: Colouring

    @property
    def source(self) -> dict[str, list[Any]]:
        """Columns of the image."""
        x, y, width, height = self.window
        return {"image": [self.cells], "x": [x], "y": [y], "dw": [width], "dh": [height]}


def map_view(
    state: xr.Dataset,
    name: str,
    held: tuple[float, float] | None = None,
    window: tuple[float, float, float, float] | None = None,
    minus: xr.Dataset | None = None,
    cells: int = CELLS,
) -> MapView:
    """A field of a state, or its difference to another state ``minus``, as a map.

    ``held`` are the ends of the colours (SI), by default of the state; ``window`` is the part to show: x, y, width,
    height (m).
    """
    patches = name == "clusters" and minus is None
    if minus is not None:
        name = "contact" if name == "clusters" else name
        field = difference(state, minus, name)
        limit = style.largest(field) or 1.0
        units = {"pressure": style.pressure_unit, "contact": lambda _: Unit("", 1.0)}
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
    (height, width), (ny, nx) = extent(state), field.shape
    x, y, dx, dy = window or (0.0, 0.0, width, height)
    columns = slice(*np.clip([int(x / width * nx), int(np.ceil((x + dx) / width * nx))], 0, nx))
    rows = slice(*np.clip([int(y / height * ny), int(np.ceil((y + dy) / height * ny))], 0, ny))
    shape = (cells, cells)
    if patches:  # the largest patch of a cell, not a mean of numbers
        values = reduced(np.where(field == 0, 99, field)[rows, columns], shape, np.minimum)
        values = np.where(values == 99, 0, values)
    else:
        values = reduced(field[rows, columns], shape) / look.unit.size
    if name == "gap" and minus is None:
        share = reduced(touching(state)[rows, columns].astype(np.float32), shape)
        values = np.where(share >= 0.5, np.nan, values)
    if held is not None:
        look = Colouring(look.unit, *held, look.colours, look.words, "both")
    lengths = style.length_unit(max(height, width))
    ends = [columns.start * width / nx, rows.start * height / ny]
    ends += [(columns.stop - columns.start) * width / nx, (rows.stop - rows.start) * height / ny]
    x, y, dx, dy = (end / lengths.size for end in ends)
    return MapView(values.astype(np.float32), (x, y, dx, dy), lengths, look)


class MapPicture:
    """A map with its bar of colours, values under the pointer, and the line of a section that a drag draws."""

    def __init__(self, view: MapView, title: str, height: int = 300):
        self.source, self.line = ColumnDataSource(view.source), ColumnDataSource({"x": [], "y": []})
        self.mapper, self.lengths = LinearColorMapper(palette=["#000000"], nan_color="#010101"), view.lengths
        _, _, width, tall = view.window
        size = {"frame_height": height, "frame_width": int(np.clip(height * width / tall, 120, 2.2 * height))}
        self.figure = bokeh_figure(**size, tools=_TOOLS, toolbar_location="above", active_drag=None, title=title)
        self.figure.x_range.update(start=0, end=width, bounds=(0, width))
        self.figure.y_range.update(start=0, end=tall, bounds=(0, tall))
        self.figure.grid.visible = False
        image = self.figure.image("image", "x", "y", "dw", "dh", source=self.source, color_mapper=self.mapper)
        self.hover = CustomJSHover(code="return isNaN(value) ? 'contact' : value.toPrecision(4)")
        tips = HoverTool(renderers=[image], tooltips=[("value", "@image{custom}"), ("x, y", "$x, $y")])
        tips.formatters = {"@image": self.hover}
        self.figure.add_tools(tips)
        self.bar = ColorBar(color_mapper=self.mapper, width=10, padding=4, bar_line_color=None)
        self.figure.add_layout(self.bar, "right")
        self.figure.line("x", "y", source=self.line, line_color="white", line_width=4, line_alpha=0.8)
        self.figure.line("x", "y", source=self.line, line_color=COLOURS[1], line_width=2)
        drag = CustomJS(args={"line": self.line, "fig": self.figure}, code=_DRAG)
        for event in ("panstart", "pan", "panend"):
            self.figure.js_on_event(event, drag)
        self.show(view)

    @property
    def window(self) -> tuple[float, float, float, float]:
        """The part in view: x, y, width, height (m)."""
        (x, to_x), (y, to_y) = ((own.start, own.end) for own in (self.figure.x_range, self.figure.y_range))
        size = self.lengths.size
        return x * size, y * size, (to_x - x) * size, (to_y - y) * size

    def show(self, view: MapView) -> None:
        """Replace what is shown."""
        colours = view.look.colours
        levels = np.linspace(0, 1, min(colours.N, 256))
        unit = view.look.unit.size
        self.mapper.update(
            palette=[to_hex(one) for one in colours(levels)], low=view.look.low / unit, high=view.look.high / unit
        )
        self.bar.update(title=view.look.words, visible=bool(view.look.words))
        for axis, name in zip(self.figure.axis, "xy", strict=True):
            axis.axis_label = f"{name} ({view.lengths.name})"
        self.source.data = view.source


@dataclass(frozen=True)
class CurveView:
    """Curves along the path of several models: columns of lines and of states, and the words of the axes."""

    lines: dict[str, list[Any]]
    points: dict[str, Any]
    x_label: str
    y_label: str

    def at(self, places: Mapping[str, int]) -> dict[str, list[Any]]:
        """Columns of the states that are shown, a place on the path for each model."""
        points = self.points
        pairs = zip(points["model"], points["place"], strict=True)
        chosen = [n for n, (model, place) in enumerate(pairs) if places.get(model) == place]
        return {name: [points[name][n] for n in chosen] for name in ("x", "y", "colour")}

    def span(self, axis: str) -> float:
        """Length of an axis that shows all states."""
        return float(np.ptp(self.points[axis])) or 1.0


def curve_view(cases: Mapping[str, xr.Dataset], kind: str, measured: Sequence[xr.Dataset] = ()) -> CurveView | None:
    """Curves of the cases of models by their names; None where no model has such a curve."""
    need = ("total_force", "displacement") if kind == FORCE else ("mean_pressure", kind)
    shown = {name: case for name, case in cases.items() if all(one in case for one in need)}
    others = [measured_states(one, "displacement") for one in measured] if kind == FORCE else []
    if not shown and not others:
        return None
    x_name, y_name = ("displacement", "total_force") if kind == FORCE else ("mean_pressure", kind)
    across = style.largest(np.concatenate([*(np.ravel(c[x_name]) for c in shown.values()), *(o.x for o in others)]))
    upward = np.concatenate([*(np.ravel(case[y_name]) for case in shown.values()), *(o.force for o in others)])
    along = style.length_unit(across) if kind == FORCE else style.pressure_unit(across)
    no_unit = Unit("", 1.0)
    up = force_unit(style.largest(upward)) if kind == FORCE else no_unit
    up = style.length_unit(style.largest(upward)) if kind == "mean_gap" else up
    lines: dict[str, list[Any]] = {name: [] for name in ("xs", "ys", "colour", "dash", "alpha", "label")}
    points: dict[str, list[Any]] = {
        name: [] for name in ("x", "y", "colour", "fill", "marker", "model", "place", "words")
    }
    for name, case in shown.items():
        look, path = look_of(name, shown), load_path(case)
        dash = _DASHES[look.line] if isinstance(look.line, str) else [round(3 * one) for one in look.line[1]]
        x, y = (np.where(path.fit, case[one].values[path.steps], np.nan) for one in (x_name, y_name))
        if kind == FORCE:
            all_x, all_y, back = force_states(case)
        else:
            all_x, all_y, back = x, y, path.unloading
        for side, alpha in ((~back, 1.0), (back | np.append(back[1:], False), 0.5)):
            if side.any():
                own = (look.colour, dash, alpha, look.label)
                drawn = all_x[side] / along.size, all_y[side] / up.size
                for column, value in zip(lines, (*drawn, *own), strict=True):
                    lines[column].append(value)
        for place in np.flatnonzero(np.isfinite(x) & np.isfinite(y)):
            way = bool(path.unloading[place])
            marker = "inverted_triangle" if way else _MARKERS[look.marker]
            fill = "white" if way or look.hollow else look.colour
            own_point = (look.colour, fill, marker, name, int(place), f"{look.label}: {path.words[place]}")
            values = (float(x[place] / along.size), float(y[place] / up.size), *own_point)
            for column, value in zip(points, values, strict=True):
                points[column].append(value)
    for number, other in enumerate(others):
        colour = COLOURS[(len(shown) + 1 + number) % len(COLOURS)]
        own = (colour, "dotted", 1.0, other.title or "measured")
        for column, value in zip(lines, (other.x / along.size, other.force / up.size, *own), strict=True):
            lines[column].append(value)
    x_label = f"{'displacement δ' if kind == FORCE else 'pressure p'} ({along.name})"
    y_label = "force F" if kind == FORCE else plain(PATHS[kind])
    return CurveView(lines, points, x_label, f"{y_label} ({up.name})" if up.name else y_label)


def density_view(cases: Mapping[str, xr.Dataset], steps: Mapping[str, int], of: str) -> CurveView | None:
    """Distributions of pressure or gap of one state of each model; None where no model has one."""
    unit_of, symbol, density = DENSITIES[of]
    name, bins = f"{of}_pdf", f"{of}_bin"
    shown = {model: case for model, case in cases.items() if name in case and np.nansum(case[name].values) > 0}
    if not shown:
        return None
    seen = {}
    for model, case in shown.items():  # the unit is that of the whole path: axes do not jump
        pdf = np.nan_to_num(case[name].values)
        seen[model] = style.largest(case[bins].values[(pdf > LEAST * pdf.max()).any(axis=0)])
    unit = unit_of(max(seen.values()))
    lines: dict[str, list[Any]] = {name: [] for name in ("xs", "ys", "colour", "dash", "alpha", "label")}
    for model, case in shown.items():
        look, pdf = look_of(model, shown), case[name].isel(step=steps[model]).values
        there = pdf > LEAST * style.largest(pdf)
        dash = _DASHES[look.line] if isinstance(look.line, str) else [round(3 * one) for one in look.line[1]]
        drawn = case[bins].values[there] / unit.size, pdf[there] * unit.size
        for column, value in zip(lines, (*drawn, look.colour, dash, 1.0, look.label), strict=True):
            lines[column].append(value)
    return CurveView(lines, {}, f"{plain(symbol)} ({unit.name})", f"{plain(density)} (1/{unit.name})".replace("\\", ""))


class CurvePicture:
    """Curves of several models, with a dot on each at the state that is shown."""

    def __init__(self, view: CurveView, title: str, log: bool = False, width: int = 420, height: int = 250):
        self.lines, self.points = ColumnDataSource(view.lines), ColumnDataSource(view.points)
        self.now = ColumnDataSource({"x": [], "y": [], "colour": []})
        size = {"frame_width": width, "frame_height": height, "y_axis_type": "log" if log else "linear"}
        self.figure = bokeh_figure(**size, tools=_TOOLS, toolbar_location="above", active_drag=None, title=title)
        drawn = {"line_color": "colour", "line_dash": "dash", "line_alpha": "alpha", "line_width": 1.6}
        self.figure.multi_line("xs", "ys", **drawn, legend_field="label", source=self.lines)
        if view.points:
            self.figure.add_layout(Span(location=0, dimension="height", line_color="#909090", line_width=0.7))
            look = {"line_color": "colour", "fill_color": "fill", "marker": "marker", "size": 7}
            states = self.figure.scatter("x", "y", **look, source=self.points)
            self.figure.add_tools(HoverTool(renderers=[states], tooltips=[("", "@words"), ("x, y", "@x, @y")]))
            self.figure.scatter(
                "x", "y", fill_color="colour", line_color="white", line_width=2, size=15, source=self.now
            )
        self.figure.legend.update(location="top_left" if not log else "top_right", label_text_font_size="11px")
        self.show(view)

    def show(self, view: CurveView) -> None:
        """Replace what is shown."""
        self.view, self.lines.data = view, view.lines
        if view.points:
            self.points.data = view.points
        self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = view.x_label, view.y_label


@dataclass(frozen=True)
class SectionView:
    """Both surfaces along a line: columns in units."""

    columns: dict[str, np.ndarray]
    x_label: str
    y_label: str


def section_view(state: xr.Dataset, ends: tuple[tuple[float, float], tuple[float, float]] | None = None) -> SectionView:
    """A section between two points (y, x) of a state, by default along x through the highest point of the surface."""
    if ends is None:
        y, across = float(state["y"].values[highest_row(state)]), extent(state)[1]
        ends = (y, 0.0), (y, across * (1 - 1 / state.sizes["x"]))
    x, surface, gap, contact = along_line(state, *ends)
    thin = max(1, x.size // (2 * CELLS))
    x, surface, block, contact = (one[::thin] for one in (x, surface, surface + gap, contact))
    block = np.where(np.isfinite(block), block, np.nan)
    along, up = (
        style.length_unit(float(x[-1])),
        style.length_unit(float(np.ptp([surface.min(), np.nanmax([*surface, *block])]))),
    )
    columns = {"x": x / along.size, "surface": surface / up.size, "block": block / up.size}
    columns |= {
        "contact": np.where(contact, surface, np.nan) / up.size,
        "floor": np.full(x.size, surface.min() / up.size),
    }
    return SectionView(columns, f"along the line ({along.name})", f"height ({up.name})")


class SectionPicture:
    """A section with the rigid surface below and the deformed block above."""

    def __init__(self, view: SectionView, width: int = 420, height: int = 140):
        self.source = ColumnDataSource(view.columns)
        size = {"frame_width": width, "frame_height": height}
        self.figure = bokeh_figure(
            **size, tools=_TOOLS, toolbar_location="above", active_drag=None, title="Section: drag a line on the map"
        )
        draw = {"x": "x", "source": self.source}
        self.figure.varea(y1="floor", y2="surface", fill_color="#b0b0b0", **draw)
        self.figure.line(y="surface", line_color="#606060", legend_label="rigid surface", **draw)
        self.figure.line(y="block", line_color=COLOURS[0], line_width=1.5, legend_label="block", **draw)
        self.figure.scatter(y="contact", color=COLOURS[1], size=3, legend_label="contact", **draw)
        self.figure.legend.update(orientation="horizontal", location="top_right", label_text_font_size="11px")
        self.show(view)

    def show(self, view: SectionView) -> None:
        """Replace what is shown."""
        self.source.data = view.columns
        self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = view.x_label, view.y_label


def in_words(model: Model, case: xr.Dataset, path: LoadPath, place: int) -> str:
    """One state in a line of text, for everyone and for readers of screens."""
    from contact_study.inputs.units import length

    step = int(path.steps[place])
    words = [f"{model.entry.label}, {path.words[place]}"]
    if "relative_contact_area" in case:
        words.append(f"contact area {float(case['relative_contact_area'][step]):.3g} A₀")
    if "mean_gap" in case and np.isfinite(gap := float(case["mean_gap"][step])):
        words.append(f"mean gap {'−' if gap < 0 else ''}{length(abs(gap))}")
    if not path.fit[place]:
        words.append("not converged, or detached")
    return " · ".join(words)
