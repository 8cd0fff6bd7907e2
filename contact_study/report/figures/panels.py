"""The figures of Yang et al., EPL 84, 46004 (2008), with every model on the same axes.

Colour distinguishes the points of the sweep (or the pressures), line and marker the models; with one point of the sweep
the colour distinguishes the models, too.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_study.plots.paths import (
    ERROR,
    Curve,
    Look,
    draw_path,
    draw_strip,
    error_band,
    logarithmic,
    of_compression,
    smallest_resolved,
    window,
)
from contact_study.plots.style import DOUBLE, SINGLE, styled
from contact_study.report.align.curves import Band, PathBands, PathCurves, Strips
from contact_study.report.figures.legends import (
    STRIP,
    colour_legend,
    model_legend,
    panel_heading,
    shared_colour_legend,
)
from contact_study.report.figures.style import (
    PRESSURE_COLOURS,
    SWEEP_COLOURS,
    label_short_decades,
    looks_of,
    palette,
)
from contact_study.report.models import entry_of

_TICKS = 6  # along x: six numbers such as −0.075 fit half a page
_ROW = 0.16  # inches that a row of the legend takes
_NO_BANDS = PathBands([], [], [])


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
    looks, lowest = looks_of(shown), smallest_resolved(shown) - 0.3
    for axes, curves, colours, letter, state in (
        (left, panel_a, SWEEP_COLOURS, "a", states[0]),
        (right, panel_b, PRESSURE_COLOURS, "b", states[1]),
    ):
        own = palette(colours, curves)
        for curve in curves:
            _draw_density(axes, curve, looks[curve.model], own[curve.colour])
        axes.set_xlabel(x_label)
        axes.locator_params(axis="x", nbins=_TICKS)
        # Tails of the theories have no end.
        seen = np.concatenate([np.empty(0), *(curve.x[curve.y > lowest] for curve in curves)])
        if seen.size:
            margin = 0.03 * np.ptp(seen)
            axes.set_xlim(seen.min() - margin, seen.max() + margin)
        panel_heading(axes, letter, state)
        colour_legend(axes, curves, own, width=0.42 * DOUBLE)
    left.set_ylabel(y_label)
    left.set_ylim(lowest, max((np.nanmax(curve.y) for curve in shown if np.isfinite(curve.y).any()), default=0) + 0.3)
    model_legend(figure, shown, densities=True)
    return figure


def _draw_density(axes: Axes, curve: Curve, look: Look, colour: Any) -> None:
    if curve.y_error is not None:
        low, high = curve.y - curve.y_error, curve.y + curve.y_error
        axes.fill_between(curve.x, low, high, color=colour, alpha=ERROR, lw=0, zorder=1)
    if look.line == "none":
        axes.plot(curve.x, curve.y, look.marker, color=colour, ms=2.0, mfc="none", mew=0.6, zorder=2)
    else:
        axes.plot(curve.x, curve.y, linestyle=look.line, color=colour, lw=max(look.line_width, 1.0), zorder=3)


@styled
def contact_area_figure(
    curves: PathCurves, unit: str = "GPa", bands: PathBands = _NO_BANDS, strips: Strips | None = None
) -> Figure:
    """Figure 3: relative contact area against pressure, linear (a) and logarithmic (b); no (b) without compression."""
    areas, spread = curves.areas, strips.curves.areas if strips else []
    figure, panels = _path_panels(areas, 2 if curves.in_compression else 1, 3.5)
    colours, looks = _Colours([*areas, *spread]), looks_of(areas)
    for axes, letter in zip(panels, "ab", strict=False):
        for band in bands.areas:
            shown = band.along > (-np.inf if letter == "a" else 0)
            low, high = band.low[shown], band.high[shown]
            axes.fill_between(band.along[shown], low, high, color=colours[band], alpha=0.15, lw=0)
        _draw_strips(axes, spread, colours)
        for curve in areas:
            shown_curve = curve if letter == "a" else of_compression(curve)
            draw_path(axes, shown_curve, looks[curve.model], colours[curve])
        axes.set(xlabel=rf"pressure $p$ ({unit})", ylabel=r"contact area $A/A_0$")
    panels[0].locator_params(axis="x", nbins=_TICKS)
    panels[0].set_ylim(0, None)
    for axes in panels[1:]:
        x_limits, y_limits = 10.0 ** window([logarithmic(curve) for curve in areas], ended=0)
        axes.set(xscale="log", yscale="log", xlim=x_limits, ylim=y_limits)
        label_short_decades(axes)
    model_legend(figure, areas, bands=bands.areas, colours=colours.by_model, strips=strips)
    return figure


@styled
def mean_gap_figure(
    curves: PathCurves, unit: str = "h_rms", bands: PathBands = _NO_BANDS, strips: Strips | None = None
) -> Figure:
    """Figure 4: logarithm of the pressure against the mean gap, and the pressure itself where some of it is tension."""
    linear, names = curves.linear_gaps, {"logarithmic": "gaps", "linear": "linear_gaps"}
    figure, panels = _path_panels(linear, len(curves.gap_panels), 3.9)
    colours, looks = _Colours([*linear, *(strips.curves.linear_gaps if strips else ())]), looks_of(linear)
    for axes, name in zip(panels, curves.gap_panels, strict=True):
        drawn, shaded = getattr(curves, names[name]), getattr(bands, names[name])
        _draw_strips(axes, getattr(strips.curves, names[name]) if strips else [], colours)
        for band in shaded:
            axes.fill_betweenx(band.along, band.low, band.high, color=colours[band], alpha=0.15, lw=0)
        for curve in drawn:
            draw_path(axes, curve, looks[curve.model], colours[curve])
        x_limits, y_limits = window(drawn, ended=1 if name == "logarithmic" else None)
        axes.set(xlim=x_limits, ylim=y_limits)
        if x_limits[0] < 0:
            axes.axvline(0, color="#909090", lw=0.7, zorder=1)
        axes.locator_params(axis="x", nbins=_TICKS)
        axes.set_xlabel(rf"mean gap $\bar{{u}}/{_height(unit)}$")
        axes.set_ylabel(r"$\ln\,(p/E^*)$" if name == "logarithmic" else r"pressure $p/E^*$")
    every = [*bands.gaps, *bands.linear_gaps]
    model_legend(figure, linear, bands=every, colours=colours.by_model, strips=strips)
    return figure


def _path_panels(curves: Sequence[Curve], count: int, height: float) -> tuple[Figure, list[Axes]]:
    """A figure of so many panels with their letters and one legend of the colours."""
    width = DOUBLE if count > 1 else SINGLE + 0.6
    figure = Figure(figsize=(width, height + _ROW * _extra_rows(curves)), layout="constrained")
    panels = list(figure.subplots(1, count, squeeze=False)[0])
    for axes, letter in zip(panels, "ab" if count > 1 else " ", strict=True):
        panel_heading(axes, letter.strip())
    shared_colour_legend(figure, curves, palette(SWEEP_COLOURS, curves))
    return figure, panels


class _Colours:
    """The colour of each curve and band: that of its point of the sweep, or with a single point of its model."""

    def __init__(self, curves: Sequence[Curve]):
        swept = any(curve.label for curve in curves)
        self._swept = palette(SWEEP_COLOURS, curves) if swept else []
        self.by_model = {} if swept else {curve.model: entry_of(curve.model).colour for curve in curves}

    def __getitem__(self, drawn: Curve | Band) -> Any:
        return self.by_model[drawn.model] if self.by_model else self._swept[drawn.colour]


def _draw_strips(axes: Axes, curves: Sequence[Curve], colours: _Colours) -> None:
    """The scatter between surfaces: one deviation to either side of the mean."""
    for curve in curves:
        draw_strip(axes, error_band(curve), colours[curve], STRIP, 0.5)


def _height(unit: str) -> str:
    return r"h_\mathrm{rms}" if unit == "h_rms" else r"\mathrm{nm}"


def _extra_rows(curves: Sequence[Curve]) -> int:
    """Rows of the colours' legend beyond the first, about three labels a row."""
    return max(0, -(-len({curve.colour for curve in curves if curve.label}) // 3) - 1)
