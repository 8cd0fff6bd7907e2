"""Persson's theory against magnification: area, detachment stress, work of adhesion, and the stress distribution."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.ticker import LogLocator, NullFormatter

from contact_study.plots.selection import lines, require
from contact_study.plots.style import COLOURS, Unit, add_legend, axes_of, picture, pressure_unit

_DECADES = 4  # of the density that colours distinguish

_FEW = 100.0  # magnifications up to which 2 and 5 are written beside the powers of ten

# Dimension of the magnifications: their own, or where these differ over a sweep that of their numbers.
_ALONG = ("magnification", "magnification_index")

_ZETA = r"magnification $\zeta$"


@picture("Of Persson's theory.")
def area_by_magnification(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Apparent relative contact area A(ζ), a line for each state: select those to be shown."""
    words = r"contact area $A(\zeta)/A_0$"
    axes = _curves(dataset, "relative_contact_area_at", lambda largest: Unit("", 1.0), words, axes)
    axes.set_ylim(0, None)
    return axes


@picture("Of Persson's theory.")
def detachment_stress(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Detachment stress σ_a(ζ)."""
    return _curves(dataset, "detachment_stress", pressure_unit, r"detachment stress $\sigma_\mathrm{a}$", axes)


@picture("Of Persson's theory.")
def effective_work_of_adhesion(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Effective work of adhesion γ_eff(ζ)."""
    axes = _curves(
        dataset,
        "effective_work_of_adhesion",
        lambda largest: Unit("J/m²", 1.0) if largest >= 0.1 else Unit("mJ/m²", 1e-3),
        r"work of adhesion $\gamma_\mathrm{eff}$",
        axes,
    )
    if axes.get_ylim()[0] < 0 < axes.get_ylim()[1]:
        axes.axhline(0, color="#909090", lw=0.7, zorder=1)
    return axes


@picture("One state of Persson's theory, of a study with ``theory.magnifications``, such as ``dataset.sel(step=3)``.")
def stress_by_magnification(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Map of P(σ, ζ): how the stress distribution of one state spreads while the magnification grows.

    At ζ = 1 all stress is the mean pressure. Colours span four decades; smaller densities stay white.
    """
    if "pressure_pdf_at" not in dataset:
        raise ValueError("the dataset has no variable 'pressure_pdf_at'; it is kept with theory.magnifications = 48")
    state = dataset.squeeze()
    others = [dim for dim in state["pressure_pdf_at"].dims if dim not in ("pressure_bin", *_ALONG)]
    if others:
        raise ValueError(f"the dataset has more than one state: select one along {others[0]!r} first")
    stress, zeta = state["pressure_bin"].values, state["magnification"].values
    there = np.isfinite(zeta)  # states of fewer magnifications are padded
    density, zeta = state["pressure_pdf_at"].transpose("pressure_bin", ...).values[:, there], zeta[there]
    peak = np.nanmax(density, initial=0.0)
    if not peak > 0:
        raise ValueError("the state has no stress distribution: nothing is in contact")
    shown = np.flatnonzero((density > 10.0**-_DECADES * peak).any(axis=1))
    stress, density = stress[shown[0] : shown[-1] + 1], density[shown[0] : shown[-1] + 1]
    unit = pressure_unit(float(np.abs(stress).max()))
    axes = axes_of(axes)
    middles = np.sqrt(zeta[1:] * zeta[:-1])
    edges = np.concatenate([[zeta[0] ** 2 / middles[0]], middles, [zeta[-1]]]) if zeta.size > 1 else [1.0, zeta[0]]
    half = 0.5 * (stress[1] - stress[0])
    mesh = axes.pcolormesh(
        edges,
        np.append(stress - half, stress[-1] + half) / unit.size,
        np.ma.masked_less_equal(density * unit.size, 10.0**-_DECADES * peak * unit.size),
        norm=LogNorm(10.0**-_DECADES * peak * unit.size, peak * unit.size),
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
    axes.set(xscale="log", xlabel=_ZETA)
    low, high = axes.get_xlim()
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < _FEW * low else (1.0,)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())


def _curves(dataset: xr.Dataset, name: str, unit_of: Callable[[float], Unit], words: str, axes: Axes | None) -> Axes:
    require(dataset, name)
    axes = axes_of(axes)
    squeezed = dataset.squeeze()
    values = squeezed[name].values
    unit = unit_of(float(np.abs(values[np.isfinite(values)]).max(initial=0.0)))
    for number, (label, part) in enumerate(lines(squeezed, name, "wavevector", "wavevector_index")):
        q, y = part["wavevector"].values, part[name].values
        there = np.isfinite(q)
        axes.plot(
            q[there] / q[0], y[there] / unit.size, color=COLOURS[number % len(COLOURS)], lw=1.1, label=label or None
        )
    axes.set_ylabel(f"{words} ({unit.name})" if unit.name else words)
    _scale_magnification(axes)
    add_legend(axes)
    return axes
