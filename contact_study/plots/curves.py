"""Curves along the loading path: contact area, mean gap, and the loop of loading and unloading with its loss."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.plots import style
from contact_study.plots.paths import Curve, Look, draw_path
from contact_study.plots.selection import LOADING, UNLOADING, fit_states, lines, require, single
from contact_study.plots.style import COLOURS, Unit, axes_of, picture
from contact_study.plots.uncertainty import bands

PATHS = {"relative_contact_area": r"contact area $A/A_0$", "mean_gap": r"mean gap $\bar{u}$"}
"""Quantities that are drawn over the pressure, with their words."""


@picture("Of any model.")
def contact_area(dataset: xr.Dataset, axes: Axes | None = None, scale: str = "linear") -> Axes:
    """Relative contact area over pressure, a line for each point of the sweep, a band for draws; unloading hollow.

    Parameters
    ----------
    scale : {"linear", "symlog", "log"}, optional
        Of the pressure. Logarithms of both signs beyond the smallest pressure ("symlog") show tension, too; "log"
        shows both axes so, and no tension.
    """
    axes = _along_the_path(dataset, axes, "relative_contact_area", scale)
    if scale == "log":
        axes.set_yscale("log")
    else:
        axes.set_ylim(0, None)
    return axes


@picture("Of any model.")
def mean_gap(dataset: xr.Dataset, axes: Axes | None = None, scale: str = "linear") -> Axes:
    """Mean gap over pressure, a line for each point of the sweep, a band for draws; unloading hollow.

    Parameters
    ----------
    scale : {"linear", "symlog", "log"}, optional
        Of the pressure, as of :func:`contact_area`.
    """
    return _along_the_path(dataset, axes, "mean_gap", scale)


def _along_the_path(dataset: xr.Dataset, axes: Axes | None, name: str, scale: str) -> Axes:
    if "draw" in dataset.dims or "quantile" in dataset.dims:
        return bands(dataset, axes_of(axes), name)
    require(dataset, "mean_pressure", name)
    pressure = style.pressure_unit(style.largest(dataset["mean_pressure"]))
    unit = style.length_unit(style.largest(dataset[name])) if name == "mean_gap" else Unit("", 1.0)
    axes = axes_of(axes)
    hollow = False
    for number, (words, part) in enumerate(lines(dataset, name, "step")):
        x, y = part["mean_pressure"].values / pressure.size, part[name].values / unit.size
        back = part["branch"].values == UNLOADING if "branch" in part else np.zeros(x.shape, bool)
        curve = Curve("", words, number, np.where(fit_states(part), x, np.nan), y, unloading=back)
        if curve.finite.any():
            draw_path(axes, curve, Look(), COLOURS[number % len(COLOURS)], words)
            hollow |= bool(back[curve.finite].any())
    if hollow:
        axes.plot([], [], "v", color="#404040", mfc="white", ms=6.2, label="unloading")
    style.add_legend(axes)
    ylabel = f"{PATHS[name]} ({unit.name})" if unit.name else PATHS[name]
    axes.set(xlabel=rf"pressure $p$ ({pressure.name})", ylabel=ylabel)
    shown = dataset["mean_pressure"].values[fit_states(dataset)] / pressure.size
    if scale not in ("linear", "symlog", "log"):
        raise ValueError(f"scale = {scale!r}: must be 'linear', 'symlog' or 'log'")
    if scale == "symlog" and shown.any():
        least = float(np.abs(shown[shown != 0]).min())
        axes.set_xscale("symlog", linthresh=least, linscale=0.4)
        decades = 10.0 ** np.arange(np.ceil(np.log10(least)), np.log10(np.abs(shown).max()) + 1e-9)
        axes.set_xticks(np.concatenate([-decades[decades <= -shown.min()][::-1], [0.0], decades]))
        axes.set_xticks([], minor=True)
    elif scale == "log":
        axes.set_xscale("log")
    return axes


_PRESSURE, _SEPARATION = 0, 1  # rows of a branch
_SEEN = 1e-5  # of the rectangle about a loop: less is neither energy nor to be seen


@picture("One point of the sweep of a simulation, loaded and unloaded.")
def hysteresis_loop(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Pressure over mean separation while loading and unloading, with the energy that the cycle dissipates.

    The energy is :func:`dissipated_energy`, shaded. Jump-in and pull-off are marked where the dataset has them, and the
    work of separation is named. Where the steps of the path were its own, all states they passed are shown.
    """
    prescribed, (loading, unloading), (shared, forth, back) = _loop(dataset)
    energy = _enclosed(shared, forth, back)
    pressure = style.pressure_unit(style.largest(dataset["mean_pressure"]))
    length = style.length_unit(style.largest(dataset["mean_separation"]))
    axes = axes_of(axes)
    # Two equal branches differ by the tolerance of their states, of either sign.
    seen = abs(energy) > _SEEN * np.ptp(shared) * np.ptp([forth, back])
    words = f"{energy:.3g} J/m² dissipated" if seen else "0 J/m² dissipated: reversible within rounding"
    upright = prescribed == _PRESSURE
    along, across = (pressure.size, length.size) if upright else (length.size, pressure.size)
    shade: Any = axes.fill_betweenx if upright else axes.fill_between
    shade(shared / along, back / across, forth / across, color=COLOURS[0], alpha=0.15, lw=0, label=words)
    looks = (loading, "o-", COLOURS[0], "loading"), (unloading, "v--", "white", "unloading")
    for (load, where), look, fill, words in looks:
        axes.plot(where / length.size, load / pressure.size, look, color=COLOURS[0], ms=3.2, mfc=fill, label=words)
    results = ("jump_in_pressure", "jump_in_separation", "pull_off_pressure", "work_of_separation")
    known = {name: float(dataset[name].squeeze()) for name in results if name in dataset}
    marks = []
    if "jump_in_pressure" in known:
        marks.append(("jump-in", "^", known["jump_in_separation"], known["jump_in_pressure"]))
    if "pull_off_pressure" in known:
        load, where = unloading
        nearest = where[np.argmin(np.abs(load - known["pull_off_pressure"]))]
        work = f", {known['work_of_separation']:.3g} J/m² of work to separate" if "work_of_separation" in known else ""
        marks.append((f"pull-off{work}", "v", nearest, known["pull_off_pressure"]))
    for words, marker, at, pulled in marks:
        if np.isfinite([at, pulled]).all():
            axes.plot(at / length.size, pulled / pressure.size, marker, color=COLOURS[1], ms=6, zorder=4, label=words)
    axes.axhline(0, color="#909090", lw=0.7, zorder=1)
    axes.set(xlabel=f"mean separation ({length.name})", ylabel=rf"pressure $p$ ({pressure.name})")
    axes.legend()
    return axes


