"""One campaign: the cases of a study over processes, each finished step to disk at once, resumable."""

import multiprocessing as mp
import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, replace
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

from contact_study.campaign import steps as store
from contact_study.campaign.model import Model
from contact_study.campaign.predictor import GapFields
from contact_study.campaign.progress import Progress
from contact_study.campaign.record import Step, recorded
from contact_study.campaign.resume.folder import Parts
from contact_study.campaign.resume.identity import Run, content_hash
from contact_study.campaign.schema import quantity_of
from contact_study.fields.distributions import Bins
from contact_study.observables.base import Value
from contact_study.problem.case import Case
from contact_study.problem.surface import Surface, realise

# Below this number of points a second thread of FFTW gains little, and costs much when the other core is busy.
_POINTS_FOR_THREADS = 1024**2


class CampaignError(RuntimeError):
    """A campaign that could not go on; finished steps are kept."""


@dataclass(frozen=True)
class Job:
    """One case of one model, as a worker process needs it."""

    model: Model
    case: Case
    bins: Bins
    folder: Path
    predictor: Path | None
    height_map: str


def run_cases(run: Run, names: Sequence[str], parts: Parts, workers: int | None, progress: Progress) -> list[str]:
    """Run every unfinished step of every case; returns the warnings of all, also of the steps finished before.

    Raises
    ------
    CampaignError
        If a worker process died, or a height map changed.
    """
    jobs = [
        Job(
            run.model,
            case,
            run.bins,
            parts.case_folder(name),
            run.predictor,
            run.height_maps.get(str(case.surface.map_path), ""),
        )
        for case, name in zip(run.study.cases, names, strict=True)
    ]
    progress.start(sum(len(job.case.path) for job in jobs), sum(_done(job) for job in jobs))
    unfinished = [job for job in jobs if _done(job) < len(job.case.path) or not store.has_constants(job.folder)]
    given, workers = workers, min(workers or available_cores(), len(unfinished))
    # Threads follow from the whole study, not from what is left of it: a resumed run repeats the arithmetic.
    threads = max(1, available_cores() // max(1, min(given or available_cores(), len(jobs))))
    if workers <= 1:
        for job in unfinished:
            _run(job, threads, lambda *event: progress.step(*event))
    else:
        _run_in_processes(unfinished, workers, threads, progress)
    return list(dict.fromkeys(note for job in jobs for note in store.load_notes(job.folder)))


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _done(job: Job) -> int:
    return store.finished_steps(job.folder, len(job.case.path))


def _run_in_processes(jobs: list[Job], workers: int, threads: int, progress: Progress) -> None:
    # Fresh interpreters: forking a process that holds FFTW plans and compiled kernels is not safe everywhere.
    context = mp.get_context("spawn")
    queue = context.Queue()
    listener = threading.Thread(target=_listen, args=(queue, progress), daemon=True)
    listener.start()
    executor = ProcessPoolExecutor(workers, context, _start_worker, (queue,))
    try:
        with _interrupts_held():  # Ctrl-C reaches the workers too, but is the parent's to handle: they inherit this
            # The last case of a sweep is usually the hardest (strongest adhesion): started first, it is not waited for.
            running = [executor.submit(_run_queued, job, threads) for job in reversed(jobs)]
        for finished in as_completed(running):
            finished.result()
    except BrokenProcessPool:
        raise CampaignError("a worker process was killed (out of memory?); finished steps are kept") from None
    except BaseException:
        for child in mp.active_children():
            child.terminate()
        raise
    finally:
        executor.shutdown(wait=False, cancel_futures=True)
        queue.put(None)
        listener.join(timeout=5)


@contextmanager
def _interrupts_held() -> Iterator[None]:
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _listen(queue: Any, progress: Progress) -> None:
    while (event := queue.get()) is not None:
        progress.step(*event)


_queue: Any = None


def _start_worker(queue: Any) -> None:
    global _queue
    _queue = queue
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where interrupts cannot be held
    threading.Thread(target=_die_with_parent, daemon=True).start()


def _die_with_parent() -> None:
    # A worker that outlived a killed campaign would write beside the one that resumes it.
    parent = mp.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


def _run_queued(job: Job, threads: int) -> None:
    _run(job, threads, lambda *event: _queue.put(event))


def _run(job: Job, threads: int, report: Any) -> None:
    """Finish one case."""
    _check_height_map(job)
    with _kept_warnings(job) as keep_warnings:
        surface = realise(job.case)
        case = job.case if job.case.solver.threads else _with_threads(job.case, surface, threads)
        if not store.has_constants(job.folder):
            constants = job.model.constants(case, surface)
            keep_warnings()
            store.save_constants(job.folder, constants)
        start = _done(job)
        if start == len(case.path):
            return
        restart = (store.load_state(job.folder, start - 1) or None) if start else None
        predictor = GapFields(job.predictor, case) if job.predictor else None
        began = time.perf_counter()
        for number, point in enumerate(job.model.solve_path(case, surface, restart, start, predictor), start):
            now = time.perf_counter()
            step = recorded(point, job.bins, case.output.fields)
            keep_warnings()
            started = {} if predictor is None else {"predictor_field": predictor.fingerprint(number)}
            store.save_step(job.folder, number, _completed(case, number, step, now - began, started))
            report(case.label, _point(case, number), dict(_summary(step)), now - began)
            began = time.perf_counter()


def _check_height_map(job: Job) -> None:
    path = job.case.height_map
    if path is not None and content_hash(path) != job.height_map:
        raise CampaignError(f"{path} has changed while the study ran; finished steps are kept")


def _point(case: Case, number: int) -> str:
    """A point of the path in the unit that the study is written in."""
    name, size = case.loading.unit
    return f"{'' if case.loading.control == 'pressure' else 'gap '}{case.path[number][0] / size:.6g} {name}"


def _completed(case: Case, number: int, step: Step, seconds: float, started: Mapping[str, Value]) -> Step:
    value, branch = case.path[number]
    known: dict[str, Value] = {
        f"applied_{case.loading.control}": value,
        "branch": branch == "unloading",
        "wall_time": seconds,
        "detached": False,
        "message": "",
    }
    said = {quantity_of(name)[1] for name in step.values}
    missing = {name: value for name, value in known.items() if name not in said}
    return Step({**missing, **started, **step.values}, step.fields, step.restart, step.bins)


def _summary(step: Step) -> Mapping[str, Any]:
    """What is shown of a step: of several theories the first one's numbers."""
    first: dict[str, Any] = {}
    for key, value in step.values.items():
        first.setdefault(quantity_of(key)[1], value)
    return {name: first.get(name) for name in ("relative_contact_area", "converged", "message")}


def _with_threads(case: Case, surface: Surface, threads: int) -> Case:
    """The case with the threads that are at hand, where the grid is large enough to gain from them."""
    chosen = threads if surface.grid.points >= _POINTS_FOR_THREADS else 1
    return replace(case, solver=replace(case.solver, threads=chosen))


@contextmanager
def _kept_warnings(job: Job) -> Iterator[Callable[[], None]]:
    """Catch warnings; the function given puts those so far on disk, to be called before what they are about."""
    prefix = f"{job.case.label}: " if job.case.label else ""
    notes = store.load_notes(job.folder)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")

        def keep() -> None:
            new = [note for item in caught if (note := f"{prefix}{item.message}") not in notes]
            caught.clear()
            if new:
                notes.extend(dict.fromkeys(new))
                store.save_notes(job.folder, notes)

        yield keep
