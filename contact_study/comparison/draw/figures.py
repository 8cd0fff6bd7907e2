"""The figures of Yang et al., EPL 84, 46004 (2008), with every model on the same axes.

Each function draws data of :mod:`contact_study.comparison.compute.plotted` and returns a figure; none reads or writes a
file.
Colour tells the point of the sweep (or the pressure), the line and marker tell the model.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from contact_study.comparison.compute.bands import Band
from contact_study.comparison.compute.plotted import (
    Curve,
    in_compression,
    logarithmic,
    of_compression,
    path_segments,
    smallest_resolved,
    window,
)
from contact_study.comparison.draw.legends import colour_legend, model_legend, panel_heading, shared_colour_legend
from contact_study.comparison.draw.style import (
    DOUBLE,
    LINES,
    MARKERS,
    PRESSURE_COLOURS,
    SINGLE,
    SWEEP_COLOURS,
    palette,
    styled,
)

_ROW = 0.16  # inches that a row of the legend takes


@styled
def stress_distribution_figure(
    panel_a: Sequence[Curve], panel_b: Sequence[Curve], states: tuple[str, str] = ("", "")
) -> Figure:
    """Figure 1: log₁₀ of the stress distribution, over the sweep (a) and over the pressure (b)."""
    return _distribution_figure(panel_a, panel_b, states, r"stress $\sigma/E^*$", r"$\log_{10}\,[P(\sigma)\,E^*]$")


@styled
def gap_distribution_figure(
    panel_a: Sequence[Curve], panel_b: Sequence[Curve], unit: str = "h_rms", states: tuple[str, str] = ("", "")
) -> Figure:
    """Figure 2: log₁₀ of the distribution of local gaps, over the sweep (a) and over the pressure (b)."""
    symbol = _height(unit)
    return _distribution_figure(panel_a, panel_b, states, rf"gap $u/{symbol}$", rf"$\log_{{10}}\,[P(u)\,{symbol}]$")


def _distribution_figure(
    panel_a: Sequence[Curve], panel_b: Sequence[Curve], states: tuple[str, str], x_label: str, y_label: str
) -> Figure:
    figure = Figure(figsize=(DOUBLE, 3.5 + _ROW * _extra_rows(panel_a)), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    shown = [*panel_a, *panel_b]
    lowest = smallest_resolved(shown) - 0.3
    for axes, curves, colours, letter, state in (
        (left, panel_a, SWEEP_COLOURS, "a", states[0]),
        (right, panel_b, PRESSURE_COLOURS, "b", states[1]),
    ):
        own = palette(colours, _count(curves))
        for curve in curves:
            _draw_density(axes, curve, own[curve.colour])
        axes.set_xlabel(x_label)
        _limit_to_simulations(axes, curves, lowest)
        panel_heading(axes, letter, state)
        colour_legend(axes, curves, own, width=0.42 * DOUBLE)
    left.set_ylabel(y_label)
    left.set_ylim(lowest, max((np.nanmax(curve.y) for curve in shown if np.isfinite(curve.y).any()), default=0) + 0.3)
    model_legend(figure, shown, densities=True)
    return figure


def _draw_density(axes: Axes, curve: Curve, colour: Any) -> None:
    if curve.model == "atomistic":
        axes.plot(curve.x, curve.y, "s", color=colour, ms=2.0, mfc="none", mew=0.6, zorder=2)
    else:
        width = 1.0 if curve.model == "continuum" else 1.4
        axes.plot(curve.x, curve.y, LINES[curve.model], color=colour, lw=width, zorder=3)


def _limit_to_simulations(axes: Axes, curves: Sequence[Curve], lowest: float) -> None:
    """End the stress or gap axis where all densities fall below ``lowest``: theories' tails go on for ever."""
    values = np.concatenate([np.empty(0), *(curve.x[curve.y > lowest] for curve in curves)])
    if values.size:
        margin = 0.03 * np.ptp(values)
        axes.set_xlim(values.min() - margin, values.max() + margin)


@styled
def contact_area_figure(curves: Sequence[Curve], unit: str = "GPa", bands: Sequence[Band] = ()) -> Figure:
    """Figure 3: relative contact area against pressure, linear (a) and logarithmic (b); no (b) without compression."""
    both = in_compression(curves)
    figure, panels = _path_panels(curves, 2 if both else 1, 3.5)
    colours = palette(SWEEP_COLOURS, _count(curves))
    for axes, letter in zip(panels, "ab" if both else "a", strict=True):
        for band in bands:
            shown = band.along > (-np.inf if letter == "a" else 0)
            colour = colours[band.colour]
            axes.fill_between(band.along[shown], band.low[shown], band.high[shown], color=colour, alpha=0.15, lw=0)
        for curve in curves:
            _draw_path(axes, curve if letter == "a" else of_compression(curve), colours[curve.colour])
        axes.set_xlabel(rf"pressure $p$ ({unit})")
        axes.set_ylabel(r"contact area $A/A_0$")
    panels[0].set_ylim(0, None)
    if both:
        x_limits, y_limits = 10.0 ** window([logarithmic(curve) for curve in curves], ended=0)
        panels[1].set(xscale="log", yscale="log", xlim=x_limits, ylim=y_limits)
    model_legend(figure, curves, bands=bool(bands))
    return figure


