"""How far two models are apart, at every state they share."""

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.plots.selection import UNLOADING, lines, require
from contact_study.plots.style import DOUBLE, axes_of, largest, length_unit, picture, pressure_unit

_DARK = 0.55  # of the colours' range, from which white letters read better


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
    unit_of = pressure_unit if what == "pressure" else length_unit
    rows = []
    for words, part in lines(chosen, name, "step"):  # another case may have other points of the path
        own = zip(*(part[each].values for each in ("branch", f"applied_{what}", name)), strict=True)
        rows.append((words, {(int(side), float(at)): 100 * float(value) for side, at, value in own if np.isfinite(at)}))
    points = sorted({point for _, row in rows for point in row})
    values = np.array([[row.get(point, np.nan) for point in points] for _, row in rows])
    limit = largest(values) or 1.0
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
