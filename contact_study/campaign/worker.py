"""Run one case: solve its steps from the first missing one on, average their states, and write each to disk at once."""

import socket
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.campaign.engines import CampaignError, Report
from contact_study.campaign.memory import require
from contact_study.campaign.model import Model
from contact_study.campaign.store.case_file import CaseFile, CaseWriter
from contact_study.inputs import plugins
from contact_study.inputs.files import content_hash
from contact_study.numerics import life
from contact_study.numerics.distributions import Bins
from contact_study.numerics.fourier import POINTS_FOR_THREADS
from contact_study.numerics.time_series import LEAST_STATES, statistics_of
from contact_study.results import schema
from contact_study.results.observables import AVERAGED, observed, options_of, recorded
from contact_study.results.schema import AUTOCORRELATION_TIME, STANDARD_ERROR, TRAJECTORY, quantity_of
from contact_study.results.state import Ensemble, InterfaceState, Step, Value
from contact_study.study.case import Case, realise

# A kill loses at most half a minute of thermal states; a checkpoint costs a thousandth of that.
_SECONDS_BETWEEN_CHECKPOINTS = 30.0

_SERIES, _SUMS, _BINS, _FIELDS, _RESTART = "series/", "sum/", "bins", "fields", "restart/"

_ALL_BUT_ONE = -1  # discarded states, if only the last one counts

# A quantity with a series and no mean.
_TIME = "time"


@dataclass(frozen=True)
class Job:
    """A case of a model, for a worker process; height maps by path and SHA-256."""

    model: Model
    case: Case
    bins: Bins
    file: Path
    predictor: Path | None
    height_maps: Mapping[str, str]

    @property
    def options(self) -> frozenset[str]:
        """Keys of the observables that the study asks for."""
        return options_of(self.case.output)

    def missing(self, file: CaseFile) -> int:
        """Number of steps of the case that its file lacks."""
        steps = len(self.case.path)
        return steps - file.finished(steps, self.case.output.restart)


def run_case(job: Job, threads: int, report: Report) -> None:
    """Finish one case with ``threads`` of each transform, unless the study sets them; ``report`` every step."""
    plugins.load()
    if not job.file.parent.is_dir():
        raise CampaignError(
            f"{job.file.parent} does not exist on {socket.gethostname()}; put the output into a folder that all "
            "workers share under one name"
        )
    model, case = job.model, job.case
    require(model.needs(case))
    for name, path in case.height_maps.items():
        if content_hash(path) != job.height_maps[name]:
            raise CampaignError(f"{path} has changed while the study ran")
    kept = CaseWriter(job.file, len(case.path), case.output.restart)
    with kept, _kept_warnings(case, kept) as keep_warnings, ExitStack() as listening:
        surface = realise(case)
        if not case.solver.threads:
            large = surface.grid.points >= getattr(model.code, "POINTS_FOR_THREADS", POINTS_FOR_THREADS)
            case = replace(case, solver=replace(case.solver, threads=threads if large else 1))
        if not kept.has_constants:
            counter = case.material.counter_modulus
            constants = {
                **({} if counter is None else {"counter_contact_modulus": counter}),
                **({} if case.surface.absent else schema.roughness_values(surface.roughness)),
                **({"interaction_length": case.law.length} if case.law.attracts else {}),
                **model.code.constants(case, surface),
            }
            keep_warnings()
            kept.save_constants(constants)
        start = kept.start
        if start == len(case.path):
            return
        partial = kept.partial(start)
        averages = Averages.restored(partial, job.bins, start in case.kept_fields, job.options) if partial else None
        restart = _part(partial, _RESTART) if averages else (kept.state(start - 1) or None) if start else None
        gaps = None
        if job.predictor is not None:
            from contact_study.campaign.dataset.predictor import GapFields  # and xarray, which is slow to import

            gaps = GapFields(job.predictor, case)
        extra = {"predictor": gaps} if model.takes_predictor else {}
        points = model.code.solve_path(case, surface, restart=restart, start=start, **extra)
        working = start

        def alive(iterations: int, residual: float | None) -> None:
            report(case.label, case.point_in_words(working), {"iterations": iterations, "residual": residual}, None)

        listening.enter_context(life.listening(alive))
        began = time.perf_counter()
        for number, point in enumerate(points, start):
            seconds = time.perf_counter() - began
            step = _recorded(job, kept, number, point, averages)
            if isinstance(point, Ensemble):  # its states are computed as they are recorded
                seconds = time.perf_counter() - began
            averages = None
            keep_warnings()
            started = {} if gaps is None else {"predictor_field": gaps.fingerprint(number)}
            kept.save_step(number, _completed(case, number, step, seconds, started))
            first: dict[str, Any] = {}  # of several theories the first one's numbers
            for key, value in step.values.items():
                first.setdefault(quantity_of(key)[1], value)
            summary = {name: first.get(name) for name in ("relative_contact_area", "converged", "detached", "message")}
            report(case.label, case.point_in_words(number), summary, seconds)
            working = min(number + 1, len(case.path) - 1)
            life.restart()
            began = time.perf_counter()


