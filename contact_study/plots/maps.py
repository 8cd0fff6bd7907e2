"""Maps of a surface and of one state: height, gap, pressure, contact."""

from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from contact_study.plots.selection import extent, is_periodic, one_state, touching
from contact_study.plots.style import COLOURS, axes_of, length_unit, picture, pressure_unit
from contact_study.results.observables.contact_map import cluster_map

_NONE, _OTHERS, _CONTACT = "#ffffff", "#9a9a9a", "#010101"


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
    largest = float(np.abs(pressure).max())
    unit = pressure_unit(largest)
    # A few points at contact edges carry many times what the rest does: these saturate, which the ends of the bar show.
    limit = float(np.quantile(np.abs(pressure), 0.995)) or largest or 1.0
    return _map(
        state,
        pressure / unit.size,
        axes,
        f"pressure ({unit.name})",
        extend="both" if limit < largest else "neither",
        cmap="RdBu_r",
        vmin=-limit / unit.size,
        vmax=limit / unit.size,
    )


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
    clusters = cluster_map(touching(state), is_periodic(state))
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
