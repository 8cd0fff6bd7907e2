"""Figures of one state, of pictures that ``contact_study.plots`` draws."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_study import plots
from contact_study.plots.selection import extent
from contact_study.plots.style import DOUBLE, SINGLE, styled
from contact_study.report.figures.legends import panel_heading
from contact_study.report.figures.style import typeset
from contact_study.report.models import entry_of

_FRAME, _BAR = 0.75, 0.95  # inches around a map, and for the bar of colours


@styled
def gap_map_figure(states: Mapping[str, xr.Dataset], words: str = "") -> Figure:
    """Local gap of each simulation in one state, contact in black, at the true proportions of the cell.

    Parameters
    ----------
    states : mapping
        Gap and contact distance (m) on the cell, by the name of the model's entry.
    words : str
        The state.
    """
    height, width = extent(next(iter(states.values())))
    rows, columns, across = _arrangement(len(states), height / width)
    size = columns * across + _FRAME + _BAR, max(rows * (across * height / width + 0.25) + _FRAME, 2.2)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    top = max(float(state["gap"].max()) for state in states.values())
    for axes, (model, state) in zip(panels.ravel(), states.items(), strict=True):
        plots.gap_map(state, axes, top=top, bar=list(panels.ravel()) if axes is panels[-1, -1] else None)
        axes.set_title(entry_of(model).label, fontsize=8.5)
        axes.label_outer()
    if words:
        figure.suptitle(typeset(words), fontsize=8.5)
    return figure


def _arrangement(count: int, aspect: float) -> tuple[int, int, float]:
    """Rows and columns of the maps and the width of one (inches): side by side, wide cells above one another."""
    if count > 1 and aspect < 0.5:
        return count, 1, DOUBLE - _FRAME - _BAR
    across = DOUBLE if count > 1 else SINGLE + 1.2
    return 1, count, min((across - _FRAME - _BAR) / count, 5.5 / aspect)


@styled
def interface_figure(state: xr.Dataset, words: str = "") -> Figure:
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
def atoms_figure(state: xr.Dataset, words: str = "") -> Figure:
    """Section through the bottom layer's atoms over the substrate's sites, where tension is largest."""
    figure = Figure(figsize=(DOUBLE, 2.2), layout="constrained")
    plots.atoms(state, axes=figure.subplots())
    if words:
        figure.suptitle(typeset(words), fontsize=8.5)
    return figure


@styled
def magnification_figure(states: xr.Dataset, mapped: xr.Dataset, words: str = "", named: str = "") -> Figure:
    """Area (a), detachment stress (b) and work of adhesion (c) of the states, P(σ, ζ) of one (d) if it was kept."""
    with_map = "pressure_pdf_at" in mapped
    figure = Figure(figsize=(DOUBLE, 5.2 if with_map else 2.7), layout="constrained")
    panels: dict[str, Axes] = figure.subplot_mosaic([["a", "b"], ["c", "d"]] if with_map else [["a", "b", "c"]])
    plots.area_by_magnification(states, panels["a"])
    plots.detachment_stress(states, panels["b"])
    plots.effective_work_of_adhesion(states, panels["c"])
    legends = {letter: panels[letter].get_legend() for letter in "abc"}
    for letter, legend in legends.items():
        if legend is not None and letter != "a":
            legend.remove()
        for text in legend.get_texts() if legend is not None else ():
            text.set_text(typeset(text.get_text()))
    if with_map:
        plots.stress_by_magnification(mapped, panels["d"])
    for letter, axes in panels.items():
        panel_heading(axes, letter, {"a": words, "d": named}.get(letter, ""))
    return figure
