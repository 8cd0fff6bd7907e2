"""One campaign: the unfinished cases of a study handed to an engine."""

import os
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from contact_study.campaign import engines
from contact_study.campaign import steps as store
from contact_study.campaign.case_run import Job, finished, run_case
from contact_study.campaign.engines import CampaignError
from contact_study.campaign.model import Model
from contact_study.campaign.progress import Progress
from contact_study.campaign.resume.folder import Parts
from contact_study.campaign.resume.identity import Run


def run_cases(
    run: Run,
    names: Sequence[str],
    parts: Parts,
    workers: int | None,
    progress: Progress,
    engine: str | None = None,
    scheduler: str | None = None,
) -> list[str]:
    """Run every unfinished step of every case; returns the warnings of all, also of the steps finished before.

    Raises
    ------
    CampaignError
        If a worker process died, a height map changed, or steps that a worker has finished are not here.
    """
    # Workers of other machines may stand in another folder.
    predictor = None if run.predictor is None else run.predictor.absolute()
    jobs = [
        Job(
            run.model,
            replace(case, directory=case.directory.absolute()),
            run.bins,
            parts.case_folder(name).absolute(),
            predictor,
            run.height_maps.get(str(case.surface.map_path), ""),
        )
        for case, name in zip(run.study.cases, names, strict=True)
    ]
    progress.start(sum(len(job.case.path) for job in jobs), sum(finished(job) for job in jobs))
    unfinished = [job for job in jobs if finished(job) < len(job.case.path) or not store.has_constants(job.folder)]
    if engine in engines.REMOTE:  # whose cores are not known here
        workers, threads = workers or len(unfinished), 1
    else:
        most = workers or _processes(run.model, len(jobs))
        workers = min(most, len(unfinished))
        # Threads follow from the whole study, not from what is left of it: a resumed run repeats the arithmetic.
        threads = max(1, available_cores() // max(1, min(most, len(jobs))))
    engines.run([partial(run_case, job, threads) for job in unfinished], workers, progress.step, engine, scheduler)
    for job in unfinished:
        if finished(job) < len(job.case.path):
            raise CampaignError(
                f"{job.folder}: a worker has finished steps that are not here; share the folder with all"
            )
    return list(dict.fromkeys(note for job in jobs for note in store.load_notes(job.folder)))


def _processes(model: Model, cases: int) -> int:
    """Processes of a study that asks for no number: one for each core, or where these have not two cases each for more.

    A process more costs a start, and an odd case at the end leaves the others idle.
    """
    cores = available_cores()
    return cores if cases >= 2 * cores else max(1, cores // model.threads)


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
