"""Distributions of stress and gap, the spectrum of the surface, and Persson's theory against magnification."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm

from contact_study.inputs.units import length
from contact_study.numerics.grid import Grid
from contact_study.physics.roughness import statistics
from contact_study.plots import style
from contact_study.plots.selection import extent, lines, one_state, require, single
from contact_study.plots.style import COLOURS, Unit, axes_of, picture

_ROUNDING = 1e-20  # of the largest C: what a transform leaves of waves that a surface does not have
_LAW = ("fitted_hurst_exponent", "fitted_hurst_exponent_error", "fitted_roll_off", "fitted_cutoff")  # of the surface
LEAST = 1e-8  # of the largest density: theories' tails go on for ever
_COLOURED = 1e-4  # of the largest density, down to which colours distinguish it
# Of a distribution: its axis' unit and symbol, and its own symbol.
DENSITIES = {
    "pressure": (style.pressure_unit, r"stress $\sigma$", r"P(\sigma)"),
    "gap": (style.length_unit, "gap $u$", "P(u)"),
}
_FEW = 100.0  # magnifications up to which 2 and 5 are written beside the powers of ten


@picture("Of any model.")
def stress_distribution(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Probability density of the local pressure, a line for each state: select those to be shown."""
    return _densities(dataset, "pressure", axes)


