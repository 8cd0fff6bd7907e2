"""How far two models are apart, at every state they share."""

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.plots.selection import UNLOADING, lines, require
from contact_study.plots.style import DOUBLE, axes_of, length_unit, picture, pressure_unit

_DARK = 0.55  # of the colours' range, from which white letters read better


@picture('Group ``deviations`` of a comparison: ``xarray.open_dataset("comparison.nc", group="deviations")``.')
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
    rows = list(lines(chosen, name, "step"))
    paths = [_path(part) for _, part in rows]
    points = sorted({point for path in paths for point in path})
    values = np.full((len(rows), len(points)), np.nan)
    for row, (path, (_, part)) in enumerate(zip(paths, rows, strict=True)):
        for point, step in path.items():
            values[row, points.index(point)] = 100 * float(part[name].values[step])
    limit = float(np.nanmax(np.abs(values), initial=0.0)) or 1.0
    axes = axes_of(axes, DOUBLE, 0.9 + 0.35 * len(rows))
    colours = matplotlib.colormaps["RdBu_r"].with_extremes(bad="#eeeeee")
    image = axes.imshow(np.ma.masked_invalid(values), cmap=colours, vmin=-limit, vmax=limit, aspect="auto")
    for (row, column), value in np.ndenumerate(values):
        if np.isfinite(value):
            colour = "white" if abs(value) > _DARK * limit else "black"
            axes.annotate(f"{value:+.3g}", (column, row), ha="center", va="center", fontsize=7, color=colour)
    axes.set_yticks(range(len(rows)), [words for words, _ in rows])
    what, unit_of = ("pressure", pressure_unit) if "applied_pressure" in chosen else ("mean gap", length_unit)
    unit = unit_of(max((abs(value) for _, value in points), default=0.0))
    words = (f"{value / unit.size:.4g}" + ("\nback" if side == UNLOADING else "") for side, value in points)
    axes.set_xticks(range(len(points)), list(words))
    axes.set_xlabel(f"prescribed {what} ({unit.name})")
    axes.set_title(f"{quantity.replace('_', ' ')}: {pair}", fontsize=8)
    axes.grid(False)
    axes.figure.colorbar(image, ax=axes, label="deviation (%)")
    return axes


def _path(part: xr.Dataset) -> dict[tuple[int, float], int]:
    """Branch and prescribed value of each point of one path -> its step; another case may have other points."""
    name = "applied_pressure" if "applied_pressure" in part else "applied_gap"
    values, branch = part[name].values, part["branch"].values
    return {
        (int(side), float(value)): step
        for step, (side, value) in enumerate(zip(branch, values, strict=True))
        if np.isfinite(value)
    }
