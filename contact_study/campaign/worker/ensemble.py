"""Averages over the states of one point of the path: means, standard errors, autocorrelation times, series."""

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
from contact_study.results.state import InterfaceState, Step

_SERIES, _SUMS, _BINS, _FIELDS, _RESTART = "series/", "sum/", "bins", "fields", "restart/"

_ALL_BUT_ONE = -1  # discarded states, if only the last one counts

# A quantity with a series and no mean.
_TIME = "time"


class Averages:
    """Averages of the observables of successive states after ``discarded`` ones; None: only the last state counts."""

    def __init__(self, bins: Bins, fields: bool, discarded: int | None = 0):
        self._bins = bins
        self._fields = fields
        self._discarded = discarded
        self._series: dict[str, list[Any]] = {}
        self._sums: dict[str, np.ndarray] = {}
        self._last: InterfaceState | None = None

    @classmethod
    def restored(cls, kept: Mapping[str, np.ndarray], bins: Bins, fields: bool) -> "Averages | None":
        """Restore the averages from :attr:`kept`; None if bins or fields have changed."""
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
        """Add a state."""
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
        """Number of averaged states so far; none if negative."""
        return 1 if self._discarded is None else len(next(iter(self._series.values()))) - self._discarded

    @property
    def kept(self) -> dict[str, np.ndarray]:
        """All that :meth:`restored` needs, with the restart of the last state."""
        assert self._last is not None
        return {
            _BINS: np.ravel(self._bins.spans),
            _FIELDS: np.array([int(self._fields), _ALL_BUT_ONE if self._discarded is None else self._discarded]),
            **{f"{_SERIES}{name}": np.array(values) for name, values in self._series.items()},
            **{f"{_SUMS}{name}": values for name, values in self._sums.items()},
            **{f"{_RESTART}{name}": values for name, values in self._last.restart.items()},
        }

    def step(self) -> Step:
        """Means with standard errors, and the series of scalars; of detached surfaces, and of atoms, the last state."""
        last = self._last
        assert last is not None
        report = {name: value for name, value in observed(last, self._bins).items() if name not in AVERAGED}
        series = {name: np.array(values) for name, values in self._series.items()}
        frames = {f"{TRAJECTORY}/{name}": values for name, values in series.items() if values.ndim == 1}
        if last.report.detached:
            fields = {"gap": last.gap, "pressure": last.pressure} if self._fields else {}
            return Step({**observed(last, self._bins), **frames}, {**fields, **last.atoms}, last.restart, self._bins)
        values: dict[str, Any] = {}
        unresolved: dict[str, float] = {}  # least autocorrelation time in states
        counted = self._counted
        memory, interval = _clock_of(series, counted)
        for name, whole in series.items():
            if name == _TIME:
                continue
            column = whole[-counted:]
            found = statistics_of(column)
            # A count or a flag takes the value nearest to the mean.
            values[name] = found.mean if VARIABLES[name].kind == "float" else np.rint(found.mean)
            if counted == 1:  # no error
                continue
            values[name + STANDARD_ERROR] = found.standard_error
            if column.ndim > 1:
                continue
            values[name + memory] = found.autocorrelation_time * interval if found.resolved else np.nan
            if not found.resolved and np.isfinite(column).all():
                unresolved[name] = float(found.autocorrelation_time)
        if counted == 1 and self._discarded is not None:
            more = "dynamics.frames" if memory == AUTOCORRELATION_TIME else "sampling.trajectories"
            warnings.warn(
                f"one state of a point counts: there is no mean and no standard error; raise {more}", stacklevel=2
            )
        if unresolved:
            warnings.warn(_too_short(counted, interval, memory, unresolved), stacklevel=2)
        fields = {name: total / counted for name, total in self._sums.items()}
        return Step({**values, **report, **frames}, {**fields, **last.atoms}, last.restart, self._bins)


def _clock_of(series: Mapping[str, np.ndarray], counted: int) -> tuple[str, float]:
    """Suffix of the autocorrelation time, and the interval between two states: in s for a motion, else 1."""
    if _TIME not in series:
        return AUTOCORRELATION_STATES, 1.0
    return AUTOCORRELATION_TIME, float(np.mean(np.diff(series[_TIME][-counted:]))) if counted > 1 else 0.0


def _too_short(counted: int, interval: float, memory: str, unresolved: Mapping[str, float]) -> str:
    """Warn that a point has too few states for the autocorrelation time of some quantities."""
    moving = memory == AUTOCORRELATION_TIME
    span = f", {1e12 * counted * interval:.3g} ps," if moving else ""
    if counted < LEAST_STATES:
        return (
            f"the {counted} states of a point{span} are too few for an autocorrelation time, which takes "
            f"{LEAST_STATES}: their standard errors are guesses; raise "
            + ("dynamics.frames, of a short motion dynamics.duration, too" if moving else "sampling.trajectories")
        )
    name = max(unresolved, key=lambda name: unresolved[name])
    least = f"{1e12 * unresolved[name] * interval:.2g} ps" if moving else f"{unresolved[name]:.2g} states"
    more = f" and {len(unresolved) - 1} more" if len(unresolved) > 1 else ""
    longer = "dynamics.duration" if moving else "sampling.trajectories"
    return (
        f"the {counted} states of a point{span} are too few for the autocorrelation time "
        f"of {name}{more}, {least} at least: their standard errors need a series of twenty such times; raise {longer}"
    )


def restart_of(kept: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The restart of the last state in :attr:`Averages.kept`."""
    return {name.removeprefix(_RESTART): value for name, value in kept.items() if name.startswith(_RESTART)}
