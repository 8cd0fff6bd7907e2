"""Maps of a surface and of one state, and cuts through it: both surfaces, or a row of atoms at true proportions."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Colormap, ListedColormap, Normalize

from contact_study.numerics.grid import Grid
from contact_study.physics.surfaces.surface import Surface
from contact_study.plots.selection import along_line, extent, highest_row, is_periodic, one_state, touching
from contact_study.plots.style import COLOURS, DOUBLE, Unit, axes_of, largest, length_unit, picture, pressure_unit
from contact_study.results.observables import cluster_map

_NONE, _OTHERS, _CONTACT = "#ffffff", "#9a9a9a", "#010101"
_SUBSTRATE, _BLOCK = "#b0b0b0", "#d9e6f2"
_WIDTH = 40  # lattice constants of a row of atoms that are shown
_MOST = 1024  # points along a side of a surface that are drawn
_DIAMETER = 0.9  # of a circle over the distance of neighbours
_LATERAL = ("lateral_displacement_x", "lateral_displacement_y")
ATOMS_NEED = ("normal_stress", "atom_height", *_LATERAL, "substrate_height", "site_x", "site_y")

_STATE = "One state of a simulation with its fields, such as ``dataset.sel(step=3)``."


@dataclass(frozen=True)
class Colouring:
    """How a map colours a field: unit, ends of the colours (SI), words of their bar."""

    unit: Unit
    low: float
    high: float
    colours: Colormap
    words: str
    extend: str = "neither"

    @property
    def options(self) -> dict[str, Any]:
        """The colours as :meth:`matplotlib.axes.Axes.imshow` takes them."""
        return {"cmap": self.colours, "vmin": self.low / self.unit.size, "vmax": self.high / self.unit.size}


def height_colouring(height: np.ndarray) -> Colouring:
    """The colours of heights (m)."""
    unit = length_unit(largest(height))
    colours = matplotlib.colormaps["viridis"]
    return Colouring(unit, float(height.min()), float(height.max()), colours, f"height ({unit.name})")


def gap_colouring(gap: np.ndarray, contact: np.ndarray, bottom: float, top: float | None = None) -> Colouring:
    """The colours of gaps (m): contact black, the others from the contact distance to the top, or to the largest."""
    touches = bool(contact.any())
    top = float(gap.max(where=~contact, initial=bottom)) if top is None else top or bottom
    unit = length_unit(top)
    colours = matplotlib.colormaps["cividis"].with_extremes(bad=_CONTACT, under=_CONTACT)
    words = f"gap ({unit.name})" + (", contact black" if touches else "")
    high = top if top > bottom else bottom + unit.size
    return Colouring(unit, bottom, high, colours, words, "min" if touches else "neither")


def pressure_colouring(pressure: np.ndarray) -> Colouring:
    """The colours of pressures (Pa): compression red, tension blue."""
    most = float(np.abs(pressure).max())
    unit = pressure_unit(most)
    # A few points at contact edges carry many times what the rest does: these saturate, which the ends of the bar show.
    some = np.abs(pressure.ravel()[:: max(1, pressure.size // 2**18)])
    limit = float(np.quantile(some, 0.995)) or most or 1.0
    extend = "both" if limit < most else "neither"
    return Colouring(unit, -limit, limit, matplotlib.colormaps["RdBu_r"], f"pressure ({unit.name})", extend)


def cluster_colouring(coloured: int = len(COLOURS)) -> Colouring:
    """The colours of contact clusters by their numbers, none 0: the largest in colour, the others grey."""
    colours = ListedColormap([_NONE, *COLOURS[:coloured], _OTHERS])
    return Colouring(Unit("", 1.0), -0.5, coloured + 1.5, colours, "")


def contact_clusters(state: xr.Dataset, coloured: int = len(COLOURS)) -> tuple[np.ndarray, int]:
    """Numbers of the contact clusters, the largest 1, all beyond those coloured alike; and how many there are."""
    clusters = cluster_map(touching(state), is_periodic(state))
    return np.minimum(clusters, coloured + 1), int(clusters.max())


@picture("One surface: of a simulation with its fields, or any ``height`` over ``y`` and ``x`` (m).")
def height_map(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Heights of the surface."""
    surface = one_state(dataset, "height")
    height = surface["height"].values
    return _map(surface, height, axes, height_colouring(height))


