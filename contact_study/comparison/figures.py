"""The figures of Yang et al., EPL 84, 46004 (2008), with every model on the same axes.

Each function draws data of :mod:`contact_study.comparison.plotted` and returns a figure; none reads or writes a file.
Colour tells the point of the sweep (or the pressure), the line and marker tell the model.
"""

import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from contact_study.comparison.bands import Band
from contact_study.comparison.plotted import Curve, in_compression, smallest_resolved
from contact_study.comparison.wording import length_unit

RESOLUTION = 200  # dots per inch
SINGLE, DOUBLE = 3.46, 7.0  # inches: one and two columns of a journal

MODEL_NAMES = {
    "atomistic": "atoms",
    "continuum": "continuum",
    "theory": "Persson's theory",
    "gap_flow": "gap-flow theory",
}
_LINES = {"atomistic": "none", "continuum": "-", "theory": "--", "gap_flow": ":"}
_MARKERS = {"atomistic": "s", "continuum": "o", "theory": "", "gap_flow": ""}

# Okabe and Ito: told apart with any colour vision. Panels whose colours mean pressures use other ones.
_SWEEP_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_PRESSURE_COLOURS = ("#000000", "#CC79A7", "#E69F00", "#56B4E9", "#0072B2", "#D55E00")

_STYLE = {
    "font.size": 8,
    "axes.labelsize": 8.5,
    "legend.fontsize": 7.5,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.2,
    "mathtext.fontset": "dejavusans",
    "legend.frameon": False,
    "legend.handlelength": 2.0,
    "savefig.dpi": RESOLUTION,
}


def styled(draw: Callable[..., Figure]) -> Callable[..., Figure]:
    """Draw in the common style without changing the caller's settings."""

    def drawn(*arguments: Any, **options: Any) -> Figure:
        with matplotlib.rc_context(_STYLE):
            return draw(*arguments, **options)

    drawn.__doc__, drawn.__name__ = draw.__doc__, draw.__name__
    return drawn


def png(figure: Figure) -> bytes:
    """The figure as a PNG file; equal figures give equal bytes."""
    stream = io.BytesIO()
    with matplotlib.rc_context(_STYLE):
        figure.savefig(stream, format="png", dpi=RESOLUTION, metadata={"Software": None})
    return stream.getvalue()


@styled
def stress_distribution_figure(panel_a: Sequence[Curve], panel_b: Sequence[Curve]) -> Figure:
    """Figure 1: log₁₀ of the stress distribution, over the sweep (a) and over the pressure (b)."""
    return _distribution_figure(panel_a, panel_b, r"stress $\sigma/E^*$", r"$\log_{10}\,[P(\sigma)\,E^*]$")


@styled
def gap_distribution_figure(panel_a: Sequence[Curve], panel_b: Sequence[Curve], unit: str = "h_rms") -> Figure:
    """Figure 2: log₁₀ of the distribution of local gaps, over the sweep (a) and over the pressure (b)."""
    symbol = r"h_\mathrm{rms}" if unit == "h_rms" else r"\mathrm{nm}"
    return _distribution_figure(panel_a, panel_b, rf"gap $u/{symbol}$", rf"$\log_{{10}}\,[P(u)\,{symbol}]$")


