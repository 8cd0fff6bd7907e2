"""Figure of one dataset alone: its interface at one state."""

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_study import plots
from contact_study.plots.style import DOUBLE, styled
from contact_study.report.draw.legends import panel_heading


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
