"""Curves along a loading path: their lines, markers and strips of errors, and the window of their axes."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

ERROR = 0.25  # opacity of a strip of standard errors
_DOT = 2e-3  # of an axis: what is less than a dot of the figure is not seen


@dataclass(frozen=True)
class Look:
    """Line and marker of a curve, and the model that they stand for."""

    line: Any = "-"  # as matplotlib knows it, ``"none"`` for markers alone
    marker: str = "o"  # empty for a line alone
    marker_size: float = 3.2  # in points
    line_width: float = 0.9
    hollow: bool = False  # whether markers are not filled
    behind: bool = False  # whether all is drawn behind others
    label: str = ""  # name of the model in a legend
    colour: str = "#0072B2"  # of the model, where colours mean nothing else


@dataclass(frozen=True)
class Curve:
    """One curve over the states of a path."""

    model: str  # model that it is of
    label: str  # what its colour stands for
    colour: int  # number of the colour
    x: np.ndarray  # what is plotted, NaN where nothing is
    y: np.ndarray
    x_error: np.ndarray | None = None  # standard errors of the plotted quantities
    y_error: np.ndarray | None = None
    fit: np.ndarray | None = None  # false where the state did not converge or has detached
    unloading: np.ndarray | None = None  # whether a point is on unloading
    simulated: bool = True  # whether it is of a simulation; theories reach beyond any sampling
    look: Look = Look()

    @property
    def fits(self) -> np.ndarray:
        return np.ones(self.x.shape, bool) if self.fit is None else self.fit

    @property
    def back(self) -> np.ndarray:
        return np.zeros(self.x.shape, bool) if self.unloading is None else self.unloading

    @property
    def finite(self) -> np.ndarray:
        return np.isfinite(self.x) & np.isfinite(self.y)


def path_segments(curve: Curve) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lines that join the states of a curve in the order of the path, each once: two of them retraced hide dashes.

    Ends (x, y) of every segment, shape (n, 2, 2); whether it leads to unloading; whether a line passes each state.
    """
    pairs = _followed(curve)
    joined = np.isin(np.arange(curve.x.size), pairs)
    segments = np.stack([curve.x, curve.y], axis=1)[pairs]
    once: list[int] = []
    for number, one in enumerate(segments):
        others = (ends for other in once for ends in (segments[other], segments[other][::-1]))
        if not any(np.allclose(one, ends, rtol=_DOT, atol=0.0) for ends in others):
            once.append(number)
    return segments[once], curve.back[pairs[once, 1]], joined


def error_band(curve: Curve) -> np.ndarray:
    """The strip of one standard error beside the lines of a curve: corners (x, y) along every segment, (n, 4, 2).

    Visible errors along both axes make no strip, and none has a state whose error is not known.
    """
    across = np.stack([_visible(curve.x_error, curve.x), _visible(curve.y_error, curve.y)], axis=1)
    if across[:, 0].any() == across[:, 1].any():
        return np.empty((0, 4, 2))
    points = np.stack([curve.x, curve.y], axis=1)
    low, high = points - across, points + across
    last, here = _followed(curve).T
    found = np.stack([low[last], low[here], high[here], high[last]], axis=1)
    return found[np.isfinite(found).all(axis=(1, 2))]


def draw_strip(axes: Axes, strip: np.ndarray, colour: Any, opacity: float, order: float) -> None:
    """Shade what :func:`error_band` gives."""
    axes.add_collection(PolyCollection(list(strip), facecolors=[colour], alpha=opacity, linewidths=0, zorder=order))


def draw_path(axes: Axes, curve: Curve, look: Look, colour: Any, label: str = "") -> None:
    """Draw the states along a path: unloading in hollow triangles on a fainter line, crosses where not converged."""
    order = 2 if look.behind else 3
    segments, back, joined = path_segments(curve)
    if look.line != "none" and len(strip := error_band(curve)):
        draw_strip(axes, strip, colour, ERROR, 1)
        if joined[curve.fits].all():
            curve = replace(curve, x_error=None, y_error=None)
    for side, alpha in ((~back, 1.0), (back, 0.5)):
        if side.any() and look.line != "none":
            own = segments[side]
            # Lines of as many segments as follow one another: dashes continue over their corners.
            chains = np.split(own, np.flatnonzero((own[1:, 0] != own[:-1, 1]).any(axis=1)) + 1)
            points = [np.concatenate([chain[:1, 0], chain[:, 1]]) for chain in chains]
            line: Any = {"linestyles": [look.line], "linewidths": look.line_width, "alpha": alpha, "zorder": order}
            axes.add_collection(LineCollection(points, colors=colour, **line))
    # Larger and below: where unloading retraces loading both are seen.
    sides = (~curve.back, "none" if look.hollow else colour, look.marker, 0.0), (curve.back, "white", "v", 3.0)
    for side, fill, marker, larger in sides:
        here = curve.fits & side & curve.finite
        if not look.marker:  # a line needs two states; one that stands alone is a dot
            here &= ~joined
        if here.any():
            errors = {"xerr": curve.x_error, "yerr": curve.y_error}
            bars: Any = {name: np.nan_to_num(own[here]) for name, own in errors.items() if own is not None}
            style = {"color": colour, "ls": "none", "mfc": fill, "mew": 0.9, "elinewidth": 0.7, "capsize": 1.5}
            style |= {"marker": marker if look.marker else ".", "ms": look.marker_size + larger, "label": label or None}
            axes.errorbar(curve.x[here], curve.y[here], **bars, zorder=order - 0.1 * (larger > 0), **style)
            label = ""
    left = ~curve.fits & curve.finite
    if left.any():
        axes.plot(curve.x[left], curve.y[left], "x", color=colour, ms=5, mew=1.2, zorder=4)


def _visible(error: np.ndarray | None, values: np.ndarray) -> np.ndarray:
    """Errors, none if all are less than a dot: what is prescribed is met to the solver's tolerance."""
    finite = values[np.isfinite(values)]
    if error is None or not finite.size or np.nanmax(error, initial=0.0) <= _DOT * np.ptp(finite):
        return np.zeros(values.shape)
    return error


def _followed(curve: Curve) -> np.ndarray:
    """Numbers of the states that lines join, in the order of the path, (n, 2): none over one that did not converge."""
    seen = np.flatnonzero(curve.finite | ~curve.fits)
    pairs = np.stack([seen[:-1], seen[1:]], axis=1)
    return pairs[curve.fits[pairs].all(axis=1)]
