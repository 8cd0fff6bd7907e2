"""Run one case: solve its steps from the first missing one on, and write each to disk at once."""

import socket
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.campaign.engines import CampaignError, Report
from contact_study.campaign.memory import require
from contact_study.campaign.model import Model
from contact_study.campaign.record import content_hash
from contact_study.campaign.store.case_file import CaseFile, CaseWriter
from contact_study.campaign.worker.ensemble import Averages, restart_of
from contact_study.inputs import plugins
from contact_study.numerics import life
from contact_study.numerics.distributions import Bins
from contact_study.numerics.fourier import POINTS_FOR_THREADS
from contact_study.results.observables import recorded
from contact_study.results.schema import quantity_of, roughness_values
from contact_study.results.state import Ensemble, InterfaceState, Step, Value
from contact_study.study.case import Case, realise

# A kill loses at most half a minute of thermal states; a checkpoint costs a thousandth of that.
_SECONDS_BETWEEN_CHECKPOINTS = 30.0


@dataclass(frozen=True)
class Job:
    """A case of a model, for a worker process; its height map by the SHA-256."""

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
    """Finish one case with ``threads`` of each transform, unless the study sets them; ``report`` every step."""
    plugins.load()
    if not job.file.parent.is_dir():
        raise CampaignError(
            f"{job.file.parent} does not exist on {socket.gethostname()}; put the output into a folder that all "
            "workers share under one name"
        )
    model, case = job.model, job.case
    require(model.needs(case))
    if case.height_map is not None and content_hash(case.height_map) != job.height_map:
        raise CampaignError(f"{case.height_map} has changed while the study ran")
    kept = CaseWriter(job.file, len(case.path), case.output.restart)
    with kept, _kept_warnings(case, kept) as keep_warnings, ExitStack() as listening:
        surface = realise(case)
        if not case.solver.threads:
            large = surface.grid.points >= getattr(model.code, "POINTS_FOR_THREADS", POINTS_FOR_THREADS)
            case = replace(case, solver=replace(case.solver, threads=threads if large else 1))
        if not kept.has_constants:
            constants = {
                **({} if case.surface.absent else roughness_values(surface.roughness)),
                **({"interaction_length": case.law.length} if case.law.attracts else {}),
                **model.code.constants(case, surface),
            }
            keep_warnings()
            kept.save_constants(constants)
        start = kept.start
        if start == len(case.path):
            return
        averages, restart = _start_of(job, kept, start)
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
            report(case.label, case.point_in_words(number), _summary(step), seconds)
            working = min(number + 1, len(case.path) - 1)
            life.restart()
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
        life.beat()
        counted = True
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


def _summary(step: Step) -> dict[str, Any]:
    """Summary of a step for the progress; of several theories the first one's numbers."""
    first: dict[str, Any] = {}
    for key, value in step.values.items():
        first.setdefault(quantity_of(key)[1], value)
    return {name: first.get(name) for name in ("relative_contact_area", "converged", "detached", "message")}


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
