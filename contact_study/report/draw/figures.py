"""The figures of Yang et al., EPL 84, 46004 (2008), with every model on the same axes.

Each function draws curves of :mod:`contact_study.report.compute.plotted` and returns a figure; none reads or writes
a file.
Colour tells the point of the sweep (or the pressure), the line and marker tell the model; where there is only one point
of the sweep, the colour tells the model, too.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from contact_study.plots.style import DOUBLE, SINGLE, styled
from contact_study.report.compute.bands import Band
from contact_study.report.compute.curves import (
    Curve,
    error_band,
    in_compression,
    logarithmic,
    mean_gap_panels,
    of_compression,
    path_segments,
    simulated,
    smallest_resolved,
    window,
)
from contact_study.report.compute.scatter import Strips
from contact_study.report.draw.legends import (
    STRIP,
    colour_legend,
    model_legend,
    panel_heading,
    shared_colour_legend,
)
from contact_study.report.draw.style import (
    PRESSURE_COLOURS,
    SWEEP_COLOURS,
    Look,
    label_short_decades,
    look_of,
    palette,
)
from contact_study.report.models import entry_of

_TICKS = 6  # along x: numbers such as −0.075 stand side by side in half a page
_ERROR = 0.25  # opacity of a strip of standard errors
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
    looks = _looks(shown)
    lowest = smallest_resolved(shown) - 0.3
    for axes, curves, colours, letter, state in (
        (left, panel_a, SWEEP_COLOURS, "a", states[0]),
        (right, panel_b, PRESSURE_COLOURS, "b", states[1]),
    ):
        own = palette(colours, _count(curves))
        for curve in curves:
            _draw_density(axes, curve, looks[curve.model], own[curve.colour])
        axes.set_xlabel(x_label)
        axes.locator_params(axis="x", nbins=_TICKS)
        _limit_to_simulations(axes, curves, lowest)
        panel_heading(axes, letter, state)
        colour_legend(axes, curves, own, width=0.42 * DOUBLE)
    left.set_ylabel(y_label)
    left.set_ylim(lowest, max((np.nanmax(curve.y) for curve in shown if np.isfinite(curve.y).any()), default=0) + 0.3)
    model_legend(figure, shown, densities=True)
    return figure


def _draw_density(axes: Axes, curve: Curve, look: Look, colour: Any) -> None:
    if curve.y_error is not None:
        low, high = curve.y - curve.y_error, curve.y + curve.y_error
        axes.fill_between(curve.x, low, high, color=colour, alpha=_ERROR, lw=0, zorder=1)
    if look.line == "none":
        axes.plot(curve.x, curve.y, look.marker, color=colour, ms=2.0, mfc="none", mew=0.6, zorder=2)
    else:
        axes.plot(curve.x, curve.y, linestyle=look.line, color=colour, lw=max(look.line_width, 1.0), zorder=3)


def _limit_to_simulations(axes: Axes, curves: Sequence[Curve], lowest: float) -> None:
    """End the stress or gap axis where all densities fall below ``lowest``: theories' tails go on for ever."""
    values = np.concatenate([np.empty(0), *(curve.x[curve.y > lowest] for curve in curves)])
    if values.size:
        margin = 0.03 * np.ptp(values)
        axes.set_xlim(values.min() - margin, values.max() + margin)


@styled
def contact_area_figure(
    curves: Sequence[Curve], unit: str = "GPa", bands: Sequence[Band] = (), strips: Strips | None = None
) -> Figure:
    """Figure 3: relative contact area against pressure, linear (a) and logarithmic (b); no (b) without compression.

    Parameters
    ----------
    curves : sequence of Curve
        As :func:`contact_area_data` gives them.
    unit : str
        Of the pressure.
    bands : sequence of Band
        Between metastable branches.
    strips : Strips, optional
        The scatter between surfaces, drawn behind all else.
    """
    both = in_compression(curves)
    figure, panels = _path_panels(curves, 2 if both else 1, 3.5)
    colours, looks = _Colours([*curves, *(strips.curves.areas if strips else ())]), _looks(curves)
    for axes, letter in zip(panels, "ab" if both else "a", strict=True):
        for band in bands:
            shown = band.along > (-np.inf if letter == "a" else 0)
            low, high = band.low[shown], band.high[shown]
            axes.fill_between(band.along[shown], low, high, color=colours[band], alpha=0.15, lw=0)
        _draw_strips(axes, strips.curves.areas if strips else (), colours)
        for curve in curves:
            _draw_path(axes, curve if letter == "a" else of_compression(curve), looks[curve.model], colours[curve])
        axes.set_xlabel(rf"pressure $p$ ({unit})")
        if letter == "a":
            axes.locator_params(axis="x", nbins=_TICKS)
        axes.set_ylabel(r"contact area $A/A_0$")
    panels[0].set_ylim(0, None)
    if both:
        x_limits, y_limits = 10.0 ** window([logarithmic(curve) for curve in curves], ended=0)
        panels[1].set(xscale="log", yscale="log", xlim=x_limits, ylim=y_limits)
        label_short_decades(panels[1])
    model_legend(figure, curves, bands=bands, colours=colours.by_model, strips=strips)
    return figure


