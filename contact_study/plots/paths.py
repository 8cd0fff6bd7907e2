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

    def where(self, shown: np.ndarray) -> "Curve":
        """The curve without the states that are not to be shown."""
        return replace(self, x=np.where(shown, self.x, np.nan))

    @property
    def fits(self) -> np.ndarray:
        """Whether each state converged in contact."""
        return np.ones(self.x.shape, bool) if self.fit is None else self.fit

    @property
    def back(self) -> np.ndarray:
        """Whether each state is on unloading."""
        return np.zeros(self.x.shape, bool) if self.unloading is None else self.unloading

    @property
    def finite(self) -> np.ndarray:
        """Whether each state can be shown."""
        return np.isfinite(self.x) & np.isfinite(self.y)


def path_segments(curve: Curve) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lines that join the states of a curve in the order of the path, each once: two of them retraced hide dashes.

    Ends (x, y) of every segment, shape (n, 2, 2); whether it leads to unloading; whether a line passes each state.
    """
    ends: list[np.ndarray] = []
    unloading: list[bool] = []
    joined = np.zeros(curve.x.shape, bool)
    for last, here in _followed(curve):
        joined[[last, here]] = True
        segment = np.array([[curve.x[last], curve.y[last]], [curve.x[here], curve.y[here]]])
        if not any(_retraces(segment, other) for other in ends):
            ends.append(segment)
            unloading.append(bool(curve.back[here]))
    return np.array(ends).reshape(-1, 2, 2), np.array(unloading, bool), joined


def error_band(curve: Curve) -> np.ndarray:
    """The strip of one standard error beside the lines of a curve: corners (x, y) along every segment, (n, 4, 2).

    Visible errors along both axes make no strip, and none has a state whose error is not known.
    """
    x_error, y_error = _visible(curve.x_error, curve.x), _visible(curve.y_error, curve.y)
    if (x_error is None) == (y_error is None):
        return np.empty((0, 4, 2))
    none = np.zeros(curve.x.shape)
    across = np.stack([none if x_error is None else x_error, none if y_error is None else y_error], axis=1)
    points = np.stack([curve.x, curve.y], axis=1)
    low, high = points - across, points + across
    strips = [[low[last], low[here], high[here], high[last]] for last, here in _followed(curve)]
    found = np.array(strips).reshape(-1, 4, 2)
    return found[np.isfinite(found).all(axis=(1, 2))]


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
            style: Any = {"linestyles": [look.line], "linewidths": look.line_width, "alpha": alpha, "zorder": order}
            axes.add_collection(LineCollection(_chains(segments[side]), colors=colour, **style))
    # Larger and below: where unloading retraces loading both are seen.
    sides = (~curve.back, "none" if look.hollow else colour, look.marker, 0.0), (curve.back, "white", "v", 3.0)
    for side, fill, marker, larger in sides:
        here = curve.fits & side & curve.finite
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
                marker=marker if look.marker else ".",
                ms=look.marker_size + larger,
                mfc=fill,
                mew=0.9,
                elinewidth=0.7,
                capsize=1.5,
                zorder=order - 0.1 * (larger > 0),
                label=label or None,
            )
            label = ""
    left = ~curve.fits & curve.finite
    if left.any():
        axes.plot(curve.x[left], curve.y[left], "x", color=colour, ms=5, mew=1.2, zorder=4)


def draw_strip(axes: Axes, strip: np.ndarray, colour: Any, opacity: float, order: float) -> None:
    """Shade what :func:`error_band` gives."""
    axes.add_collection(PolyCollection(list(strip), facecolors=[colour], alpha=opacity, linewidths=0, zorder=order))


def _visible(error: np.ndarray | None, values: np.ndarray) -> np.ndarray | None:
    """Errors, unless all are less than a dot: what is prescribed is met to the solver's tolerance."""
    finite = values[np.isfinite(values)]
    if error is None or not finite.size or np.nanmax(error, initial=0.0) <= _DOT * np.ptp(finite):
        return None
    return error


def _followed(curve: Curve) -> list[tuple[int, int]]:
    """Numbers of the states that lines join, in the order of the path."""
    pairs, last = [], None
    for here in range(curve.x.size):
        if not curve.fits[here]:
            last = None
        elif curve.finite[here]:
            if last is not None:
                pairs.append((last, here))
            last = here
    return pairs


def _retraces(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two segments are the same, in either direction, to a dot of the figures."""
    return any(np.allclose(one, ends, rtol=_DOT, atol=0.0) for ends in (other, other[::-1]))


def _chains(segments: np.ndarray) -> list[np.ndarray]:
    """Lines of as many segments as follow one another: dashes continue over their corners."""
    chains: list[list[np.ndarray]] = []
    for first, second in segments:
        if chains and np.array_equal(chains[-1][-1], first):
            chains[-1].append(second)
        else:
            chains.append([first, second])
    return [np.array(chain) for chain in chains]


def _at(error: np.ndarray | None, here: np.ndarray) -> np.ndarray | None:
    return None if error is None else np.nan_to_num(error[here])
