"""Run one case: solve its steps from the first missing one on, and write each to disk at once."""

import socket
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_study.campaign.engines.base import CampaignError, Report
from contact_study.campaign.memory import require
from contact_study.campaign.model import Model
from contact_study.campaign.record import content_hash
from contact_study.campaign.store.case_file import CaseFile, CaseWriter
from contact_study.campaign.worker.ensemble import Averages, restart_of
from contact_study.inputs import plugins
from contact_study.numerics.distributions import Bins
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.constants import roughness_values
from contact_study.results.observables import recorded
from contact_study.results.schema import quantity_of
from contact_study.results.state import Ensemble, InterfaceState, Step, Value
from contact_study.study.case import Case, realise

if TYPE_CHECKING:
    from contact_study.campaign.dataset.predictor import GapFields

# A kill loses at most half a minute of thermal states; a checkpoint costs a thousandth of that.
_SECONDS_BETWEEN_CHECKPOINTS = 30.0


@dataclass(frozen=True)
class Job:
    """A case of a model, for a worker process."""

    model: Model
    case: Case
    bins: Bins
    file: Path
    predictor: Path | None
    height_map: str

    def missing(self, file: CaseFile) -> int:
        """Number of steps of the case that its file lacks."""
        steps = len(self.case.path)
        return steps - file.finished(steps, self.case.output.restart)


def run_case(job: Job, threads: int, report: Report) -> None:
    """Finish one case.

    Parameters
    ----------
    job : Job
        The case.
    threads : int
        Threads of each transform, unless the study sets them.
    report : callable
        Receives after each step the case's label, the point in words, a summary and the seconds it took.

    Raises
    ------
    CampaignError
        If a height map has changed, or the folder of the run is not on this machine.
    InputError
        If the case needs more memory than this process may use.
    """
    plugins.load()
    if not job.file.parent.is_dir():
        raise CampaignError(
            f"{job.file.parent} does not exist on {socket.gethostname()}; put the output into a folder that all "
            "workers share under one name"
        )
    require(job.model.needs(job.case))
    _check_height_map(job)
    kept = CaseWriter(job.file, len(job.case.path), job.case.output.restart)
    with kept, _kept_warnings(job, kept) as keep_warnings:
        surface = realise(job.case)
        case = job.case if job.case.solver.threads else _with_threads(job, surface, threads)
        if not kept.has_constants:
            constants = {
                **({} if case.surface.absent else roughness_values(surface.roughness, surface.sample, surface.filled)),
                **({"interaction_length": case.law.length} if case.law.attracts else {}),
                **job.model.constants(case, surface),
            }
            keep_warnings()
            kept.save_constants(constants)
        start = kept.start
        if start == len(case.path):
            return
        averages, restart = _start_of(job, kept, start)
        predictor = _predictor(job)
        began = time.perf_counter()
        for number, point in enumerate(job.model.solve_path(case, surface, restart, start, predictor), start):
            seconds = time.perf_counter() - began
            step = _recorded(job, kept, number, point, averages)
            if isinstance(point, Ensemble):  # its states are computed as they are recorded
                seconds = time.perf_counter() - began
            averages = None
            keep_warnings()
            started = {} if predictor is None else {"predictor_field": predictor.fingerprint(number)}
            kept.save_step(number, _completed(case, number, step, seconds, started))
            report(case.label, case.point_in_words(number), dict(_summary(step)), seconds)
            began = time.perf_counter()


def _start_of(job: Job, kept: CaseFile, start: int) -> tuple[Averages | None, Mapping[str, np.ndarray] | None]:
    """Averages of the unfinished point ``start``, if any, and the restart state of the model."""
    partial = kept.partial(start)
    averages = Averages.restored(partial, job.bins, start in job.case.kept_fields) if partial else None
    if averages is not None:
        return averages, restart_of(partial)
    return None, (kept.state(start - 1) or None) if start else None


def _recorded(
    job: Job, kept: CaseWriter, number: int, point: InterfaceState | Ensemble | Step, averages: Averages | None
) -> Step:
    """Evaluate a point; averages over an ensemble go to disk from time to time."""
    fields = number in job.case.kept_fields
    if not isinstance(point, Ensemble):
        return recorded(point, job.bins, fields)
    averages = averages or Averages(job.bins, fields, point.discarded)
    saved, counted = time.monotonic(), False
    for state in point.states:
        # Only before a further state: after the last one there is nothing to continue.
        if counted and time.monotonic() - saved > _SECONDS_BETWEEN_CHECKPOINTS:
            kept.save_partial(number, averages.kept)
            saved = time.monotonic()
        averages.add(state)
        counted = True
    return averages.step()


def _predictor(job: Job) -> "GapFields | None":
    if job.predictor is None:
        return None
    from contact_study.campaign.dataset.predictor import GapFields  # and with it xarray, which is slow to import

    return GapFields(job.predictor, job.case)


def _check_height_map(job: Job) -> None:
    path = job.case.height_map
    if path is not None and content_hash(path) != job.height_map:
        raise CampaignError(f"{path} has changed while the study ran")


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


def _summary(step: Step) -> Mapping[str, Any]:
    """Summary of a step for the progress; of several theories the first one's numbers."""
    first: dict[str, Any] = {}
    for key, value in step.values.items():
        first.setdefault(quantity_of(key)[1], value)
    return {name: first.get(name) for name in ("relative_contact_area", "converged", "detached", "message")}


def _with_threads(job: Job, surface: Surface, threads: int) -> Case:
    """The case with the available threads, if its grid is large enough to gain from them."""
    chosen = threads if surface.grid.points >= job.model.points_for_threads else 1
    return replace(job.case, solver=replace(job.case.solver, threads=chosen))


@contextmanager
def _kept_warnings(job: Job, file: CaseWriter) -> Iterator[Callable[[], None]]:
    """Catch warnings; the yielded function writes those so far, before the step that they are about."""
    prefix = f"{job.case.label}: " if job.case.label else ""
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
