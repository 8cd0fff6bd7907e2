"""Cuts through the interface: both surfaces where they touch, and a row of atoms at their true proportions."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Normalize

from contact_study.plots.selection import extent, one_state, touching
from contact_study.plots.style import COLOURS, DOUBLE, axes_of, length_unit, picture, pressure_unit

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


_WIDTH = 40  # lattice constants that are shown across
_DIAMETER = 0.9  # of a circle over the distance of neighbours
NEEDED = (
    "normal_stress",
    "atom_height",
    "lateral_displacement_x",
    "lateral_displacement_y",
    "substrate_height",
    "site_x",
    "site_y",
)


@picture('One state of the atomistic model with its atoms (``output.atoms = "surface"``).')
def atoms(dataset: xr.Dataset, centre: tuple[float, float] | None = None, axes: Axes | None = None) -> Axes:
    """One row of atoms along x over the substrate's row below it: compression red, tension blue.

    Parameters
    ----------
    centre : pair of float, optional
        Where to look, y and x (m), in the nearest row; by default at the atom under the largest tension.
    """
    state = one_state(dataset, *NEEDED)
    stress, (period_y, period) = state["normal_stress"].values, extent(state)
    spacing = float(state["x"].values[1] - state["x"].values[0])
    if centre is None:
        row, column = map(int, np.unravel_index(int(stress.argmin()), stress.shape))
        middle = float(state["x"].values[column])
    else:
        row, middle = int(_distance(state["y"].values, centre[0], period_y).argmin()), centre[1]
    width = min(_WIDTH * spacing, period)
    sites_y, sites_x = (state[axis].values[np.isfinite(state[axis].values)] for axis in ("site_y", "site_x"))
    y = float(state["y"].values[row] + np.mean(state["lateral_displacement_y"].values[row]))
    site_row = int(_distance(sites_y, y, period_y).argmin())
    rows = (
        (sites_x, state["substrate_height"].values[site_row, : sites_x.size], float(sites_x[1] - sites_x[0])),
        (state["x"].values + state["lateral_displacement_x"].values[row], state["atom_height"].values[row], spacing),
    )
    unit = length_unit(width)
    axes = axes_of(axes, DOUBLE, 2.0)
    ends = []
    for x, height, diameter in rows:
        offset = (x - middle + 0.5 * period) % period - 0.5 * period  # of the nearest periodic image
        inside = np.abs(offset) <= 0.5 * width
        ends += [height[inside].min(), height[inside].max()]
        size = np.full(int(inside.sum()), _DIAMETER * diameter / unit.size)
        circles = EllipseCollection(
            size,
            size,
            np.zeros_like(size),
            units="xy",
            offsets=np.column_stack([middle + offset[inside], height[inside]]) / unit.size,
            offset_transform=axes.transData,
            linewidths=0.3,
            edgecolors="#404040",
            facecolors=_SUBSTRATE,
        )
        axes.add_collection(circles)
    largest = float(np.abs(stress[row][inside]).max()) or 1.0
    pressure = pressure_unit(largest)
    limit = largest / pressure.size
    circles.set(array=stress[row][inside] / pressure.size, cmap="RdBu_r", norm=Normalize(-limit, limit))
    axes.set(
        xlim=((middle - 0.5 * width) / unit.size, (middle + 0.5 * width) / unit.size),
        ylim=((min(ends) - spacing) / unit.size, (max(ends) + spacing) / unit.size),
        aspect="equal",
        xlabel=rf"$x$ ({unit.name})",
        ylabel=f"height ({unit.name})",
    )
    axes.grid(False)
    axes.figure.colorbar(
        circles, ax=axes, label=f"normal stress ({pressure.name})", location="top", shrink=0.4, aspect=30
    )
    return axes


def _distance(positions: np.ndarray, position: float, period: float) -> np.ndarray:
    """Distances from a position to the nearest periodic images of others."""
    return np.abs((positions - position + 0.5 * period) % period - 0.5 * period)