def _recorded(
    job: Job, kept: CaseWriter, number: int, point: InterfaceState | Ensemble | Step, averages: "Averages | None"
) -> Step:
    """Evaluate a point; averages over an ensemble go to disk from time to time."""
    fields = number in job.case.kept_fields
    if not isinstance(point, Ensemble):
        return recorded(point, job.bins, fields, job.options)
    averages = averages or Averages(job.bins, fields, point.discarded, job.options)
    saved = time.monotonic()
    for count, state in enumerate(point.states):
        # Only before a further state: after the last one there is nothing to continue.
        if count and time.monotonic() - saved > _SECONDS_BETWEEN_CHECKPOINTS:
            kept.save_partial(number, averages.kept)
            saved = time.monotonic()
        averages.add(state)
        life.beat()
    return averages.step()


def _completed(case: Case, number: int, step: Step, seconds: float, started: Mapping[str, Value]) -> Step:
    value, branch = case.path[number]
    known: dict[str, Value] = {
        f"applied_{case.loading.control}": value,
        "branch": branch == "unloading",
        "wall_time": seconds,
        "detached": False,
        "message": "",
    }
    given = {quantity_of(name)[1] for name in step.values}
    missing = {name: value for name, value in known.items() if name not in given}
    digits = {"double": np.float64, "single": np.float32}[case.output.field_precision]
    # Positions of atoms keep their digits.
    fields = {
        name: values.astype(digits, copy=False) if name in ("gap", "pressure") else values
        for name, values in step.fields.items()
    }
    return Step({**missing, **started, **step.values}, fields, step.restart, step.bins)


@contextmanager
def _kept_warnings(case: Case, file: CaseWriter) -> Iterator[Callable[[], None]]:
    """Catch warnings; the yielded function writes those so far, before the step that they are about."""
    prefix = f"{case.label}: " if case.label else ""
    notes = file.notes
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")

        def keep() -> None:
            found = dict.fromkeys(f"{prefix}{item.message}" for item in caught)
            caught.clear()
            new = [note for note in found if note not in notes]
            if new:
                notes.extend(new)
                file.save_notes(new)

        yield keep


