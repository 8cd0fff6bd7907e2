"""How every figure looks: sizes, fonts, lines, colours, and units that read well."""

from collections.abc import Callable
from dataclasses import dataclass
from inspect import cleandoc
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatterSciNotation, LogLocator, NullFormatter

from contact_study.inputs.errors import InputError

RESOLUTION = 200  # dots per inch
SINGLE, DOUBLE = 3.46, 7.0  # inches: one and two columns of a journal

# Okabe and Ito: distinguishable with any colour vision.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")

STYLE = {
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

styled = rc_context(STYLE)
"""Decorator: draw in the common style without changing the caller's settings."""

Draw = TypeVar("Draw", bound=Callable[..., Any])

_DOCUMENTATION = """
Parameters
----------
dataset : xarray.Dataset
    {dataset}
{own}axes : matplotlib.axes.Axes, optional
    Where to draw, by default a new figure.

Returns
-------
matplotlib.axes.Axes
    The axes drawn on.

Raises
------
ValueError
    If the dataset lacks what is to be shown, or holds more than that.

Examples
--------
>>> import xarray as xr
>>> from contact_study import plots
>>> plots.{name}({example})  # doctest: +SKIP
"""


def picture(dataset: str, example: str = 'xr.open_dataset("bem.nc")') -> Callable[[Draw], Draw]:
    """Style a picture, and complete its docstring, which has its own parameters only, with what dataset it takes."""

    def made(draw: Draw) -> Draw:
        summary, _, own = cleandoc(draw.__doc__ or "").partition("Parameters\n----------\n")
        own = f"{own}\n" if own else ""
        known = {"dataset": dataset, "own": own, "name": draw.__name__, "example": example}
        draw.__doc__ = summary.rstrip() + "\n" + _DOCUMENTATION.format(**known)
        return styled(draw)

    return made


def readable_decades(axis: Axis) -> None:
    """Name 2 and 5 of a logarithmic axis, too, where it has few decades, and no more."""
    axis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    axis.set_minor_formatter(LogFormatterSciNotation(minor_thresholds=(1.5, 1.5)))


def plain_decades(axis: Axis, few: bool) -> None:
    """Write the decades of a logarithmic axis in plain numbers, with 2 and 5 where they are few."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def add_legend(axes: Axes) -> None:
    """Explain what has a name, if anything has."""
    if axes.get_legend_handles_labels()[1]:
        axes.legend()


def axes_of(axes: Axes | None, width: float = SINGLE, height: float = 2.8) -> Axes:
    """The given axes, or those of a new figure outside of pyplot (inches)."""
    return Figure(figsize=(width, height), layout="constrained").subplots() if axes is None else axes


def format_of(path: Path, option: str) -> str:
    """The format of a picture by its name; InputError, of an option, if matplotlib does not write it."""
    kind, known = path.suffix.lstrip(".").lower(), Figure().canvas.get_supported_filetypes()
    if kind not in known:
        raise InputError(f"{option} {path}: expected a name that ends in {', '.join(known)}")
    return kind


@dataclass(frozen=True)
class Unit:
    """A unit to show a quantity in: its name and its size in SI."""

    name: str
    size: float


def largest(values: Any) -> float:
    """The largest finite magnitude, zero without one."""
    magnitudes = np.abs(np.asarray(values))
    return float(magnitudes.max(initial=0.0, where=np.isfinite(magnitudes)))


def length_unit(most: float) -> Unit:
    """The unit in which lengths up to ``most`` (m) read well."""
    sizes = (("Å", 1e-10, 1e-9), ("nm", 1e-9, 1e-6), ("µm", 1e-6, 1e-3), ("mm", 1e-3, 1.0))
    return next((Unit(name, size) for name, size, limit in sizes if most < limit), Unit("m", 1.0))


def pressure_unit(most: float) -> Unit:
    """The unit in which pressures up to ``most`` (Pa) read well."""
    sizes = (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3))
    return next((Unit(name, size) for name, size in sizes if most >= size), Unit("Pa", 1.0))


def force_unit(most: float) -> Unit:
    """The unit in which forces up to ``most`` (N) read well."""
    sizes = (("kN", 1e3), ("N", 1.0), ("mN", 1e-3), ("µN", 1e-6), ("nN", 1e-9))
    return next((Unit(name, size) for name, size in sizes if most >= size), Unit("pN", 1e-12))
