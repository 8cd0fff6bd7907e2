"""What changes along the loading path: contact area, mean gap, the work that a cycle costs."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from scipy.integrate import trapezoid

from contact_study.plots.selection import LOADING, UNLOADING, lines, require
from contact_study.plots.style import COLOURS, axes_of, styled
from contact_study.plots.units import length_unit, pressure_unit


@styled
def contact_area(dataset: xr.Dataset, axes: Axes | None = None, scale: str = "linear") -> Axes:
    """Relative contact area over pressure, a line for each point of the sweep; unloading hollow.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of any model.
    axes : matplotlib.axes.Axes, optional
        Where to draw.
    scale : {"linear", "symlog", "log"}, optional
        Of the pressure. Logarithms of both signs beyond the smallest pressure ("symlog") show tension, too; "log"
        shows both axes so, and no tension.

    Raises
    ------
    ValueError
        If the dataset has no contact area, or the scale is unknown.
    """
    pressure = pressure_unit(_largest(dataset, "mean_pressure"))
    axes = _along_the_path(
        dataset,
        axes,
        lambda part: (part["mean_pressure"].values / pressure.size, part["relative_contact_area"].values),
        "relative_contact_area",
    )
    axes.set(xlabel=rf"pressure $p$ ({pressure.name})", ylabel=r"contact area $A/A_0$")
    _scale_pressure(dataset, axes, scale, pressure.size)
    if scale == "log":
        axes.set_yscale("log")
    else:
        axes.set_ylim(0, None)
    return axes


@styled
def mean_gap(dataset: xr.Dataset, axes: Axes | None = None, scale: str = "linear") -> Axes:
    """Mean gap over pressure; parameters and errors as :func:`contact_area`, but the gap's axis stays linear."""
    pressure = pressure_unit(_largest(dataset, "mean_pressure"))
    gap = length_unit(_largest(dataset, "mean_gap"))
    axes = _along_the_path(
        dataset,
        axes,
        lambda part: (part["mean_pressure"].values / pressure.size, part["mean_gap"].values / gap.size),
        "mean_gap",
    )
    axes.set(xlabel=rf"pressure $p$ ({pressure.name})", ylabel=rf"mean gap $\bar{{u}}$ ({gap.name})")
    _scale_pressure(dataset, axes, scale, pressure.size)
    return axes