def draw_heights(surface: Surface, grid: Grid, axes: Axes) -> None:
    """Draw the heights of a surface on a grid, some of the points of a large one."""
    (y, x), every = grid.coordinates, max(1, max(grid.shape) // _MOST)
    heights = xr.Dataset({"height": (("y", "x"), surface.heights(grid.shape))}, coords={"y": y, "x": x})
    height_map(heights.isel(y=slice(None, None, every), x=slice(None, None, every)), axes)


@picture(_STATE)
def gap_map(
    dataset: xr.Dataset, axes: Axes | None = None, top: float | None = None, bar: Sequence[Axes] | None = ()
) -> Axes:
    """Local gap of one state, contact in black.

    Parameters
    ----------
    top : float, optional
        Gap at the end of the colours (m), by default the largest of the state.
    bar : sequence of matplotlib.axes.Axes, optional
        Maps with the same colours that share the bar of colours, these axes by default; None for no bar.
    """
    state = one_state(dataset, "gap", "contact_distance")
    gap, contact = state["gap"].values, touching(state)
    look = gap_colouring(gap, contact, float(state["contact_distance"]), top)
    return _map(state, np.ma.masked_array(gap, contact), axes, look, bar)


@picture(_STATE)
def pressure_map(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Local pressure of one state: compression red, tension blue."""
    state = one_state(dataset, "pressure")
    pressure = state["pressure"].values
    return _map(state, pressure, axes, pressure_colouring(pressure))


@picture(_STATE)
def contact_map(dataset: xr.Dataset, axes: Axes | None = None, largest: int = len(COLOURS)) -> Axes:
    """Contact of one state: its largest clusters in colour, the others grey.

    Area and number of clusters are those of the dataset. Where these are means over thermal states the map shows the
    contact of the mean gap.

    Parameters
    ----------
    largest : int, optional
        How many clusters have a colour, at most six.
    """
    state = one_state(dataset, "gap", "contact_distance")
    coloured = min(largest, len(COLOURS))
    clusters, found = contact_clusters(state, coloured)
    axes = _map(state, clusters, axes, cluster_colouring(coloured), None)
    share = float(state.get("relative_contact_area", np.mean(clusters > 0)))
    count = int(state.get("cluster_count", found))
    words = "one cluster" if count == 1 else f"{count} clusters"
    mean = "mean " if "relative_contact_area_standard_error" in state else ""
    axes.set_title(f"{mean}contact area {share:.3g}, {mean}{words}", fontsize=8)
    return axes


def _map(
    state: xr.Dataset, field: np.ndarray, axes: Axes | None, look: Colouring, bar: Sequence[Axes] | None = ()
) -> Axes:
    """A field (y, x) at the true proportions of the cell; without ``bar`` no bar of colours."""
    axes = axes_of(axes, height=3.0)
    height, width = extent(state)
    unit = length_unit(max(height, width))
    ends = (0, width / unit.size, 0, height / unit.size)
    image = axes.imshow(field / look.unit.size, origin="lower", extent=ends, interpolation="nearest", **look.options)
    axes.set(xlabel=rf"$x$ ({unit.name})", ylabel=rf"$y$ ({unit.name})")
    axes.grid(False)
    if bar is not None:
        axes.figure.colorbar(image, ax=bar or axes, label=look.words, extend=look.extend, aspect=25 if bar else 20)
    return axes


@picture(_STATE)
def section(
    dataset: xr.Dataset,
    y: float | None = None,
    axes: Axes | None = None,
    ends: tuple[tuple[float, float], tuple[float, float]] | None = None,
) -> Axes:
    """Section of one state: the rigid surface below, the deformed block above, contact marked.

    Parameters
    ----------
    y : float, optional
        Where to cut along x (m), at the nearest line of points; by default through the highest point of the surface.
    ends : pair of pairs of float, optional
        Ends (y, x) of another straight line to cut along (m).
    """
    state = one_state(dataset, "gap", "height", "contact_distance")
    if ends is not None:
        x, surface, gap, contact = along_line(state, *ends)
    else:
        if y is None:
            row = highest_row(state)
        else:
            period = extent(state)[0]
            if not 0 <= y < period:
                raise ValueError(f"y = {y:g} m: outside the cell, which is {period:g} m long")
            row = int(np.abs(state["y"].values - y).argmin())
        x, surface, gap = state["x"].values, state["height"].values[row], state["gap"].values[row]
        contact = touching(state)[row]
    across = length_unit(float(x[-1]) if ends is not None else extent(state)[1])
    block = surface + gap
    if not np.isfinite(block).all():
        block = np.full_like(block, np.nan)  # the surfaces are separated
    both = np.concatenate([surface, block[np.isfinite(block)]])
    along, margin = length_unit(float(np.ptp(both))), 0.15 * float(np.ptp(both))
    axes = axes_of(axes, DOUBLE, 2.2)
    x, surface, block = x / across.size, surface / along.size, block / along.size
    lowest, highest = (float(both.min()) - margin) / along.size, (float(both.max()) + margin) / along.size
    axes.fill_between(x, lowest, surface, color=_SUBSTRATE, lw=0)
    axes.fill_between(x, block, highest, color=_BLOCK, lw=0)
    axes.plot(x, surface, color="#404040", lw=0.9, label="rigid surface")
    axes.plot(x, block, color=COLOURS[0], lw=0.9, label="block")
    axes.plot(x, np.where(contact, surface, np.nan), ".", color=COLOURS[1], ms=2.5, label="contact")
    axes.set(xlabel=rf"{'$x$' if ends is None else 'along the line'} ({across.name})", ylabel=f"height ({along.name})")
    axes.set(xlim=(x[0], x[-1]), ylim=(lowest, highest))
    axes.grid(False)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.16), ncols=3)
    return axes


@picture('One state of the atomistic model with its atoms (``output.atoms = "surface"``).')
def atoms(dataset: xr.Dataset, centre: tuple[float, float] | None = None, axes: Axes | None = None) -> Axes:
    """One row of atoms along x over the substrate's row below it: compression red, tension blue.

    Parameters
    ----------
    centre : pair of float, optional
        Where to look, y and x (m), in the nearest row; by default at the atom under the largest tension.
    """
    state = one_state(dataset, *ATOMS_NEED)
    stress, (period_y, period) = state["normal_stress"].values, extent(state)
    spacing = float(state["x"].values[1] - state["x"].values[0])
    if centre is None:
        row, column = map(int, np.unravel_index(int(stress.argmin()), stress.shape))
        middle = float(state["x"].values[column])
    else:
        row, middle = int(np.abs(_offset(state["y"].values, centre[0], period_y)).argmin()), centre[1]
    width = min(_WIDTH * spacing, period)
    sites_y, sites_x = (state[axis].values[np.isfinite(state[axis].values)] for axis in ("site_y", "site_x"))
    y = float(state["y"].values[row] + np.mean(state["lateral_displacement_y"].values[row]))
    site_row = int(np.abs(_offset(sites_y, y, period_y)).argmin())
    rows = (
        (sites_x, state["substrate_height"].values[site_row, : sites_x.size], float(sites_x[1] - sites_x[0])),
        (state["x"].values + state["lateral_displacement_x"].values[row], state["atom_height"].values[row], spacing),
    )
    unit = length_unit(width)
    axes = axes_of(axes, DOUBLE, 2.0)
    ends = []
    for x, height, diameter in rows:
        offset = _offset(x, middle, period)
        inside = np.abs(offset) <= 0.5 * width
        ends += [height[inside].min(), height[inside].max()]
        size = np.full(int(inside.sum()), _DIAMETER * diameter / unit.size)
        places = np.column_stack([middle + offset[inside], height[inside]]) / unit.size
        look: dict[str, Any] = {"linewidths": 0.3, "edgecolors": "#404040", "facecolors": _SUBSTRATE}
        where: dict[str, Any] = {"units": "xy", "offsets": places, "offset_transform": axes.transData}
        circles = EllipseCollection(size, size, np.zeros_like(size), **where, **look)
        axes.add_collection(circles)
    most = largest(stress[row][inside]) or 1.0
    pressure = pressure_unit(most)
    limit = most / pressure.size
    circles.set(array=stress[row][inside] / pressure.size, cmap="RdBu_r", norm=Normalize(-limit, limit))
    axes.set(
        xlim=((middle - 0.5 * width) / unit.size, (middle + 0.5 * width) / unit.size),
        ylim=((min(ends) - spacing) / unit.size, (max(ends) + spacing) / unit.size),
        aspect="equal",
        xlabel=rf"$x$ ({unit.name})",
        ylabel=f"height ({unit.name})",
    )
    axes.grid(False)
    place: dict[str, Any] = {"location": "top", "shrink": 0.4, "aspect": 30}
    axes.figure.colorbar(circles, ax=axes, label=f"normal stress ({pressure.name})", **place)
    return axes


def _offset(positions: np.ndarray, position: float, period: float) -> np.ndarray:
    """Offsets of the nearest periodic images from a position."""
    return (positions - position + 0.5 * period) % period - 0.5 * period
