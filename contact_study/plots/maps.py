"""Maps of a surface and of one state, and cuts through it: both surfaces, or a row of atoms at true proportions."""

import tomllib
from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.colors import ListedColormap, Normalize

from contact_study.plots.selection import extent, one_state, touching
from contact_study.plots.style import COLOURS, DOUBLE, axes_of, largest, length_unit, picture, pressure_unit
from contact_study.results.observables import cluster_map

_NONE, _OTHERS, _CONTACT = "#ffffff", "#9a9a9a", "#010101"
_SUBSTRATE, _BLOCK = "#b0b0b0", "#d9e6f2"
_WIDTH = 40  # lattice constants of a row of atoms that are shown
_DIAMETER = 0.9  # of a circle over the distance of neighbours
_LATERAL = ("lateral_displacement_x", "lateral_displacement_y")
ATOMS_NEED = ("normal_stress", "atom_height", *_LATERAL, "substrate_height", "site_x", "site_y")

_STATE = "One state of a simulation with its fields, such as ``dataset.sel(step=3)``."


@picture("One surface: of a simulation with its fields, or any ``height`` over ``y`` and ``x`` (m).")
def height_map(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Heights of the surface."""
    surface = one_state(dataset, "height")
    height = surface["height"].values
    unit = length_unit(float(np.abs(height).max()))
    return _map(surface, height / unit.size, axes, f"height ({unit.name})", cmap="viridis")


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
    gap = np.ma.masked_array(state["gap"].values, touching(state))
    bottom = float(state["contact_distance"])
    top = float(gap.max()) if top is None and gap.count() else top or bottom
    unit = length_unit(top)
    colours = matplotlib.colormaps["cividis"].with_extremes(bad=_CONTACT, under=_CONTACT)
    limits = {"vmin": bottom / unit.size, "vmax": (top if top > bottom else bottom + unit.size) / unit.size}
    words = f"gap ({unit.name})" + (", contact black" if gap.mask.any() else "")
    below = "min" if gap.mask.any() else "neither"
    return _map(state, gap / unit.size, axes, words, below, bar, cmap=colours, **limits)


@picture(_STATE)
def pressure_map(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Local pressure of one state: compression red, tension blue."""
    state = one_state(dataset, "pressure")
    pressure = state["pressure"].values
    most = float(np.abs(pressure).max())
    unit = pressure_unit(most)
    # A few points at contact edges carry many times what the rest does: these saturate, which the ends of the bar show.
    limit = float(np.quantile(np.abs(pressure), 0.995)) or most or 1.0
    limits: dict[str, Any] = {"vmin": -limit / unit.size, "vmax": limit / unit.size}
    extend = "both" if limit < most else "neither"
    return _map(state, pressure / unit.size, axes, f"pressure ({unit.name})", extend, cmap="RdBu_r", **limits)


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
    study = tomllib.loads(state.attrs.get("study_toml", ""))
    boundary = state.coords.get("boundary", study.get("elasticity", {}).get("boundary", "periodic"))
    clusters = cluster_map(touching(state), str(np.asarray(boundary)) == "periodic")
    coloured = min(largest, len(COLOURS))
    colours = ListedColormap([_NONE, *COLOURS[:coloured], _OTHERS])
    axes = _map(state, np.minimum(clusters, coloured + 1), axes, None, cmap=colours, vmin=-0.5, vmax=coloured + 1.5)
    share = float(state.get("relative_contact_area", np.mean(clusters > 0)))
    count = int(state.get("cluster_count", clusters.max()))
    words = "one cluster" if count == 1 else f"{count} clusters"
    mean = "mean " if "relative_contact_area_standard_error" in state else ""
    axes.set_title(f"{mean}contact area {share:.3g}, {mean}{words}", fontsize=8)
    return axes


def _map(
    state: xr.Dataset,
    field: np.ndarray,
    axes: Axes | None,
    words: str | None,
    extend: str = "neither",
    bar: Sequence[Axes] | None = (),
    **options: Any,
) -> Axes:
    """A field (y, x) at the true proportions of the cell; no words, no bar of colours."""
    axes = axes_of(axes, height=3.0)
    height, width = extent(state)
    unit = length_unit(max(height, width))
    image = axes.imshow(
        field, origin="lower", extent=(0, width / unit.size, 0, height / unit.size), interpolation="nearest", **options
    )
    axes.set(xlabel=rf"$x$ ({unit.name})", ylabel=rf"$y$ ({unit.name})")
    axes.grid(False)
    if words and bar is not None:
        axes.figure.colorbar(image, ax=bar or axes, label=words, extend=extend, aspect=25 if bar else 20)
    return axes


@picture(_STATE)
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
    across = length_unit(extent(state)[1])
    surface, block = height[row], height[row] + gap[row]
    if not np.isfinite(block).all():
        block = np.full_like(block, np.nan)  # the surfaces are separated
    ends = np.concatenate([surface, block[np.isfinite(block)]])
    along, margin = length_unit(float(np.ptp(ends))), 0.15 * float(np.ptp(ends))
    axes = axes_of(axes, DOUBLE, 2.2)
    x, surface, block = state["x"].values / across.size, surface / along.size, block / along.size
    lowest, highest = (float(ends.min()) - margin) / along.size, (float(ends.max()) + margin) / along.size
    axes.fill_between(x, lowest, surface, color=_SUBSTRATE, lw=0)
    axes.fill_between(x, block, highest, color=_BLOCK, lw=0)
    axes.plot(x, surface, color="#404040", lw=0.9, label="rigid surface")
    axes.plot(x, block, color=COLOURS[0], lw=0.9, label="block")
    axes.plot(x, np.where(contact[row], surface, np.nan), ".", color=COLOURS[1], ms=2.5, label="contact")
    axes.set(xlabel=rf"$x$ ({across.name})", ylabel=f"height ({along.name})")
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