@dataclass
class Averages:
    """Averages of the observables of successive states after ``discarded`` ones; None: only the last state counts."""

    bins: Bins
    fields: bool
    discarded: int | None
    options: frozenset[str] = frozenset()
    series: dict[str, list[Any]] = field(default_factory=dict)
    sums: dict[str, np.ndarray] = field(default_factory=dict)
    last: InterfaceState | None = None

    @classmethod
    def restored(
        cls, kept: Mapping[str, np.ndarray], bins: Bins, fields: bool, options: frozenset[str] = frozenset()
    ) -> "Averages | None":
        """Restore the averages from :attr:`kept`; None if bins or fields have changed."""
        if not np.array_equal(kept[_BINS], np.ravel(bins.spans)) or bool(kept[_FIELDS][0]) != fields:
            return None
        discarded = int(kept[_FIELDS][1])
        series = {name: list(values) for name, values in _part(kept, _SERIES).items()}
        discards = None if discarded == _ALL_BUT_ONE else discarded
        return cls(bins, fields, discards, options, series, _part(kept, _SUMS))

    def add(self, state: InterfaceState) -> None:
        self.last = state
        for name, value in observed(state, self.bins, self.options).items():
            if name in AVERAGED or name == _TIME:
                self.series.setdefault(name, []).append(value)
        if self.fields and self._counted > 0:
            for name in ("gap", "pressure"):
                more = name in self.sums and self.discarded is not None
                new = getattr(state, name)
                self.sums[name] = self.sums[name] + new if more else new.copy()

    @property
    def _counted(self) -> int:
        """Number of averaged states so far; none if negative."""
        return 1 if self.discarded is None else len(next(iter(self.series.values()))) - self.discarded

    @property
    def kept(self) -> dict[str, np.ndarray]:
        """All that :meth:`restored` needs, with the restart of the last state."""
        assert self.last is not None
        return {
            _BINS: np.ravel(self.bins.spans),
            _FIELDS: np.array([int(self.fields), _ALL_BUT_ONE if self.discarded is None else self.discarded]),
            **{f"{_SERIES}{name}": np.array(values) for name, values in self.series.items()},
            **{f"{_SUMS}{name}": values for name, values in self.sums.items()},
            **{f"{_RESTART}{name}": values for name, values in self.last.restart.items()},
        }

    def step(self) -> Step:
        """Means with standard errors, and the series of scalars; of detached surfaces, and of atoms, the last state."""
        last = self.last
        assert last is not None
        of_last = observed(last, self.bins, self.options)
        report = {name: value for name, value in of_last.items() if name not in AVERAGED}
        series = {name: np.array(values) for name, values in self.series.items()}
        frames = {f"{TRAJECTORY}/{name}": values for name, values in series.items() if values.ndim == 1}
        if last.report.detached:
            fields = {"gap": last.gap, "pressure": last.pressure} if self.fields else {}
            return Step({**of_last, **frames}, {**fields, **last.atoms}, last.restart, self.bins)
        values: dict[str, Any] = {}
        unresolved: dict[str, float] = {}  # least autocorrelation time in states
        counted = self._counted
        # The interval between two states: in s for a motion, else 1.
        memory, interval = schema.AUTOCORRELATION_STATES, 1.0
        if _TIME in series:
            times = series[_TIME][-counted:]
            memory, interval = AUTOCORRELATION_TIME, float(np.mean(np.diff(times))) if counted > 1 else 0.0
        for name, whole in series.items():
            if name == _TIME:
                continue
            column = whole[-counted:]
            found = statistics_of(column)
            # A count or a flag takes the value nearest to the mean.
            values[name] = found.mean if schema.VARIABLES[name].kind == "float" else np.rint(found.mean)
            if counted == 1:  # no error
                continue
            values[name + STANDARD_ERROR] = found.standard_error
            if column.ndim == 1:
                values[name + memory] = found.autocorrelation_time * interval if found.resolved else np.nan
                if not found.resolved and np.isfinite(column).all():
                    unresolved[name] = float(found.autocorrelation_time)
        if counted == 1 and self.discarded is not None:
            more = "dynamics.frames" if memory == AUTOCORRELATION_TIME else "sampling.trajectories"
            warnings.warn(
                f"one state of a point counts: there is no mean and no standard error; raise {more}", stacklevel=2
            )
        if unresolved:
            warnings.warn(_too_short(counted, interval, memory, unresolved), stacklevel=2)
        fields = {name: total / counted for name, total in self.sums.items()}
        return Step({**values, **report, **frames}, {**fields, **last.atoms}, last.restart, self.bins)


def _too_short(counted: int, interval: float, memory: str, unresolved: Mapping[str, float]) -> str:
    """Warn that a point has too few states for the autocorrelation time of some quantities."""
    moving = memory == AUTOCORRELATION_TIME
    words = (
        f"the {counted} states of a point{f', {1e12 * counted * interval:.3g} ps,' if moving else ''} are too few for"
    )
    if counted < LEAST_STATES:
        keys = "dynamics.frames, of a short motion dynamics.duration, too" if moving else "sampling.trajectories"
        words += f" an autocorrelation time, which takes {LEAST_STATES}"
        return f"{words}: their standard errors are guesses; raise {keys}"
    name = max(unresolved, key=lambda name: unresolved[name])
    least = f"{1e12 * unresolved[name] * interval:.2g} ps" if moving else f"{unresolved[name]:.2g} states"
    more = f" and {len(unresolved) - 1} more" if len(unresolved) > 1 else ""
    return (
        f"{words} the autocorrelation time of {name}{more}, {least} at least: their standard errors need a series of "
        f"twenty such times; raise {'dynamics.duration' if moving else 'sampling.trajectories'}"
    )


def _part(kept: Mapping[str, np.ndarray], prefix: str) -> dict[str, np.ndarray]:
    return {name.removeprefix(prefix): values for name, values in kept.items() if name.startswith(prefix)}
