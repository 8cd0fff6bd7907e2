"""Curves along the loading path: contact area and mean gap."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.plots.paths import Curve, Look, draw_path
from contact_study.plots.selection import UNLOADING, fit_states, largest, lines, require
from contact_study.plots.style import COLOURS, Unit, add_legend, axes_of, length_unit, picture, pressure_unit


@picture("Of any model.")
def contact_area(dataset: xr.Dataset, axes: Axes | None = None, scale: str = "linear") -> Axes:
    """Relative contact area over pressure, a line for each point of the sweep; unloading hollow.

    Parameters
    ----------
    scale : {"linear", "symlog", "log"}, optional
        Of the pressure. Logarithms of both signs beyond the smallest pressure ("symlog") show tension, too; "log"
        shows both axes so, and no tension.
    """
    pressure = pressure_unit(largest(dataset, "mean_pressure"))
    axes = _along_the_path(dataset, axes, "relative_contact_area", pressure, 1.0)
    axes.set(xlabel=rf"pressure $p$ ({pressure.name})", ylabel=r"contact area $A/A_0$")
    _scale_pressure(dataset, axes, scale, pressure.size)
    if scale == "log":
        axes.set_yscale("log")
    else:
        axes.set_ylim(0, None)
    return axes


@picture("Of any model.")
def mean_gap(dataset: xr.Dataset, axes: Axes | None = None, scale: str = "linear") -> Axes:
    """Mean gap over pressure, a line for each point of the sweep; unloading hollow.

    Parameters
    ----------
    scale : {"linear", "symlog", "log"}, optional
        Of the pressure, as of :func:`contact_area`.
    """
    pressure = pressure_unit(largest(dataset, "mean_pressure"))
    gap = length_unit(largest(dataset, "mean_gap"))
    axes = _along_the_path(dataset, axes, "mean_gap", pressure, gap.size)
    axes.set(xlabel=rf"pressure $p$ ({pressure.name})", ylabel=rf"mean gap $\bar{{u}}$ ({gap.name})")
    _scale_pressure(dataset, axes, scale, pressure.size)
    return axes


def _along_the_path(dataset: xr.Dataset, axes: Axes | None, name: str, pressure: Unit, unit: float) -> Axes:
    require(dataset, "mean_pressure", name)
    axes = axes_of(axes)
    hollow = False
    for number, (words, part) in enumerate(lines(dataset, name, "step")):
        x, y = part["mean_pressure"].values / pressure.size, part[name].values / unit
        back = part["branch"].values == UNLOADING if "branch" in part else np.zeros(x.shape, bool)
        curve = Curve("", words, number, np.where(fit_states(part), x, np.nan), y, unloading=back)
        if curve.finite.any():
            draw_path(axes, curve, Look(), COLOURS[number % len(COLOURS)], words)
            hollow |= bool(back[curve.finite].any())
    if hollow:
        axes.plot([], [], "v", color="#404040", mfc="white", ms=6.2, label="unloading")
    add_legend(axes)
    return axes


def _scale_pressure(dataset: xr.Dataset, axes: Axes, scale: str, unit: float) -> None:
    if scale not in ("linear", "symlog", "log"):
        raise ValueError(f"scale = {scale!r}: must be 'linear', 'symlog' or 'log'")
    pressure = dataset["mean_pressure"].values[fit_states(dataset)] / unit
    if scale == "symlog" and pressure.any():
        least = float(np.abs(pressure[pressure != 0]).min())
        axes.set_xscale("symlog", linthresh=least, linscale=0.4)
        decades = 10.0 ** np.arange(np.ceil(np.log10(least)), np.log10(np.abs(pressure).max()) + 1e-9)
        axes.set_xticks(np.concatenate([-decades[decades <= -pressure.min()][::-1], [0.0], decades]))
        axes.set_xticks([], minor=True)
    elif scale == "log":
        axes.set_xscale("log")
