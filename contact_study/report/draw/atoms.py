"""Figure of the atoms of one state."""

import xarray as xr
from matplotlib.figure import Figure

from contact_study import plots
from contact_study.plots.style import DOUBLE, styled
from contact_study.report.draw.style import typeset


@styled
def atoms_figure(state: xr.Dataset, words: str = "") -> Figure:
    """Section through the bottom layer's atoms over the substrate's sites, where tension is largest."""
    figure = Figure(figsize=(DOUBLE, 2.2), layout="constrained")
    plots.atoms(state, axes=figure.subplots())
    if words:
        figure.suptitle(typeset(words), fontsize=8.5)
    return figure
