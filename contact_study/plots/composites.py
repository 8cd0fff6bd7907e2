"""Figures of one state, composed of the pictures of this package."""

from collections.abc import Callable, Mapping

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_study import plots
from contact_study.plots.panels import panel_heading, typeset
from contact_study.plots.selection import extent
from contact_study.plots.style import DOUBLE, SINGLE, styled

_FRAME, _BAR = 0.75, 0.95  # inches around a map, and for the bar of colours


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