@styled
def mean_gap_figure(
    curves: Sequence[Curve],
    linear: Sequence[Curve],
    unit: str = "h_rms",
    bands: tuple[Sequence[Band], Sequence[Band]] = ((), ()),
    strips: Strips | None = None,
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
    strips : Strips, optional
        The scatter between surfaces, drawn behind all else.
    """
    shown = mean_gap_panels(curves, linear)
    figure, panels = _path_panels(linear, len(shown), 3.9)
    colours, looks = _Colours([*linear, *(strips.curves.linear_gaps if strips else ())]), _looks(linear)
    for axes, name in zip(panels, shown, strict=True):
        drawn, shaded = (curves, bands[0]) if name == "logarithmic" else (linear, bands[1])
        if strips:
            _draw_strips(axes, strips.curves.gaps if name == "logarithmic" else strips.curves.linear_gaps, colours)
        for band in shaded:
            axes.fill_betweenx(band.along, band.low, band.high, color=colours[band], alpha=0.15, lw=0)
        for curve in drawn:
            _draw_path(axes, curve, looks[curve.model], colours[curve])
        x_limits, y_limits = window(drawn, ended=1 if name == "logarithmic" else None)
        axes.set(xlim=x_limits, ylim=y_limits)
        if x_limits[0] < 0:
            axes.axvline(0, color="#909090", lw=0.7, zorder=1)
        axes.set_xlabel(rf"mean gap $\bar{{u}}/{_height(unit)}$")
        axes.locator_params(axis="x", nbins=_TICKS)
        axes.set_ylabel(r"$\ln\,(p/E^*)$" if name == "logarithmic" else r"pressure $p/E^*$")
    every = [band for shaded in bands for band in shaded]
    model_legend(figure, linear, bands=every, colours=colours.by_model, strips=strips)
    return figure


def _path_panels(curves: Sequence[Curve], count: int, height: float) -> tuple[Figure, list[Axes]]:
    """A figure of so many panels with their letters and one legend of the colours."""
    width = DOUBLE if count > 1 else SINGLE + 0.6
    figure = Figure(figsize=(width, height + _ROW * _extra_rows(curves)), layout="constrained")
    panels = list(figure.subplots(1, count, squeeze=False)[0])
    for axes, letter in zip(panels, "ab" if count > 1 else " ", strict=True):
        panel_heading(axes, letter.strip())
    shared_colour_legend(figure, curves, palette(SWEEP_COLOURS, _count(curves)))
    return figure, panels


class _Colours:
    """The colour of each curve and band: that of its point of the sweep, or where there is only one of its model."""

    def __init__(self, curves: Sequence[Curve]):
        swept = any(curve.label for curve in curves)
        self._swept = palette(SWEEP_COLOURS, _count(curves)) if swept else []
        self.by_model = {} if swept else {curve.model: entry_of(curve.model).colour for curve in curves}

    def __getitem__(self, drawn: Curve | Band) -> Any:
        return self.by_model[drawn.model] if self.by_model else self._swept[drawn.colour]


def _looks(curves: Sequence[Curve]) -> dict[str, Look]:
    names = list(dict.fromkeys(curve.model for curve in curves))
    return {name: look_of(name, names) for name in names}


def _draw_path(axes: Axes, curve: Curve, look: Look, colour: Any) -> None:
    """One model's points along the path: filled while loading, hollow while unloading, crossed if not converged."""
    theory = not simulated(curve)
    fit = np.ones(curve.x.shape, bool) if curve.fit is None else curve.fit
    order = 2 if theory else 3
    segments, back, joined = path_segments(curve)
    if look.line != "none" and len(strip := error_band(curve)):
        axes.add_collection(PolyCollection(list(strip), facecolors=[colour], alpha=_ERROR, linewidths=0, zorder=1))
        if joined[fit].all():
            curve = replace(curve, x_error=None, y_error=None)
    for side, alpha in ((~back, 1.0), (back, 0.55 if theory else 1.0)):
        if side.any() and look.line != "none":
            lines = LineCollection(
                _chains(segments[side]),
                colors=colour,
                linestyles=[look.line],
                linewidths=look.line_width,
                alpha=alpha,
                zorder=order,
            )
            axes.add_collection(lines)
    unloading = np.zeros(curve.x.shape, bool) if curve.unloading is None else curve.unloading
    for side, fill in ((~unloading, "none" if look.hollow else colour), (unloading, "white")):
        here = fit & side & np.isfinite(curve.x) & np.isfinite(curve.y)
        if not look.marker:  # a line needs two states; one that stands alone is a dot
            here &= ~joined
        if here.any():
            axes.errorbar(
                curve.x[here],
                curve.y[here],
                xerr=_at(curve.x_error, here),
                yerr=_at(curve.y_error, here),
                color=colour,
                linestyle="none",
                marker=look.marker or ".",
                ms=look.marker_size,
                mfc=fill,
                mew=0.9,
                elinewidth=0.7,
                capsize=1.5,
                zorder=order,
            )
    left = ~fit & np.isfinite(curve.x) & np.isfinite(curve.y)
    axes.plot(curve.x[left], curve.y[left], "x", color=colour, ms=5, mew=1.2, zorder=4)


def _draw_strips(axes: Axes, curves: Sequence[Curve], colours: "_Colours") -> None:
    """The scatter between surfaces: one deviation to either side of the mean."""
    for curve in curves:
        axes.add_collection(
            PolyCollection(list(error_band(curve)), facecolors=[colours[curve]], alpha=STRIP, linewidths=0, zorder=0.5)
        )


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
