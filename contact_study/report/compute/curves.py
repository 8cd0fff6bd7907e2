"""A curve of a figure and what is drawn of it: its lines, its strip of errors, the window of its axes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contact_study.report.models import entry_of


@dataclass(frozen=True)
class Curve:
    """One model's curve.

    Attributes
    ----------
    model : str
        Name of its entry.
    label : str
        What its colour stands for.
    colour : int
        Number of the colour.
    x, y : numpy.ndarray
        What is plotted, NaN where nothing is.
    x_error, y_error : numpy.ndarray or None
        Standard errors over seeds, of the plotted quantities.
    fit : numpy.ndarray of bool
        False where the state did not converge or has detached.
    unloading : numpy.ndarray of bool
        Whether a point is on the way back.
    """

    model: str
    label: str
    colour: int
    x: np.ndarray
    y: np.ndarray
    x_error: np.ndarray | None = None
    y_error: np.ndarray | None = None
    fit: np.ndarray | None = None
    unloading: np.ndarray | None = None


def mean_gap_panels(curves: Sequence[Curve], linear: Sequence[Curve]) -> list[str]:
    """Panels of figure 4, ``"logarithmic"`` where there is compression, ``"linear"`` where there is tension."""
    compressed = any(np.isfinite(curve.x + curve.y).any() for curve in curves)
    pulled = any((np.isfinite(curve.x) & (curve.y < 0)).any() for curve in linear)
    return [name for name, there in (("logarithmic", compressed), ("linear", pulled)) if there]


def in_compression(curves: Sequence[Curve]) -> bool:
    """Whether some curve of contact area over pressure has a state to show on logarithmic axes."""
    return any(((curve.x > 0) & (curve.y > 0)).any() for curve in curves)


def of_compression(curve: Curve) -> Curve:
    """A curve of contact area over pressure, for logarithmic axes."""
    return replace(curve, x=np.where((curve.x > 0) & (curve.y > 0), curve.x, np.nan))


def logarithmic(curve: Curve) -> Curve:
    """A curve of contact area over pressure in powers of ten, on both axes."""
    shown = of_compression(curve)
    positive = np.isfinite(shown.x)
    x, y = (np.log10(np.where(positive, values, 1.0)) for values in (shown.x, shown.y))
    return replace(shown, x=np.where(positive, x, np.nan), y=np.where(positive, y, np.nan))


def window(curves: Sequence[Curve], ended: int | None) -> np.ndarray:
    """Limits of x and y (two rows) that hold every state, or end below where the simulations end along one axis.

    Theories give numbers at any distance: on logarithmic axes they would press all else into a corner.

    Parameters
    ----------
    curves : sequence of Curve
        Some of it finite.
    ended : int or None
        0: x is ended, 1: y is, None: neither.
    """
    points = [np.stack([curve.x, curve.y]) for curve in curves]
    finite = [found[:, np.isfinite(found).all(axis=0)] for found in points]
    every = np.concatenate(finite, axis=1)
    if ended is not None:
        ends = [
            found[ended].min() for curve, found in zip(curves, finite, strict=True) if found.size and simulated(curve)
        ]
        every = every[:, every[ended] >= min(ends, default=-np.inf)]
    low, high = every.min(axis=1), every.max(axis=1)
    margin = np.where(high > low, 0.04 * (high - low), 0.5)
    return np.stack([low - margin, high + margin], axis=1)


def simulated(curve: Curve) -> bool:
    """Whether a curve is of a simulation: theories reach beyond any sampling."""
    return entry_of(curve.model).simulation


def path_segments(curve: Curve) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lines that join the states of a curve in the order of the path, each once: two of them retraced hide dashes.

    States that the axes do not show, being not finite, are passed over; one that is not ``fit`` ends the line.

    Returns
    -------
    numpy.ndarray, shape (number, 2, 2)
        Two ends (x, y) of every segment.
    numpy.ndarray of bool, shape (number,)
        Whether it leads to a state on the way back.
    numpy.ndarray of bool, shape (states,)
        Whether a line passes through a state.
    """
    back = np.zeros(curve.x.shape, bool) if curve.unloading is None else curve.unloading
    ends: list[np.ndarray] = []
    unloading: list[bool] = []
    joined = np.zeros(curve.x.shape, bool)
    for last, here in _followed(curve):
        joined[[last, here]] = True
        segment = np.array([[curve.x[last], curve.y[last]], [curve.x[here], curve.y[here]]])
        if not any(_retraces(segment, other) for other in ends):
            ends.append(segment)
            unloading.append(bool(back[here]))
    return np.array(ends).reshape(-1, 2, 2), np.array(unloading, bool), joined


def error_band(curve: Curve) -> np.ndarray:
    """The strip of one standard error to either side of a curve, between the states that its lines join.

    Visible errors along both axes make no strip, and none has a state whose error is not known.

    Returns
    -------
    numpy.ndarray, shape (number, 4, 2)
        Corners (x, y) of the strip's part along every segment.
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


def _visible(error: np.ndarray | None, values: np.ndarray) -> np.ndarray | None:
    """Errors, unless all are less than a dot of the figure: what is prescribed is met to the solver's tolerance."""
    finite = values[np.isfinite(values)]
    if error is None or not finite.size or np.nanmax(error, initial=0.0) <= 2e-3 * np.ptp(finite):
        return None
    return error


def _followed(curve: Curve) -> list[tuple[int, int]]:
    """Numbers of the states that lines join, in the order of the path."""
    fit = np.ones(curve.x.shape, bool) if curve.fit is None else curve.fit
    pairs, last = [], None
    for here in range(curve.x.size):
        if not fit[here]:
            last = None
        if not fit[here] or not np.isfinite(curve.x[here] + curve.y[here]):
            continue
        if last is not None:
            pairs.append((last, here))
        last = here
    return pairs


def _retraces(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two segments are the same, in either direction, to a dot of the figures."""
    return any(np.allclose(one, ends, rtol=2e-3, atol=0.0) for ends in (other, other[::-1]))


def smallest_resolved(curves: list[Curve]) -> float:
    """The smallest log₁₀ density that a simulation shows; theories reach below any sampling."""
    shown = [curve.y for curve in curves if simulated(curve)] or [curve.y for curve in curves]
    values = np.concatenate([np.empty(0), *shown])
    values = values[np.isfinite(values)]
    return float(max(values.min(), values.max() - 8)) if values.size else 0.0
