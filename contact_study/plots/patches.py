"""Sizes of contact patches, and the leakage between them."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.plots import style
from contact_study.plots.selection import fit_states, lines, require
from contact_study.plots.style import COLOURS, axes_of, picture


@picture("Of a simulation.")
def patch_sizes(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Number density of contact patches over their area, a line for each state: select those to be shown."""
    require(dataset, "patch_size_density")
    axes = axes_of(axes)
    area = dataset["relative_patch_area"].values
    for number, (words, part) in enumerate(lines(dataset.squeeze(), "patch_size_density", "relative_patch_area")):
        density = part["patch_size_density"].values
        drawn = np.where(density > 0, density, np.nan)
        axes.loglog(area, drawn, ".-", color=COLOURS[number % len(COLOURS)], ms=4, lw=1.0, label=words or None)
    axes.set(xlabel="area of a patch / area of the cell", ylabel="patches per relative area")
    style.add_legend(axes)
    return axes


@picture("Of a simulation with ``output.leakage``.")
def leakage(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Hydraulic gap along x (full line) and y (dashed) over the contact area, a colour for each point of the sweep.

    A vertical line marks the area at which the gap stops percolating, where the path has it.
    """
    require(dataset, "hydraulic_gap_x", "hydraulic_gap_y", "relative_contact_area")
    unit = style.length_unit(style.largest(dataset["hydraulic_gap_x"]))
    axes = axes_of(axes)
    for number, (words, part) in enumerate(lines(dataset, "hydraulic_gap_x", "step")):
        colour, fit = COLOURS[number % len(COLOURS)], fit_states(part)
        for axis, look in (("x", "o-"), ("y", "o--")):
            gap = part[f"hydraulic_gap_{axis}"].values / unit.size
            open_ = fit & np.isfinite(gap) & (gap > 0)
            area, label = part["relative_contact_area"].values, f"{words}, along {axis}".lstrip(", ")
            axes.semilogy(area[open_], gap[open_], look, color=colour, ms=3, lw=1.0, label=label)
        if "percolation_area" in part and np.isfinite(part["percolation_area"]):
            named = f"{words}, closed".lstrip(", ")
            axes.axvline(float(part["percolation_area"]), color=colour, lw=0.7, ls=":", label=named)
    axes.set(xlabel=r"contact area $A/A_0$", ylabel=f"hydraulic gap ({unit.name})")
    style.add_legend(axes)
    return axes