@styled
def mean_gap_figure(
    curves: Sequence[Curve],
    linear: Sequence[Curve],
    unit: str = "h_rms",
    bands: tuple[Sequence[Band], Sequence[Band]] = ((), ()),
) -> Figure:
    """Figure 4: logarithm of the pressure against the mean gap, and the pressure itself where some of it is tension.

    Parameters
    ----------
    curves, linear : sequence of Curve
        As :func:`mean_gap_data` and :func:`mean_gap_linear_data` give them.
    unit : str
        ``"h_rms"`` or ``"nm"``.
    bands : two sequences of Band
        Over the logarithm of the pressure, and over the pressure.
    """
    shown = mean_gap_panels(curves, linear)
    figure, panels = _path_panels(linear, len(shown), 3.9)
    colours = palette(SWEEP_COLOURS, _count(linear))
    for axes, name in zip(panels, shown, strict=True):
        drawn, shaded = (curves, bands[0]) if name == "logarithmic" else (linear, bands[1])
        for band in shaded:
            colour = colours[band.colour]
            axes.fill_betweenx(band.along, band.low, band.high, color=colour, alpha=0.15, lw=0)
        for curve in drawn:
            _draw_path(axes, curve, colours[curve.colour])
        x_limits, y_limits = window(drawn, ended=1 if name == "logarithmic" else None)
        axes.set(xlim=x_limits, ylim=y_limits)
        if x_limits[0] < 0:
            axes.axvline(0, color="#909090", lw=0.7, zorder=1)
        axes.set_xlabel(rf"mean gap $\bar{{u}}/{_height(unit)}$")
        axes.set_ylabel(r"$\ln\,(p/E^*)$" if name == "logarithmic" else r"pressure $p/E^*$")
    model_legend(figure, linear, bands=any(bands))
    return figure


def mean_gap_panels(curves: Sequence[Curve], linear: Sequence[Curve]) -> list[str]:
    """Panels of figure 4, ``"logarithmic"`` where there is compression, ``"linear"`` where there is tension."""
    compressed = any(np.isfinite(curve.x + curve.y).any() for curve in curves)
    pulled = any((np.isfinite(curve.x) & (curve.y < 0)).any() for curve in linear)
    return [name for name, there in (("logarithmic", compressed), ("linear", pulled)) if there]


def _path_panels(curves: Sequence[Curve], count: int, height: float) -> tuple[Figure, list[Axes]]:
    """A figure of so many panels with their letters and one legend of the colours."""
    width = DOUBLE if count > 1 else SINGLE + 0.6
    figure = Figure(figsize=(width, height + _ROW * _extra_rows(curves)), layout="constrained")
    panels = list(figure.subplots(1, count, squeeze=False)[0])
    for axes, letter in zip(panels, "ab" if count > 1 else " ", strict=True):
        panel_heading(axes, letter.strip())
    shared_colour_legend(figure, curves, palette(SWEEP_COLOURS, _count(curves)))
    return figure, panels


def _draw_path(axes: Axes, curve: Curve, colour: Any) -> None:
    """One model's points along the path: filled while loading, hollow while unloading, crossed if not converged."""
    theory = curve.model in ("theory", "gap_flow")
    order = 2 if theory else 3
    segments, back, joined = path_segments(curve)
    for side, alpha in ((~back, 1.0), (back, 0.55 if theory else 1.0)):
        if side.any() and LINES[curve.model] != "none":
            lines = LineCollection(
                _chains(segments[side]),
                colors=colour,
                linestyles=LINES[curve.model],
                linewidths=0.8 if curve.model == "continuum" else 1.4,
                alpha=alpha,
                zorder=order,
            )
            axes.add_collection(lines)
    fit = np.ones(curve.x.shape, bool) if curve.fit is None else curve.fit
    unloading = np.zeros(curve.x.shape, bool) if curve.unloading is None else curve.unloading
    for side, fill in ((~unloading, "none" if curve.model == "atomistic" else colour), (unloading, "white")):
        here = fit & side & np.isfinite(curve.x) & np.isfinite(curve.y)
        if not MARKERS[curve.model]:  # a line needs two states; one that stands alone is a dot
            here &= ~joined
        if here.any():
            axes.errorbar(
                curve.x[here],
                curve.y[here],
                xerr=_at(curve.x_error, here),
                yerr=_at(curve.y_error, here),
                color=colour,
                linestyle="none",
                marker=MARKERS[curve.model] or ".",
                ms=5.5 if curve.model == "atomistic" else 3.2,
                mfc=fill,
                mew=0.9,
                elinewidth=0.7,
                capsize=1.5,
                zorder=order,
            )
    left = ~fit & np.isfinite(curve.x) & np.isfinite(curve.y)
    axes.plot(curve.x[left], curve.y[left], "x", color=colour, ms=5, mew=1.2, zorder=4)


def _chains(segments: np.ndarray) -> list[np.ndarray]:
    """Lines of as many segments as follow one another: dashes run on over their corners."""
    chains: list[list[np.ndarray]] = []
    for first, second in segments:
        if chains and np.array_equal(chains[-1][-1], first):
            chains[-1].append(second)
        else:
            chains.append([first, second])
    return [np.array(chain) for chain in chains]


def _at(error: np.ndarray | None, here: np.ndarray) -> np.ndarray | None:
    return None if error is None else np.nan_to_num(error[here])


def _height(unit: str) -> str:
    return r"h_\mathrm{rms}" if unit == "h_rms" else r"\mathrm{nm}"


def _count(curves: Sequence[Curve]) -> int:
    return max((curve.colour for curve in curves), default=0) + 1


def _extra_rows(curves: Sequence[Curve]) -> int:
    """Rows of the colours' legend beyond the first, about three labels a row."""
    return max(0, -(-len({curve.colour for curve in curves if curve.label}) // 3) - 1)