@picture("Of any model.")
def gap_distribution(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Probability density of the local gap."""
    return _densities(dataset, "gap", axes)


def _densities(dataset: xr.Dataset, of: str, axes: Axes | None) -> Axes:
    name, along = f"{of}_pdf", f"{of}_bin"
    unit_of, symbol, density = DENSITIES[of]
    require(dataset, name)
    axes = axes_of(axes)
    every = [(words, part[name].values) for words, part in lines(dataset.squeeze(), name, along)]
    shown = [(words, pdf) for words, pdf in every if np.nansum(pdf) > 0]  # Persson's theory has no gaps
    values = dataset[along].values
    least = LEAST * max((style.largest(pdf) for _, pdf in shown), default=0.0)
    present = np.any([pdf > least for _, pdf in shown], axis=0) if shown else np.zeros(values.size, bool)
    unit = unit_of(style.largest(values[present]))
    for number, (words, pdf) in enumerate(shown):
        drawn = np.where(pdf > least, pdf, np.nan) * unit.size
        axes.semilogy(values / unit.size, drawn, color=COLOURS[number % len(COLOURS)], lw=1.0, label=words or None)
    axes.set(xlabel=f"{symbol} ({unit.name})", ylabel=rf"${density}$ (1/{unit.name})")
    style.add_legend(axes)
    return axes


@picture("One surface of a simulation with its fields.")
def surface_spectrum(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Power spectrum C(q) of the surface, averaged over directions and bands of an eighth of an octave.

    The figure shows the self-affine law of the dataset, or else the best fit, beside it. For heights
    whose edges do not meet it is the spectrum of the map joined to its mirror images.

    Convention: h_rms² = 2π ∫ q C dq.
    """
    surface = one_state(dataset, "height")
    grid = Grid(surface["height"].shape, extent(surface))
    spectrum = statistics.roughness_of_sample(surface["height"].values, grid).spectrum
    if not spectrum.density.any():
        raise ValueError("the surface is flat: it has no spectrum")
    law = [float(surface[name]) for name in _LAW if name in surface]
    given = len(law) == len(_LAW)
    fit = statistics.law_through(spectrum, *law) if given else statistics.self_affine_fit(spectrum)
    return draw_spectrum(spectrum, fit, axes_of(axes))


def draw_roughness(sample: statistics.Roughness, axes: Axes) -> None:
    """Draw the spectrum of a surface with its self-affine law; a flat one has none."""
    if sample.rms_height > 0:
        draw_spectrum(sample.spectrum, sample.fit, axes)
    else:
        axes.set_axis_off()


def draw_spectrum(spectrum: statistics.PowerSpectrum, fit: statistics.SelfAffineFit | None, axes: Axes) -> Axes:
    """Draw a spectrum that has some power, and the self-affine law of it."""
    shown = spectrum.density > _ROUNDING * spectrum.density.max()
    axes.loglog(spectrum.wavevectors[shown], spectrum.density[shown], ".-", color=COLOURS[0], ms=3, lw=0.8)
    if fit is not None:
        q = np.geomspace(spectrum.wavevectors[0], fit.cutoff, 100)
        law = fit.density * np.maximum(q / fit.roll_off, 1) ** (-2 - 2 * fit.hurst_exponent)
        words = f"H = {fit.hurst_exponent:.2f} ± {fit.uncertainty:.2f}, down to {length(2 * np.pi / fit.cutoff)}"
        axes.loglog(q, law, color=COLOURS[1], lw=1.0, label=words)
        axes.legend()
    style.readable_decades(axes.xaxis)
    axes.set(xlabel=r"wavevector $q$ (m$^{-1}$)", ylabel=r"power spectrum $C(q)$ (m$^4$)")
    return axes


@picture("Of Persson's theory.")
def area_by_magnification(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Apparent relative contact area A(ζ), a line for each state: select those to be shown."""
    axes = _magnified(dataset, "relative_contact_area_at", r"contact area $A(\zeta)/A_0$", axes)
    axes.set_ylim(0, None)
    return axes


@picture("Of Persson's theory.")
def detachment_stress(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Detachment stress σ_a(ζ)."""
    return _magnified(dataset, "detachment_stress", r"detachment stress $\sigma_\mathrm{a}$", axes)


@picture("Of Persson's theory.")
def effective_work_of_adhesion(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Effective work of adhesion γ_eff(ζ)."""
    axes = _magnified(dataset, "effective_work_of_adhesion", r"work of adhesion $\gamma_\mathrm{eff}$", axes)
    if axes.get_ylim()[0] < 0 < axes.get_ylim()[1]:
        axes.axhline(0, color="#909090", lw=0.7, zorder=1)
    return axes


def _magnified(dataset: xr.Dataset, name: str, words: str, axes: Axes | None) -> Axes:
    require(dataset, name)
    axes = axes_of(axes)
    squeezed = dataset.squeeze()
    most, unit = style.largest(squeezed[name]), Unit("", 1.0)
    if name == "detachment_stress":
        unit = style.pressure_unit(most)
    elif name == "effective_work_of_adhesion":
        unit = Unit("J/m²", 1.0) if most >= 0.1 else Unit("mJ/m²", 1e-3)
    for number, (label, part) in enumerate(lines(squeezed, name, "wavevector", "wavevector_index")):
        q, y = part["wavevector"].values, part[name].values / unit.size
        there = np.isfinite(q)
        axes.plot(q[there] / q[0], y[there], color=COLOURS[number % len(COLOURS)], lw=1.1, label=label or None)
    axes.set_ylabel(f"{words} ({unit.name})" if unit.name else words)
    _scale_magnification(axes)
    style.add_legend(axes)
    return axes


@picture("One state of Persson's theory, of a study with ``theory.magnifications``, such as ``dataset.sel(step=3)``.")
def stress_by_magnification(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Map of P(σ, ζ): how the stress distribution of one state spreads while the magnification grows.

    At ζ = 1 all stress is the mean pressure. Colours span four decades; smaller densities stay white.
    """
    require(dataset, "pressure_pdf_at")
    state = dataset.squeeze()
    # Where magnifications differ over a sweep they are numbered.
    single(state, "pressure_pdf_at", ("pressure_bin", "magnification", "magnification_index"), "state")
    stress, zeta = state["pressure_bin"].values, state["magnification"].values
    there = np.isfinite(zeta)  # states of fewer magnifications are padded
    density, zeta = state["pressure_pdf_at"].transpose("pressure_bin", ...).values[:, there], zeta[there]
    peak = np.nanmax(density, initial=0.0)
    if not peak > 0:
        raise ValueError("the state has no stress distribution: nothing is in contact")
    shown = np.flatnonzero((density > _COLOURED * peak).any(axis=1))
    stress, density = stress[shown[0] : shown[-1] + 1], density[shown[0] : shown[-1] + 1]
    unit = style.pressure_unit(style.largest(stress))
    axes = axes_of(axes)
    middles = np.sqrt(zeta[1:] * zeta[:-1])
    edges = np.concatenate([[zeta[0] ** 2 / middles[0]], middles, [zeta[-1]]]) if zeta.size > 1 else [1.0, zeta[0]]
    half = 0.5 * (stress[1] - stress[0])
    mesh = axes.pcolormesh(
        edges,
        np.append(stress - half, stress[-1] + half) / unit.size,
        np.ma.masked_less_equal(density * unit.size, _COLOURED * peak * unit.size),
        norm=LogNorm(_COLOURED * peak * unit.size, peak * unit.size),
        cmap="viridis",
        rasterized=True,
    )
    axes.set_ylabel(rf"stress $\sigma$ ({unit.name})")
    _scale_magnification(axes)
    axes.grid(False)
    axes.figure.colorbar(mesh, ax=axes, label=rf"$P(\sigma, \zeta)$ (1/{unit.name})")
    return axes


def _scale_magnification(axes: Axes) -> None:
    """Logarithmic, in plain numbers: one to a few thousand is what surfaces have."""
    axes.set(xscale="log", xlabel=r"magnification $\zeta$")
    low, high = axes.get_xlim()
    style.plain_decades(axes.xaxis, high < _FEW * low)