def _distribution_figure(panel_a: Sequence[Curve], panel_b: Sequence[Curve], x_label: str, y_label: str) -> Figure:
    figure = Figure(figsize=(DOUBLE, 3.5), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    shown = [*panel_a, *panel_b]
    lowest = smallest_resolved(shown) - 0.3
    for axes, curves, colours, letter in (
        (left, panel_a, _SWEEP_COLOURS, "a"),
        (right, panel_b, _PRESSURE_COLOURS, "b"),
    ):
        for curve in curves:
            _draw_density(axes, curve, _colour(colours, curve.colour))
        axes.set_xlabel(x_label)
        _limit_to_simulations(axes, curves, lowest)
        _panel_letter(axes, letter)
        _colour_legend(axes, curves, colours)
    left.set_ylabel(y_label)
    left.set_ylim(lowest, max((np.nanmax(curve.y) for curve in shown if np.isfinite(curve.y).any()), default=0) + 0.3)
    _model_legend(figure, shown, densities=True)
    return figure


def _draw_density(axes: Axes, curve: Curve, colour: Any) -> None:
    if curve.model == "atomistic":
        axes.plot(curve.x, curve.y, "s", color=colour, ms=2.0, mfc="none", mew=0.6, zorder=2)
    else:
        width = 1.0 if curve.model == "continuum" else 1.4
        axes.plot(curve.x, curve.y, _LINES[curve.model], color=colour, lw=width, zorder=3)


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
    figure = Figure(figsize=(DOUBLE if both else SINGLE + 0.6, 3.5), layout="constrained")
    panels = list(figure.subplots(1, 2 if both else 1, squeeze=False)[0])
    for axes, letter in zip(panels, "ab" if both else "a", strict=True):
        for band in bands:
            shown = band.along > (-np.inf if letter == "a" else 0)
            colour = _colour(_SWEEP_COLOURS, band.colour)
            axes.fill_between(band.along[shown], band.low[shown], band.high[shown], color=colour, alpha=0.15, lw=0)
        for curve in curves:
            _draw_path(axes, curve if letter == "a" else _of_compression(curve))
        axes.set_xlabel(rf"pressure $p$ ({unit})")
        axes.set_ylabel(r"contact area $A/A_0$")
        if both:
            _panel_letter(axes, letter)
        _colour_legend(axes, curves, _SWEEP_COLOURS)
    panels[0].set_ylim(0, None)
    if both:
        panels[1].set_xscale("log")
        panels[1].set_yscale("log")
    _model_legend(figure, curves, bands=bool(bands), columns=6 if both else 3)
    return figure


@styled
def mean_gap_figure(curves: Sequence[Curve], unit: str = "h_rms", bands: Sequence[Band] = ()) -> Figure:
    """Figure 4: logarithm of the pressure against the mean gap."""
    symbol = r"h_\mathrm{rms}" if unit == "h_rms" else r"\mathrm{nm}"
    figure = Figure(figsize=(SINGLE + 0.6, 3.9), layout="constrained")
    axes = figure.subplots()
    for band in bands:
        axes.fill_betweenx(
            band.along, band.low, band.high, color=_colour(_SWEEP_COLOURS, band.colour), alpha=0.15, lw=0
        )
    for curve in curves:
        _draw_path(axes, curve)
    axes.set_xlabel(rf"mean gap $\bar{{u}}/{symbol}$")
    axes.set_ylabel(r"$\ln\,(p/E^*)$")
    _colour_legend(axes, curves, _SWEEP_COLOURS)
    _model_legend(figure, curves, bands=bool(bands), columns=3)
    return figure


@styled
def gap_map_figure(maps: Mapping[str, np.ma.MaskedArray], size: tuple[float, float], contact_distance: float) -> Figure:
    """Figure 5: local gap of each simulation on one state, contact in black.

    Parameters
    ----------
    maps : mapping
        Gap (y, x) of each model (m), masked where there is contact.
    size : tuple of float
        Lateral periods along y and x (m).
    contact_distance : float
        Where the colours of the gap begin (m): zero for a hard wall.
    """
    height = DOUBLE / 2 * min(size[0] / size[1], 1.6)
    figure = Figure(figsize=(DOUBLE if len(maps) > 1 else SINGLE + 0.6, height), layout="constrained")
    panels = np.atleast_1d(figure.subplots(1, len(maps), sharex=True, sharey=True))
    across, along = length_unit(max(size)), length_unit(max(float(gap.data.max()) for gap in maps.values()))
    top = max(np.quantile(gap.data, 0.995) for gap in maps.values()) / along.size
    colours = matplotlib.colormaps["cividis"].with_extremes(under="black", bad="black")
    for axes, (model, gap) in zip(panels, maps.items(), strict=True):
        image = axes.imshow(
            gap / along.size,
            origin="lower",
            extent=(0, size[1] / across.size, 0, size[0] / across.size),
            cmap=colours,
            vmin=contact_distance / along.size,
            vmax=top,
            interpolation="nearest",
        )
        axes.set_title(MODEL_NAMES[model], fontsize=8.5)
        axes.set_xlabel(rf"$x$ ({across.name})")
        axes.grid(False)
    panels[0].set_ylabel(rf"$y$ ({across.name})")
    figure.colorbar(image, ax=list(panels), label=f"gap ({along.name}), contact black", extend="min", shrink=0.9)
    return figure


def _draw_path(axes: Axes, curve: Curve) -> None:
    """One model's points along the path: filled while loading, hollow while unloading, crossed if not converged."""
    colour = _colour(_SWEEP_COLOURS, curve.colour)
    fit = np.ones(curve.x.shape, bool) if curve.fit is None else curve.fit
    unloading = np.zeros(curve.x.shape, bool) if curve.unloading is None else curve.unloading
    for side, fill in ((~unloading, colour), (unloading, "white")):
        here = fit & side & np.isfinite(curve.x) & np.isfinite(curve.y)
        if not here.any():
            continue
        if curve.model == "atomistic":
            fill = "none" if fill == colour else fill
        axes.errorbar(
            curve.x[here],
            curve.y[here],
            xerr=_at(curve.x_error, here),
            yerr=_at(curve.y_error, here),
            color=colour,
            linestyle=_LINES[curve.model],
            marker=_MARKERS[curve.model],
            lw=0.8 if curve.model == "continuum" else 1.4,
            ms=5.5 if curve.model == "atomistic" else 3.2,
            mfc=fill,
            mew=0.9,
            elinewidth=0.7,
            capsize=1.5,
            alpha=0.55 if side is unloading and curve.model in ("theory", "gap_flow") else 1.0,
            zorder=2 if curve.model in ("theory", "gap_flow") else 3,
        )
    left = ~fit & np.isfinite(curve.x) & np.isfinite(curve.y)
    axes.plot(curve.x[left], curve.y[left], "x", color=colour, ms=5, mew=1.2, zorder=4)


def _of_compression(curve: Curve) -> Curve:
    return replace(curve, x=np.where((curve.x > 0) & (curve.y > 0), curve.x, np.nan))


def _at(error: np.ndarray | None, here: np.ndarray) -> np.ndarray | None:
    return None if error is None else np.nan_to_num(error[here])


def _colour(colours: Sequence[str], number: int) -> Any:
    if number < len(colours):
        return colours[number]
    return matplotlib.colormaps["viridis"]((number * 0.618) % 1.0)


def _panel_letter(axes: Axes, letter: str) -> None:
    axes.annotate(
        f"({letter})",
        (0, 1),
        xytext=(-22, 4),
        xycoords="axes fraction",
        textcoords="offset points",
        weight="bold",
        fontsize=9,
    )


def _colour_legend(axes: Axes, curves: Sequence[Curve], colours: Sequence[str]) -> None:
    names = {curve.colour: curve.label for curve in curves if curve.label}
    if names:
        heads = {label.partition(" = ")[0] for label in names.values()}
        # What all labels begin with stands once, before them.
        head = f"{heads.pop()} = " if len(heads) == 1 and all(" = " in label for label in names.values()) else ""
        words = head.strip().replace("h_rms", r"$h_\mathrm{rms}$")
        handles = [Line2D([], [], ls="none", label=words)] if head else []
        handles += [
            Line2D([], [], color=_colour(colours, n), lw=3, label=label.removeprefix(head))
            for n, label in sorted(names.items())
        ]
        axes.legend(
            handles=handles,
            loc="lower right",
            bbox_to_anchor=(1.02, 1.0),
            ncols=min(4 if head else 3, len(handles)),
            columnspacing=0.9,
            handlelength=0.8,
            handletextpad=0.4,
            borderpad=0.2,
        )


def _model_legend(
    figure: Figure, curves: Sequence[Curve], densities: bool = False, bands: bool = False, columns: int = 6
) -> None:
    """Line and marker of each model below the axes, with what else the markers say."""
    grey = "#404040"
    handles: list[Artist] = []
    for model in dict.fromkeys(curve.model for curve in curves):
        marker = _MARKERS[model] if model == "atomistic" or not densities else ""
        small = 2.5 if densities else 5.5
        handles.append(
            Line2D(
                [],
                [],
                color=grey,
                linestyle=_LINES[model],
                marker=marker,
                mfc="none" if model == "atomistic" else grey,
                ms=small if model == "atomistic" else 3.2,
                lw=1.0 if model == "continuum" else 1.4,
                label=MODEL_NAMES[model],
            )
        )
    if bands:
        handles.append(Patch(color=grey, alpha=0.15, lw=0, label="its metastable band"))
    if not densities and any(curve.unloading is not None and curve.unloading.any() for curve in curves):
        handles.append(Line2D([], [], color=grey, ls="none", marker="o", mfc="white", ms=3.5, label="unloading"))
    if any(curve.fit is not None and (~curve.fit & np.isfinite(curve.x + curve.y)).any() for curve in curves):
        handles.append(Line2D([], [], color=grey, ls="none", marker="x", ms=5, label="not converged"))
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=min(columns, len(handles)),
        columnspacing=1.2,
        handletextpad=0.6,
    )