def dissipated_energy(dataset: xr.Dataset) -> float:
    """Energy per area that a cycle between the ends of both branches dissipates (J/m²).

    ∫(ū_loading − ū_unloading) dp where the pressure is prescribed, ∫(p_loading − p_unloading) dū where a distance is,
    over what both branches pass; by trapezoids through the points of the path, or all that steps of its own passed:
    as exact as these are dense where the contact jumps. Raises ValueError if there is more than one point of the sweep,
    no unloading, or nothing that both branches pass.
    """
    return _enclosed(*_loop(dataset)[-1])


def _enclosed(shared: np.ndarray, forth: np.ndarray, back: np.ndarray) -> float:
    from scipy.integrate import trapezoid  # slow to import

    return float(trapezoid(forth - back, shared))


def _loop(dataset: xr.Dataset) -> tuple[int, list[np.ndarray], list[np.ndarray]]:
    """Return what was prescribed, both branches, rows of pressure and separation in its order, and what both pass.

    That is the part of the prescribed one that they share, and the other one along it, forth and back.
    """
    require(dataset, "mean_pressure", "mean_separation", "branch")
    part = dataset.squeeze([dim for dim, size in dataset.sizes.items() if size == 1 and dim != "passed"])
    single(part, "mean_pressure", ("step",), "cycle")
    branch = part["branch"].values
    if "passed_pressure" in part:  # all states passed before the surfaces came apart
        states = np.stack([part[f"passed_{name}"].values.ravel() for name in ("pressure", "separation")])
        fit = np.isfinite(states).all(axis=0)
        back = np.repeat(branch == UNLOADING, part.sizes["passed"])[fit]
        # What relaxes may still come nearer on its way back.
        turn = int(np.argmax(back)) - 1 if back.any() else int(np.argmin(states[_SEPARATION, fit]))
    else:
        states = np.stack([part[f"mean_{name}"].values for name in ("pressure", "separation")])
        fit = fit_states(part) & np.isfinite(states[_SEPARATION]) & np.isin(branch, (LOADING, UNLOADING))
        turn = int(np.count_nonzero(branch[fit] == LOADING)) - 1
    states, turn = states[:, fit], max(turn, 0)
    prescribed = _SEPARATION if "applied_gap" in dataset or "applied_approach" in dataset else _PRESSURE
    both = states[:, : turn + 1], states[:, turn:]
    loading, unloading = branches = [own[:, np.argsort(own[prescribed], kind="stable")] for own in both]
    if loading.shape[1] < 2 or unloading.shape[1] < 3:
        raise ValueError("the dataset has no cycle: loading.unload = true makes one")
    one, other = loading[prescribed], unloading[prescribed]
    low, high = max(one[0], other[0]), min(one[-1], other[-1])
    if low >= high:
        raise ValueError("loading and unloading share no part of the path")
    every = np.unique(np.concatenate([one, other]))
    shared = every[(every >= low) & (every <= high)]
    return (
        prescribed,
        branches,
        [shared, *(np.interp(shared, own[prescribed], own[1 - prescribed]) for own in branches)],
    )
