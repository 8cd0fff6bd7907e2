"""Points of measured force curves."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.plots.selection import UNLOADING, require
from contact_study.plots.style import Unit

_MANY = 150  # points from which they are dots


class MeasuredStates(NamedTuple):
    """Points of a measured curve (SI), as it is drawn."""

    title: str
    x: np.ndarray
    force: np.ndarray
    errors: tuple[np.ndarray | None, np.ndarray | None]  # along x and of the force
    unloading: np.ndarray


def measured_states(curve: xr.Dataset, against: str) -> MeasuredStates:
    """Points of a curve that :func:`contact_study.read_force_curve` read; ValueError without the wanted quantity."""
    title = str(curve.attrs.get("title", "measured"))
    try:
        require(curve, "total_force", against)
    except ValueError as error:
        raise ValueError(f"{title}: {error}; draw it against another quantity") from None
    x, force = curve[against].values, curve["total_force"].values
    errors = [
        curve[f"{name}_uncertainty"].values if f"{name}_uncertainty" in curve else None
        for name in (against, "total_force")
    ]
    back = curve["branch"].values == UNLOADING if "branch" in curve else np.zeros(x.shape, bool)
    return MeasuredStates(title, x, force, (errors[0], errors[1]), back)


def draw_measured(axes: Axes, states: MeasuredStates, colour: str, units: tuple[Unit, Unit]) -> None:
    """Draw circles, filled on retraction, with error bars of known uncertainties; units are of x and of the force."""
    many = states.x.size > _MANY
    look: Any = {"ls": "none", "ms": 2.0 if many else 3.5, "mew": 0.5 if many else 0.8, "color": colour, "zorder": 2.5}
    title = states.title
    for part, fill in ((~states.unloading, "white"), (states.unloading, colour)):
        if not part.any():
            continue
        x, y = states.x[part] / units[0].size, states.force[part] / units[1].size
        along, up = (
            None if error is None else error[part] / unit.size for error, unit in zip(states.errors, units, strict=True)
        )
        axes.errorbar(x, y, up, along, marker="o", mfc=fill, elinewidth=0.6, label=title or None, **look)
        title = ""
