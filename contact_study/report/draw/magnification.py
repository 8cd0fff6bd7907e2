"""Figure of the theories' dataset alone: what one says of every magnification."""

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_study import plots
from contact_study.plots.style import DOUBLE, styled
from contact_study.report.draw.legends import panel_heading
from contact_study.report.draw.style import typeset


@styled
def magnification_figure(states: xr.Dataset, mapped: xr.Dataset, words: str = "", named: str = "") -> Figure:
    """Area (a), detachment stress (b) and work of adhesion (c) of the states, P(σ, ζ) of one (d) if it was kept.

    Parameters
    ----------
    states, mapped : xarray.Dataset
        As :func:`~contact_study.report.compute.magnification.read_magnification` gives them.
    words, named : str, optional
        What the states share, and which one is mapped.
    """
    with_map = "pressure_pdf_at" in mapped
    figure = Figure(figsize=(DOUBLE, 5.2 if with_map else 2.7), layout="constrained")
    panels: dict[str, Axes] = figure.subplot_mosaic([["a", "b"], ["c", "d"]] if with_map else [["a", "b", "c"]])
    plots.area_by_magnification(states, panels["a"])
    plots.detachment_stress(states, panels["b"])
    plots.effective_work_of_adhesion(states, panels["c"])
    for letter in "abc":
        legend = panels[letter].get_legend()
        if legend is not None and letter != "a":
            legend.remove()
        elif legend is not None:
            for text in legend.get_texts():
                text.set_text(typeset(text.get_text()))
    if with_map:
        plots.stress_by_magnification(mapped, panels["d"])
    for letter, axes in panels.items():
        panel_heading(axes, letter, {"a": words, "d": named}.get(letter, ""))
    return figure