@styled
def hysteresis_loop(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Pressure over mean separation while loading and unloading, with the energy that the cycle dissipates.

    The energy is :func:`dissipated_energy`, shaded.

    Parameters
    ----------
    dataset : xarray.Dataset
        One point of the sweep of a simulation, loaded and unloaded.
    axes : matplotlib.axes.Axes, optional
        Where to draw.

    Raises
    ------
    ValueError
        As :func:`dissipated_energy`.
    """
    loop = _loop(dataset)
    pressure = pressure_unit(_largest(dataset, "mean_pressure"))
    length = length_unit(_largest(dataset, "mean_separation"))
    axes = axes_of(axes)
    words = f"{loop.energy:.3g} J/m² dissipated"
    forth, back = (np.interp(loop.shared, *branch) for branch in (loop.loading, loop.unloading))
    options: dict[str, Any] = {"color": COLOURS[0], "alpha": 0.15, "lw": 0, "label": words}
    if loop.prescribed == "mean_pressure":
        axes.fill_betweenx(loop.shared / pressure.size, back / length.size, forth / length.size, **options)
    else:
        axes.fill_between(loop.shared / length.size, back / pressure.size, forth / pressure.size, **options)
    for branch, filled, words in ((loop.loading, True, "loading"), (loop.unloading, False, "unloading")):
        along, separation = branch if loop.prescribed == "mean_pressure" else branch[::-1]
        axes.plot(
            separation / length.size,
            along / pressure.size,
            "o-",
            color=COLOURS[0],
            ms=3.2,
            mfc=COLOURS[0] if filled else "white",
            label=words,
        )
    axes.axhline(0, color="#909090", lw=0.7, zorder=1)
    axes.set(xlabel=f"mean separation ({length.name})", ylabel=rf"pressure $p$ ({pressure.name})")
    axes.legend()
    return axes


def dissipated_energy(dataset: xr.Dataset) -> float:
    """Energy per area that a cycle between the ends of both branches dissipates (J/m²).

    ∫(ū_loading − ū_unloading) dp where the pressure is prescribed, ∫(p_loading − p_unloading) dū where the gap is, over
    what both branches pass; by trapezoids through the points of the path: as exact as these are dense where the contact
    jumps.

    Parameters
    ----------
    dataset : xarray.Dataset
        One point of the sweep of a simulation, loaded and unloaded.

    Raises
    ------
    ValueError
        If there is more than one point of the sweep, no unloading, or nothing that both branches pass.
    """
    return _loop(dataset).energy


_Branch = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class _Loop:
    """Both branches over what was prescribed, increasing, and the energy between them."""

    prescribed: str
    loading: _Branch
    unloading: _Branch
    shared: np.ndarray
    energy: float


def _loop(dataset: xr.Dataset) -> _Loop:
    require(dataset, "mean_pressure", "mean_separation", "branch")
    names = ["mean_pressure", "mean_separation"]
    prescribed, answer = names[::-1] if "applied_gap" in dataset else names
    part = dataset.squeeze()
    others = [dim for dim in part["mean_pressure"].dims if dim != "step"]
    if others:
        raise ValueError(f"the dataset has more than one cycle: select one along {others[0]!r} first")
    fit = _fit(part) & np.isfinite(part["mean_separation"].values)
    side, along, response = part["branch"].values, part[prescribed].values, part[answer].values
    turn = np.flatnonzero(fit & (side == LOADING))[-1:]  # where unloading begins
    loading, unloading = (
        _sorted(along[here], response[here])
        for here in (
            np.flatnonzero(fit & (side == LOADING)),
            np.concatenate([turn, np.flatnonzero(fit & (side == UNLOADING))]),
        )
    )
    if loading[0].size < 2 or unloading[0].size < 3:
        raise ValueError("the dataset has no cycle: loading.unload = true makes one")
    low, high = max(loading[0][0], unloading[0][0]), min(loading[0][-1], unloading[0][-1])
    if low >= high:
        raise ValueError("loading and unloading share no part of the path")
    every = np.unique(np.concatenate([loading[0], unloading[0]]))
    shared = every[(every >= low) & (every <= high)]
    width = np.interp(shared, *loading) - np.interp(shared, *unloading)
    return _Loop(prescribed, loading, unloading, shared, float(trapezoid(width, shared)))


def _sorted(along: np.ndarray, response: np.ndarray) -> _Branch:
    order = np.argsort(along, kind="stable")
    return along[order], response[order]


def _along_the_path(dataset: xr.Dataset, axes: Axes | None, read: Callable[[xr.Dataset], _Branch], name: str) -> Axes:
    require(dataset, "mean_pressure", name)
    axes = axes_of(axes)
    hollow = False
    for number, (words, part) in enumerate(lines(dataset, name, "step")):
        x, y = read(part)
        fit = _fit(part) & np.isfinite(x) & np.isfinite(y)
        if not fit.any():
            continue
        colour = COLOURS[number % len(COLOURS)]
        axes.plot(x[fit], y[fit], "-", color=colour, lw=0.9)
        back = fit & (part["branch"].values == UNLOADING) if "branch" in part else np.zeros_like(fit)
        axes.plot(x[fit & ~back], y[fit & ~back], "o", color=colour, ms=3.2, label=words or None)
        if back.any():
            hollow = True
            axes.plot(x[back], y[back], "o", color=colour, mfc="white", ms=3.2)
    if hollow:
        axes.plot([], [], "o", color="#404040", mfc="white", ms=3.2, label="unloading")
    if axes.get_legend_handles_labels()[1]:
        axes.legend()
    return axes


def _scale_pressure(dataset: xr.Dataset, axes: Axes, scale: str, unit: float) -> None:
    if scale not in ("linear", "symlog", "log"):
        raise ValueError(f"scale = {scale!r}: must be 'linear', 'symlog' or 'log'")
    pressure = dataset["mean_pressure"].values[_fit(dataset)] / unit
    if scale == "symlog" and pressure.any():
        least = float(np.abs(pressure[pressure != 0]).min())
        axes.set_xscale("symlog", linthresh=least, linscale=0.4)
        decades = 10.0 ** np.arange(np.ceil(np.log10(least)), np.log10(np.abs(pressure).max()) + 1e-9)
        axes.set_xticks(np.concatenate([-decades[decades <= -pressure.min()][::-1], [0.0], decades]))
        axes.set_xticks([], minor=True)
    elif scale == "log":
        axes.set_xscale("log")


def _fit(part: xr.Dataset) -> np.ndarray:
    """Which points have converged in contact."""
    fit = np.isfinite(part["mean_pressure"].values)
    for name, wanted in (("converged", 1), ("detached", 0)):
        if name in part:
            fit &= part[name].broadcast_like(part["mean_pressure"]).values == wanted
    return fit


def _largest(dataset: xr.Dataset, name: str) -> float:
    require(dataset, name)
    values = np.abs(dataset[name].values)
    return float(values[np.isfinite(values)].max(initial=0.0))
