"""Thermal states of one point of the path, read one after the other: their means, errors and series."""

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.numerics.time_series import LEAST_STATES, statistics_of
from contact_study.results.observables import AVERAGED, observed
from contact_study.results.schema import (
    AUTOCORRELATION_STATES,
    AUTOCORRELATION_TIME,
    STANDARD_ERROR,
    TRAJECTORY,
    VARIABLES,
)
from contact_study.results.state import InterfaceState
from contact_study.results.step import Step

_SERIES, _SUMS, _BINS, _FIELDS, _RESTART = "series/", "sum/", "bins", "fields", "restart/"

_ALL_BUT_ONE = -1  # states discarded, where only the last one counts

# Has a series, and no mean.
_TIME = "time"


class Averages:
    """The observables of states that come one after the other.

    Parameters
    ----------
    bins : Bins
        Those of the study.
    fields : bool
        Whether the mean fields are kept.
    discarded : int or None, optional
        States before those that count; None: only the last one counts.
    """

    def __init__(self, bins: Bins, fields: bool, discarded: int | None = 0):
        self._bins = bins
        self._fields = fields
        self._discarded = discarded
        self._series: dict[str, list[Any]] = {}
        self._sums: dict[str, np.ndarray] = {}
        self._last: InterfaceState | None = None

    @classmethod
    def taken_up(cls, kept: Mapping[str, np.ndarray], bins: Bins, fields: bool) -> "Averages | None":
        """What :attr:`kept` was of; None if it is of other bins, or of other fields than are now wanted."""
        if not np.array_equal(kept[_BINS], np.ravel(bins.spans)) or bool(kept[_FIELDS][0]) != fields:
            return None
        discarded = int(kept[_FIELDS][1])
        averages = cls(bins, fields, None if discarded == _ALL_BUT_ONE else discarded)
        averages._series = {
            name.removeprefix(_SERIES): list(values) for name, values in kept.items() if name.startswith(_SERIES)
        }
        averages._sums = {
            name.removeprefix(_SUMS): values.copy() for name, values in kept.items() if name.startswith(_SUMS)
        }
        return averages

    def add(self, state: InterfaceState) -> None:
        """Count one more state."""
        self._last = state
        for name, value in observed(state, self._bins).items():
            if name in AVERAGED or name == _TIME:
                self._series.setdefault(name, []).append(value)
        if self._fields and self._counted > 0:
            for name, field in (("gap", state.gap), ("pressure", state.pressure)):
                more = name in self._sums and self._discarded is not None
                self._sums[name] = self._sums[name] + field if more else field.copy()

    @property
    def _counted(self) -> int:
        """How many states count so far; none if negative."""
        return 1 if self._discarded is None else len(next(iter(self._series.values()))) - self._discarded

    @property
    def kept(self) -> dict[str, np.ndarray]:
        """All that the average goes on from, with the restart of the last state; see :meth:`taken_up`."""
        assert self._last is not None
        return {
            _BINS: np.ravel(self._bins.spans),
            _FIELDS: np.array([int(self._fields), _ALL_BUT_ONE if self._discarded is None else self._discarded]),
            **{f"{_SERIES}{name}": np.array(values) for name, values in self._series.items()},
            **{f"{_SUMS}{name}": values for name, values in self._sums.items()},
            **{f"{_RESTART}{name}": values for name, values in self._last.restart.items()},
        }

    def step(self) -> Step:
        """Means with their standard errors, and the series of all that is one number.

        Once the surfaces are apart the last state is the answer, of which no mean is taken. Atoms one by one are those
        of the last state always: a mean of positions is no state.

        Warns
        -----
        UserWarning
            If the series is too short for its memory, or one state counts.
        """
        last = self._last
        assert last is not None
        report = {name: value for name, value in observed(last, self._bins).items() if name not in AVERAGED}
        series = {name: np.array(values) for name, values in self._series.items()}
        frames = {f"{TRAJECTORY}/{name}": values for name, values in series.items() if values.ndim == 1}
        if last.report.detached:
            fields = {"gap": last.gap, "pressure": last.pressure} if self._fields else {}
            return Step({**observed(last, self._bins), **frames}, {**fields, **last.atoms}, last.restart, self._bins)
        values: dict[str, Any] = {}
        untold: dict[str, float] = {}  # and how long they are remembered for at least, in states
        counted = self._counted
        memory, interval = _clock_of(series, counted)
        for name, whole in series.items():
            if name == _TIME:
                continue
            column = whole[-counted:]
            found = statistics_of(column)
            # Of a count or a flag the value that is nearest to the mean.
            values[name] = found.mean if VARIABLES[name].kind == "float" else np.rint(found.mean)
            if counted == 1:  # where a motion without noise has ended, or no error is told
                continue
            values[name + STANDARD_ERROR] = found.standard_error
            if column.ndim > 1:
                continue
            values[name + memory] = found.autocorrelation_time * interval if found.resolved else np.nan
            if not found.resolved and np.isfinite(column).all():
                untold[name] = float(found.autocorrelation_time)
        if counted == 1 and self._discarded is not None:
            warnings.warn(_single(memory), stacklevel=2)
        if untold:
            warnings.warn(_too_short(counted, interval, memory, untold), stacklevel=2)
        fields = {name: total / counted for name, total in self._sums.items()}
        return Step({**values, **report, **frames}, {**fields, **last.atoms}, last.restart, self._bins)


def _clock_of(series: Mapping[str, np.ndarray], counted: int) -> tuple[str, float]:
    """What the memory of a series is called, and what lies between two of its states, in s where they have a time."""
    if _TIME not in series:
        return AUTOCORRELATION_STATES, 1.0
    return AUTOCORRELATION_TIME, float(np.mean(np.diff(series[_TIME][-counted:]))) if counted > 1 else 0.0


def _single(memory: str) -> str:
    """That a point has no error."""
    more = "dynamics.frames" if memory == AUTOCORRELATION_TIME else "sampling.trajectories"
    return f"one state of a point counts: there is no mean and no standard error; raise {more}"


def _too_short(counted: int, interval: float, memory: str, untold: Mapping[str, float]) -> str:
    """That a point's states do not tell how long some of its numbers are remembered for, and how long at least."""
    moving = memory == AUTOCORRELATION_TIME
    span = f", {1e12 * counted * interval:.3g} ps," if moving else ""
    if counted < LEAST_STATES:
        return (
            f"the {counted} states of a point{span} are too few to tell an autocorrelation time, which takes "
            f"{LEAST_STATES}: their standard errors are guesses; raise "
            + ("dynamics.frames, of a short motion dynamics.duration, too" if moving else "sampling.trajectories")
        )
    name = max(untold, key=lambda name: untold[name])
    least = f"{1e12 * untold[name] * interval:.2g} ps" if moving else f"{untold[name]:.2g} states"
    more = f" and {len(untold) - 1} more" if len(untold) > 1 else ""
    longer = "dynamics.duration" if moving else "sampling.trajectories"
    return (
        f"the {counted} states of a point{span} are too few to tell the autocorrelation time "
        f"of {name}{more}, {least} at least: their standard errors need a series of twenty such times; raise {longer}"
    )


def restart_of(kept: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The restart of the last state that :attr:`Averages.kept` counts."""
    return {name.removeprefix(_RESTART): value for name, value in kept.items() if name.startswith(_RESTART)}
