"""Distributions of stress and gap, and the spectrum of the surface."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.inputs.units import length
from contact_study.numerics.grid import Grid
from contact_study.physics.roughness.statistics import (
    PowerSpectrum,
    SelfAffineFit,
    law_through,
    roughness_of_sample,
    self_affine_fit,
)
from contact_study.plots.selection import extent, lines, one_state, require
from contact_study.plots.style import (
    COLOURS,
    Unit,
    add_legend,
    axes_of,
    length_unit,
    picture,
    pressure_unit,
    readable_decades,
)

_ROUNDING = 1e-20  # of the largest C: what a transform leaves of waves that a surface does not have
# Variables with the self-affine law of the surface.
_LAW = ("fitted_hurst_exponent", "fitted_hurst_exponent_error", "fitted_roll_off", "fitted_cutoff")
_LEAST = 1e-8  # of the largest density: theories' tails go on for ever


@picture("Of any model.")
def stress_distribution(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Probability density of the local pressure, a line for each state: select those to be shown."""
    require(dataset, "pressure_pdf")
    return _densities(dataset, "pressure_pdf", "pressure_bin", pressure_unit, r"stress $\sigma$", r"P(\sigma)", axes)


@picture("Of any model.")
def gap_distribution(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Probability density of the local gap."""
    require(dataset, "gap_pdf")
    return _densities(dataset, "gap_pdf", "gap_bin", length_unit, "gap $u$", "P(u)", axes)


@picture("One surface of a simulation with its fields.")
def surface_spectrum(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Power spectrum C(q) of the surface, averaged over directions and bands of an eighth of an octave.

    The figure shows the self-affine law of the dataset, or else the best fit, beside it. For heights
    whose edges do not meet it is the spectrum of the map joined to its mirror images.

    Convention: h_rms² = 2π ∫ q C dq.
    """
    surface = one_state(dataset, "height")
    grid = Grid(surface["height"].shape, extent(surface))
    spectrum = roughness_of_sample(surface["height"].values, grid).spectrum
    if not spectrum.density.any():
        raise ValueError("the surface is flat: it has no spectrum")
    given = set(_LAW) <= set(surface)
    fit = law_through(spectrum, *(float(surface[name]) for name in _LAW)) if given else self_affine_fit(spectrum)
    return draw_spectrum(spectrum, fit, axes_of(axes))


def draw_spectrum(spectrum: PowerSpectrum, fit: SelfAffineFit | None, axes: Axes) -> Axes:
    """Draw a spectrum that has some power, and the self-affine law of it."""
    shown = spectrum.density > _ROUNDING * spectrum.density.max()
    axes.loglog(spectrum.wavevectors[shown], spectrum.density[shown], ".-", color=COLOURS[0], ms=3, lw=0.8)
    if fit is not None:
        q = np.geomspace(spectrum.wavevectors[0], fit.cutoff, 100)
        law = fit.density * np.maximum(q / fit.roll_off, 1) ** (-2 - 2 * fit.hurst_exponent)
        words = f"H = {fit.hurst_exponent:.2f} ± {fit.uncertainty:.2f}, down to {length(2 * np.pi / fit.cutoff)}"
        axes.loglog(q, law, color=COLOURS[1], lw=1.0, label=words)
        axes.legend()
    readable_decades(axes.xaxis)
    axes.set(xlabel=r"wavevector $q$ (m$^{-1}$)", ylabel=r"power spectrum $C(q)$ (m$^4$)")
    return axes


def _densities(
    dataset: xr.Dataset,
    name: str,
    along: str,
    unit_of: Callable[[float], Unit],
    symbol: str,
    density: str,
    axes: Axes | None,
) -> Axes:
    axes = axes_of(axes)
    every = [(words, part[name].values) for words, part in lines(dataset.squeeze(), name, along)]
    shown = [(words, pdf) for words, pdf in every if np.nansum(pdf) > 0]  # Persson's theory has no gaps
    values = dataset[along].values
    peak = max((float(pdf.max(initial=0.0, where=np.isfinite(pdf))) for _, pdf in shown), default=0.0)
    present = np.any([pdf > _LEAST * peak for _, pdf in shown], axis=0) if shown else np.zeros(values.size, bool)
    unit = unit_of(float(np.abs(values[present]).max(initial=0.0)))
    for number, (words, pdf) in enumerate(shown):
        drawn = np.where(pdf > _LEAST * peak, pdf, np.nan) * unit.size
        axes.semilogy(values / unit.size, drawn, color=COLOURS[number % len(COLOURS)], lw=1.0, label=words or None)
    axes.set(xlabel=f"{symbol} ({unit.name})", ylabel=rf"${density}$ (1/{unit.name})")
    add_legend(axes)
    return axes
