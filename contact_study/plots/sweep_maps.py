"""Maps over the points of a sweep: how far two models are apart, and contacts among the criteria of sticking."""

import itertools
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.physics.process_zone import DMT_LIKE, JKR_LIKE
from contact_study.plots import style
from contact_study.plots.selection import UNLOADING, label, lines, require
from contact_study.plots.style import COLOURS, DOUBLE, axes_of, picture

_DARK = 0.55  # of the colours of deviations, from which white letters read better

# Of a criterion: its variable, its name, its marker, and whether it was made for large Tabor parameters.
_CRITERIA = (
    ("persson_tosatti_ratio", "Persson and Tosatti", "s", True),
    ("pastewka_robbins_ratio", "Pastewka and Robbins", "^", False),
    ("dmt_tension_ratio", "DMT tension", "D", False),
    ("bearing_area_ratio", "bearing-area model", "o", False),
)
_BESIDE: dict[str, Any] = {"textcoords": "offset points", "ha": "right", "fontsize": 6.5}


@picture("Of the theories, every point of its sweep a column, or ``theory.stickiness(...).to_dataset()``.")
def criteria_map(dataset: xr.Dataset, axes: Axes | None = None, name: str = "") -> Axes:
    """Work of adhesion over the one that each criterion of sticking requires, against the Tabor parameter.

    Above the line a contact sticks by the criterion. A marker is filled where the criterion was made for such a Tabor
    parameter, Persson and Tosatti's above one, the others below. Several datasets go onto one map by one call each.

    Parameters
    ----------
    name : str, optional
        What the columns are called, before the point of the sweep.
    """
    require(dataset, "finest_tabor_number", *(variable for variable, *_ in _CRITERIA))
    first = axes is None or not axes.has_data()
    axes = axes_of(axes, DOUBLE * 0.7, 3.4)
    if first:
        _draw_regions(axes)
    numbers = xr.broadcast(*(dataset[known] for known in ("finest_tabor_number", *(c[0] for c in _CRITERIA))))
    dims = [str(dim) for dim in numbers[0].dims]
    for place in itertools.product(*(range(numbers[0].sizes[dim]) for dim in dims)):
        at = dict(zip(dims, place, strict=True))
        tabor, *ratios = (float(values.isel(at)) for values in numbers)
        if not np.isfinite(tabor):
            continue
        axes.plot([tabor, tabor], [min(ratios), max(ratios)], "-", color="#909090", lw=0.8, zorder=2)
        for number, (ratio, (_, _, marker, large)) in enumerate(zip(ratios, _CRITERIA, strict=True)):
            fill = COLOURS[number] if (tabor > 1) == large else "white"
            axes.plot(tabor, ratio, marker, color=COLOURS[number], mfc=fill, ms=5.5, mew=1.1, zorder=3)
        words = [label(dataset[dim], dataset[dim].values[k]) for dim, k in at.items() if dim in dataset.coords]
        column = "\n".join(filter(None, (name, *words)))
        # Beside it: above it the next column's line may run through.
        axes.annotate(column, (tabor, max(ratios)), xytext=(-5, 0), va="center", **_BESIDE)
    # A margin about every column, and one at least of each limit's region in view.
    points = np.concatenate([line.get_xydata() for line in axes.lines if line.get_linestyle() == "-"][1:])
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set_xlim(min(0.2 * low[0], 0.5 * DMT_LIKE), max(2 * high[0], 2 * JKR_LIKE))
    axes.set_ylim(min(0.5 * low[1], 0.5), max(6 * high[1], 2))
    for axis in (axes.xaxis, axes.yaxis):
        style.plain_decades(axis, False)
    return axes


def _draw_regions(axes: Axes) -> None:
    axes.set(xscale="log", xlabel=r"Tabor parameter of the finest roughness $\mu$")
    axes.set(yscale="log", ylabel=r"$\Delta\gamma$ over that which sticks")
    axes.axhline(1, color="#404040", lw=0.9, zorder=1)
    regions = ("DMT-like", 0.02, "left", (1e-12, DMT_LIKE)), ("JKR-like", 0.98, "right", (JKR_LIKE, 1e12))
    for words, x, side, ends in regions:
        axes.axvspan(*ends, color="#f2f2f2", lw=0, zorder=0, gid="limit")
        axes.text(x, 0.97, words, transform=axes.transAxes, ha=side, va="top", fontsize=6.5, color="#606060")
    axes.annotate("sticks", (0.99, 1), xycoords=("axes fraction", "data"), xytext=(0, 3), color="#606060", **_BESIDE)
    for number, (_, words, marker, _) in enumerate(_CRITERIA):
        axes.plot([], [], marker, color=COLOURS[number], ms=5.5, label=words)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))


@picture(
    "Group ``deviations`` of a comparison.",
    'xr.open_dataset("comparison.nc", group="deviations"), "continuum - atomistic"',
)
def deviations(
    dataset: xr.Dataset, pair: str, quantity: str = "relative_contact_area", axes: Axes | None = None
) -> Axes:
    """Relative deviation of one model from another as a map, in per cent: the sweep upwards, the path across.

    Parameters
    ----------
    pair : str
        A value of its coordinate ``pair``, such as ``"continuum - atomistic"``.
    quantity : str, optional
        ``"relative_contact_area"``, ``"mean_gap"`` or ``"elastic_energy"``.
    """
    name = f"{quantity}_relative_deviation"
    require(dataset, name)
    pairs = [str(value) for value in dataset["pair"].values]
    if pair not in pairs:
        raise ValueError(f"pair = {pair!r}: the dataset has {', '.join(pairs)}")
    chosen = dataset.sel(pair=pair)
    what = next(what for what in ("pressure", "gap", "approach") if f"applied_{what}" in chosen.coords)
    unit_of = style.pressure_unit if what == "pressure" else style.length_unit
    rows = []
    for words, part in lines(chosen, name, "step"):  # another case may have other points of the path
        own = zip(*(part[each].values for each in ("branch", f"applied_{what}", name)), strict=True)
        rows.append((words, {(int(side), float(at)): 100 * float(value) for side, at, value in own if np.isfinite(at)}))
    points = sorted({point for _, row in rows for point in row})
    values = np.array([[row.get(point, np.nan) for point in points] for _, row in rows])
    limit = style.largest(values) or 1.0
    axes = axes_of(axes, DOUBLE, 0.9 + 0.35 * len(rows))
    colours = matplotlib.colormaps["RdBu_r"].with_extremes(bad="#eeeeee")
    image = axes.imshow(np.ma.masked_invalid(values), cmap=colours, vmin=-limit, vmax=limit, aspect="auto")
    for (row, column), value in np.ndenumerate(values):
        if np.isfinite(value):
            colour = "white" if abs(value) > _DARK * limit else "black"
            axes.annotate(f"{value:+.3g}", (column, row), ha="center", va="center", fontsize=7, color=colour)
    axes.set_yticks(range(len(rows)), [words for words, _ in rows])
    unit = unit_of(max((abs(value) for _, value in points), default=0.0))
    ticks = [f"{value / unit.size:.4g}" + ("\nback" if side == UNLOADING else "") for side, value in points]
    axes.set_xticks(range(len(points)), ticks)
    axes.set_xlabel(f"prescribed {'mean ' * (what == 'gap')}{what} ({unit.name})")
    axes.set_title(f"{quantity.replace('_', ' ')}: {pair}", fontsize=8)
    axes.grid(False)
    axes.figure.colorbar(image, ax=axes, label="deviation (%)")
    return axes
