"""A cut through the interface: both surfaces, and where they touch."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.plots.selection import extent, one_state, touching
from contact_study.plots.style import COLOURS, DOUBLE, axes_of, length_unit, picture

_SUBSTRATE, _BLOCK = "#b0b0b0", "#d9e6f2"


@picture("One state of a simulation with its fields, such as ``dataset.sel(step=3)``.")
def section(dataset: xr.Dataset, y: float | None = None, axes: Axes | None = None) -> Axes:
    """Section along x of one state: the rigid surface below, the deformed block above, contact marked.

    Parameters
    ----------
    y : float, optional
        Where to cut (m), at the nearest line of points; by default through the highest point of the surface.
    """
    state = one_state(dataset, "gap", "height", "contact_distance")
    height, gap, contact = state["height"].values, state["gap"].values, touching(state)
    if y is None:
        row = int(np.unravel_index(height.argmax(), height.shape)[0])
    else:
        period = extent(state)[0]
        if not 0 <= y < period:
            raise ValueError(f"y = {y:g} m: outside the cell, which is {period:g} m long")
        row = int(np.abs(state["y"].values - y).argmin())
    x = state["x"].values
    across = length_unit(extent(state)[1])
    surface, block = height[row], height[row] + gap[row]
    if not np.isfinite(block).all():
        block = np.full_like(block, np.nan)  # the surfaces are separated
    ends = np.concatenate([surface, block[np.isfinite(block)]])
    along = length_unit(float(np.ptp(ends)))
    margin = 0.15 * float(np.ptp(ends))
    axes = axes_of(axes, DOUBLE, 2.2)
    x, surface, block = x / across.size, surface / along.size, block / along.size
    lowest, highest = (float(ends.min()) - margin) / along.size, (float(ends.max()) + margin) / along.size
    axes.fill_between(x, lowest, surface, color=_SUBSTRATE, lw=0)
    axes.fill_between(x, block, highest, color=_BLOCK, lw=0)
    axes.plot(x, surface, color="#404040", lw=0.9, label="rigid surface")
    axes.plot(x, block, color=COLOURS[0], lw=0.9, label="block")
    marked = np.where(contact[row], surface, np.nan)
    axes.plot(x, marked, ".", color=COLOURS[1], ms=2.5, label="contact")
    axes.set(
        xlim=(x[0], x[-1]), ylim=(lowest, highest), xlabel=rf"$x$ ({across.name})", ylabel=f"height ({along.name})"
    )
    axes.grid(False)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.16), ncols=3)
    return axes
