"""Force curves: the force on a body against its displacement, approach and retraction."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.plots import style
from contact_study.plots.measured_curves import draw_measured, measured_states
from contact_study.plots.selection import fit_states, lines, require
from contact_study.plots.sphere_theories import draw_theories, sphere_theories
from contact_study.plots.style import COLOURS, axes_of, force_unit, picture

_AXES = {
    "displacement": r"displacement $\delta$",
    "contact_radius": "contact radius $a$",
    "approach": "approach of the machine",
}
# What the load prescribes, and its direction where the body approaches.
_INWARDS = {"applied_approach": 1.0, "applied_pressure": 1.0, "applied_gap": -1.0}


@picture("One of the boundary elements with their displacement.")
def force_curve(
    dataset: xr.Dataset,
    axes: Axes | None = None,
    against: str = "displacement",
    measured: Sequence[xr.Dataset] = (),
    theories: Sequence[str] = (),
) -> Axes:
    """Force over displacement, a line for each point of the sweep; approach dashed, retraction solid.

    An approach after a retraction is dash-dotted.
    All states that adaptive steps passed are shown. A single curve has its pull-off marked. Measured points are
    circles, filled on retraction.

    Parameters
    ----------
    against : {"displacement", "contact_radius", "approach"}, optional
        Displacement of the body, radius of the contact, or displacement of the machine beyond its stiffness
        (``loading.machine_stiffness``).
    measured : sequence of xarray.Dataset, optional
        Measured curves, of :func:`contact_study.read_force_curve`.
    theories : sequence of str, optional
        Theories of a smooth sphere, ``"hertz"``, ``"jkr"``, ``"dmt"``, ``"maugis"``, of a study that has one.
    """
    if against not in _AXES:
        raise ValueError(f"against = {against!r}: must be {' or '.join(map(repr, _AXES))}")
    if against == "approach" and (measured or theories):
        raise ValueError("measured curves and theories have no approach of a machine; use 'displacement'")
    require(dataset, "total_force", against)
    curves = [(words, *force_states(part, against)) for words, part in lines(dataset, against, "step")]
    spheres = sphere_theories(dataset, theories) if theories else {}
    others = [measured_states(one, against) for one in measured]
    forces = np.concatenate([*(y for _, _, y, _ in curves), *(other.force for other in others)])
    force = force_unit(style.largest(forces))
    length = style.length_unit(style.largest(np.concatenate([*(x for _, x, _, _ in curves), *(o.x for o in others)])))
    axes, ways = axes_of(axes), 1
    for number, (words, x, y, outwards) in enumerate(curves):
        colour, named = COLOURS[number % len(COLOURS)], words
        turns = np.cumsum(np.diff(outwards, prepend=False))
        for turn in range(turns[-1] + 1):
            own = turns == turn
            if np.isfinite(y[own]).any():
                # A way begins at the state before it.
                drawn = np.where(own | np.append(own[1:], False), y, np.nan) / force.size
                look = "--" if turn == 0 else "-" if turn % 2 else "-."
                axes.plot(x / length.size, drawn, look, color=colour, lw=1.0, label=named or None)
                named, ways = "", max(ways, turn + 1)
    if len(curves) == 1 and "pull_off_force" in dataset and np.isfinite(dataset["pull_off_force"].values).all():
        _, x, y, _ = curves[0]
        lowest, value = int(np.nanargmin(y)), dataset["pull_off_force"].values.item()
        label = f"pull-off {-value / force.size:.3g} {force.name}"
        if against != "contact_radius" or np.isclose(y[lowest], value):  # radii are known of points of the path alone
            axes.plot(x[lowest] / length.size, value / force.size, "v", color=COLOURS[1], ms=5, zorder=4, label=label)
    if ways > 1:
        names = "first approach" if ways > 2 else "approach", "retraction", "later approach"
        for label, look in list(zip(names, ("--", "-", "-."), strict=True))[:ways]:
            axes.plot([], [], look, color="#404040", lw=1.0, label=label)
    for number, other in enumerate(others):
        draw_measured(axes, other, COLOURS[(len(curves) + 1 + number) % len(COLOURS)], (length, force))
    if spheres:
        draw_theories(axes, spheres, against, float(np.nanmax(forces)), (length, force))
    style.add_legend(axes)
    axes.axhline(0, color="#909090", lw=0.7, zorder=1)
    axes.set(xlabel=f"{_AXES[against]} ({length.name})", ylabel=f"force $F$ ({force.name})")
    return axes


def force_states(part: xr.Dataset, against: str = "displacement") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return displacement (m), force (N) and whether on a way outwards, of each state of one path in contact or before.

    ``against`` is as in :func:`force_curve`. States that did not converge or have detached are NaN. A dwell belongs to
    the way before it.
    """
    fit = fit_states(part)
    x, y = (np.where(fit, part[name].values, np.nan) for name in (against, "total_force"))
    prescribed, way = next((part[name].values, sign) for name, sign in _INWARDS.items() if name in part.coords)
    moved = np.diff(way * prescribed, prepend=np.nan)
    latest = np.maximum.accumulate(np.where(moved != 0, np.arange(moved.size), 0))
    outwards = moved[latest] < 0
    if against == "contact_radius" or "passed_pressure" not in part or not fit.any():
        return x, y, outwards
    pressure, separation = (part[f"passed_{name}"].values for name in ("pressure", "separation"))
    outwards = np.broadcast_to(outwards[:, None], pressure.shape)
    known = np.isfinite(pressure) & np.isfinite(separation)
    one = int(np.argmax(np.abs(np.nan_to_num(y))))  # the state of the largest force gives area and spring
    scale = part["mean_pressure"].values[one]
    area = y[one] / scale if scale else 0.0
    x = (part["displacement"] + part["mean_separation"]).values[one] - separation
    if against == "approach":
        spring = (part["approach"] - part["displacement"]).values[one] / scale if scale else 0.0
        x = x + spring * pressure
    return x[known], area * pressure[known], outwards[known]
