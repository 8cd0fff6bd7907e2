"""Curves along the loading path: contact area, mean gap, and the loop of loading and unloading with its loss."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from scipy.integrate import trapezoid

from contact_study.plots.paths import Curve, Look, draw_path
from contact_study.plots.selection import LOADING, UNLOADING, fit_states, largest, lines, require
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


# Of the rectangle about a loop; less than this of it is neither energy nor to be seen.
_SEEN = 1e-5

_Branch = tuple[np.ndarray, np.ndarray]


@picture("One point of the sweep of a simulation, loaded and unloaded.")
def hysteresis_loop(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Pressure over mean separation while loading and unloading, with the energy that the cycle dissipates.

    The energy is :func:`dissipated_energy`, shaded. Jump-in and pull-off are marked where the dataset has them, and the
    work of separation is named. Where the steps of the path were its own, all states they passed are shown.
    """
    loop = _loop(dataset)
    pressure = pressure_unit(largest(dataset, "mean_pressure"))
    length = length_unit(largest(dataset, "mean_separation"))
    axes = axes_of(axes)
    forth, back = (np.interp(loop.shared, *branch) for branch in (loop.loading, loop.unloading))
    # Two equal branches differ by the tolerance of their states, of either sign.
    seen = abs(loop.energy) > _SEEN * np.ptp(loop.shared) * np.ptp([forth, back])
    words = f"{loop.energy:.3g} J/m² dissipated" if seen else "0 J/m² dissipated: reversible within rounding"
    options: dict[str, Any] = {"color": COLOURS[0], "alpha": 0.15, "lw": 0, "label": words}
    if loop.prescribed == "mean_pressure":
        axes.fill_betweenx(loop.shared / pressure.size, back / length.size, forth / length.size, **options)
    else:
        axes.fill_between(loop.shared / length.size, back / pressure.size, forth / pressure.size, **options)
    looks = (loop.loading, "o-", COLOURS[0], "loading"), (loop.unloading, "v--", "white", "unloading")
    for branch, look, fill, words in looks:
        held, at = branch if loop.prescribed == "mean_pressure" else branch[::-1]
        axes.plot(at / length.size, held / pressure.size, look, color=COLOURS[0], ms=3.2, mfc=fill, label=words)
    for words, marker, (where, load) in _marks(dataset, loop):
        axes.plot(where / length.size, load / pressure.size, marker, color=COLOURS[1], ms=6, zorder=4, label=words)
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
    return _loop(dataset).energy


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
    part = dataset.squeeze()
    others = [dim for dim in part["mean_pressure"].dims if dim != "step"]
    if others:
        raise ValueError(f"the dataset has more than one cycle: select one along {others[0]!r} first")
    held = "applied_gap" in dataset or "applied_approach" in dataset
    pressure, separation, turn = _passed(part) if "passed_pressure" in part else _points(part)
    along, response = (separation, pressure) if held else (pressure, separation)
    loading, unloading = (
        _sorted(along[branch], response[branch]) for branch in (slice(turn + 1), slice(turn, along.size))
    )
    if loading[0].size < 2 or unloading[0].size < 3:
        raise ValueError("the dataset has no cycle: loading.unload = true makes one")
    low, high = max(loading[0][0], unloading[0][0]), min(loading[0][-1], unloading[0][-1])
    if low >= high:
        raise ValueError("loading and unloading share no part of the path")
    every = np.unique(np.concatenate([loading[0], unloading[0]]))
    shared = every[(every >= low) & (every <= high)]
    width = np.interp(shared, *loading) - np.interp(shared, *unloading)
    prescribed = "mean_separation" if held else "mean_pressure"
    return _Loop(prescribed, loading, unloading, shared, float(trapezoid(width, shared)))


def _points(part: xr.Dataset) -> tuple[np.ndarray, np.ndarray, int]:
    """Pressure and separation at the points of the path in contact, and where unloading begins."""
    separation = part["mean_separation"].values
    fit = np.flatnonzero(fit_states(part) & np.isfinite(separation))
    fit = fit[np.isin(part["branch"].values[fit], (LOADING, UNLOADING))]
    turn = int(np.count_nonzero(part["branch"].values[fit] == LOADING)) - 1
    return part["mean_pressure"].values[fit], separation[fit], max(turn, 0)


def _passed(part: xr.Dataset) -> tuple[np.ndarray, np.ndarray, int]:
    """Pressure and separation of all states passed before the surfaces came apart, and where retraction begins."""
    pressure, separation = part["passed_pressure"].values.ravel(), part["passed_separation"].values.ravel()
    fit = np.isfinite(pressure) & np.isfinite(separation)
    back = np.repeat(part["branch"].values == UNLOADING, part.sizes["passed"])[fit]
    # What relaxes may still come nearer on its way back.
    turn = int(np.argmax(back)) - 1 if back.any() else int(np.argmin(separation[fit]))
    return pressure[fit], separation[fit], max(turn, 0)


def _sorted(along: np.ndarray, response: np.ndarray) -> _Branch:
    order = np.argsort(along, kind="stable")
    return along[order], response[order]


def _marks(dataset: xr.Dataset, loop: _Loop) -> list[tuple[str, str, tuple[float, float]]]:
    """Words, marker, separation and pressure of the events of adhesion along the path."""
    found = []
    if "jump_in_pressure" in dataset:
        at = float(dataset["jump_in_separation"].squeeze()), float(dataset["jump_in_pressure"].squeeze())
        found.append(("jump-in", "^", at))
    if "pull_off_pressure" in dataset:
        pulled = float(dataset["pull_off_pressure"].squeeze())
        along, response = loop.unloading
        pressure, separation = (along, response) if loop.prescribed == "mean_pressure" else (response, along)
        words = "pull-off"
        if "work_of_separation" in dataset:
            words += f", {float(dataset['work_of_separation'].squeeze()):.3g} J/m² of work to separate"
        found.append((words, "v", (float(separation[np.argmin(np.abs(pressure - pulled))]), pulled)))
    return [mark for mark in found if np.isfinite(mark[2]).all()]
