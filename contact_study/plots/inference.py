"""Result of an inference: measured points with fitted lines, residuals, and profiles of the likelihood."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_study.plots import style
from contact_study.plots.measured_curves import MeasuredStates, draw_measured
from contact_study.plots.selection import require
from contact_study.plots.style import COLOURS, DOUBLE, Unit, force_unit, styled

_NEGLIGIBLE = 1e-3  # evidence of a model whose residuals and profiles are not drawn
_TOP = 2.5  # of the threshold: to which profiles are drawn
_LOOKS = ("-", "--", "-.", ":")
_SYMBOLS = {
    "work_of_adhesion": ("$w$", "J/m²"),
    "contact_modulus": ("$E^*$", "Pa"),
    "radius": ("$R$", "m"),
    "range": ("range", "m"),
    "force_scale": ("force scale", ""),
}
_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"))


@styled
def inference(dataset: xr.Dataset) -> Figure:
    """Draw measured points with the fitted models, residuals, and the profile of each parameter.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of :func:`contact_study.infer`.

    Returns
    -------
    matplotlib.figure.Figure
        A new figure.

    Raises
    ------
    ValueError
        If the dataset is of something else.

    Examples
    --------
    >>> plots.inference(contact_study.infer("curve.csv", fixed={"radius": "5 um"}))  # doctest: +SKIP
    """
    require(dataset, "residual", "fitted_force", "bic")
    if "model" not in dataset["bic"].dims:
        raise ValueError('the dataset has no dimension "model": select one model as a list, dataset.sel(model=["jkr"])')
    names = [name for name in _SYMBOLS if f"{name}_profile" in dataset]
    figure = Figure(figsize=(DOUBLE, 4.2 if len(names) < 3 else 1.35 * len(names) + 0.3), layout="constrained")
    parts: Any = figure.subfigures(1, 2, width_ratios=(1.9, 1))
    left, right = parts
    curve, residuals = left.subplots(2, 1, height_ratios=(2.6, 1), sharex=True)
    order = np.argsort(dataset["bic"].values)
    shown = [int(at) for at in order if dataset["weight"].values[at] >= _NEGLIGIBLE]
    _draw_curve(curve, residuals, dataset, order.tolist(), shown)
    for axes, name in zip(np.atleast_1d(right.subplots(max(len(names), 1), 1)), names, strict=False):
        _draw_profile(axes, dataset, name, shown)
    return figure


def _look(at: int) -> dict[str, Any]:
    return {"color": COLOURS[(at + 1) % len(COLOURS)], "ls": _LOOKS[at % len(_LOOKS)]}


def _draw_curve(curve: Axes, residuals: Axes, dataset: xr.Dataset, order: list[int], shown: list[int]) -> None:
    against = "displacement" if np.isfinite(dataset["displacement"]).any() else "contact_radius"
    length = style.length_unit(style.largest(dataset[against].values))
    force = force_unit(style.largest(dataset["total_force"].values))
    x, y = dataset[against].values, dataset["total_force"].values
    for number, title in enumerate(dataset["curve"].values):
        own = dataset["curve_number"].values == number
        back = dataset["branch"].values[own] == 1
        states = MeasuredStates(str(title), x[own], y[own], (None, None), back)
        draw_measured(curve, states, "#808080", (length, force))
        for at in order:
            line = dataset.isel(model=at, curve=number)
            for way in range(line.sizes["way"]):
                label = str(dataset["model"].values[at]) if number == way == 0 else None
                values = line.isel(way=way)
                where = values[f"fitted_{against}"].values / length.size
                curve.plot(
                    where, values["fitted_force"].values / force.size, label=label, lw=1.1, zorder=3, **_look(at)
                )
    span, height = np.ptp(x) / length.size, np.ptp(y) / force.size
    curve.set_xlim(x.min() / length.size - 0.03 * span, x.max() / length.size + 0.03 * span)
    curve.set_ylim(y.min() / force.size - 0.08 * height, y.max() / force.size + 0.05 * height)
    curve.set_ylabel(f"force $F$ ({force.name})")
    curve.legend()
    for at in shown:
        look = {"color": _look(at)["color"], "ms": 1.8, "mew": 0}
        residuals.plot(x / length.size, dataset["residual"].values[at], "o", **look)
    residuals.axhline(0, color="#909090", lw=0.7)
    words = {"displacement": r"displacement $\delta$", "contact_radius": "contact radius $a$"}[against]
    residuals.set(xlabel=f"{words} ({length.name})", ylabel="residual / error")


def _draw_profile(axes: Axes, dataset: xr.Dataset, name: str, shown: list[int]) -> None:
    symbol, unit = _SYMBOLS[name]
    drawn = [at for at in shown if np.isfinite(dataset[f"{name}_profile"].values[at]).any()]
    top = _TOP * float(dataset["threshold"].max())
    values = dataset[f"{name}_profile"].values[drawn]
    rise = dataset[f"{name}_profile_rise"].values[drawn]
    if not drawn:
        axes.set_axis_off()
        return
    low, high = np.nanmin(values[rise <= top]), np.nanmax(values[rise <= top])
    known = _unit(float(high), unit) if unit else Unit("", 1.0)
    for at, along, height in zip(drawn, values, rise, strict=True):
        fine = np.isfinite(along)
        axes.plot(along[fine] / known.size, height[fine], marker=".", ms=3, lw=1.0, **_look(at))
    axes.axhline(float(dataset["threshold"].values[drawn[0]]), color="#404040", lw=0.7)
    axes.text(
        0.5,
        float(dataset["threshold"].values[drawn[0]]),
        "90 %",
        transform=axes.get_yaxis_transform(),
        va="bottom",
        ha="center",
        fontsize=7,
    )
    if high > 5 * low:
        axes.set_xscale("log")
        style.plain_decades(axes.xaxis, high < 500 * low)
    axes.set_ylim(-0.04 * top, top)
    axes.set(xlabel=f"{symbol} ({known.name})" if known.name else symbol, ylabel=r"$-2\Delta\ln L$")


def _unit(most: float, base: str) -> Unit:
    size, prefix = next((pair for pair in _PREFIXES if most >= pair[0]), _PREFIXES[-1])
    return Unit(f"{prefix}{base}", size)
