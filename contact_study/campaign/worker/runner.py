"""One campaign: the unfinished cases of a study handed to an engine."""

import os
from collections.abc import Container, Sequence
from dataclasses import dataclass, replace
from functools import partial

from contact_study.campaign import engines
from contact_study.campaign.engines import CampaignError
from contact_study.campaign.memory import require_memory_at_once
from contact_study.campaign.model import Model
from contact_study.campaign.progress import Progress
from contact_study.campaign.resume.identity import Run
from contact_study.campaign.resume.work_directory import WorkDirectory
from contact_study.campaign.store.case_file import CaseFile
from contact_study.campaign.worker.case_run import Job, run_case
from contact_study.study.study import Study


@dataclass(frozen=True)
class Where:
    """Where the cases of a study run.

    Parameters
    ----------
    workers, engine, scheduler
        See :class:`~contact_study.campaign.run.RunOptions`.
    fitting : int
        How many cases this machine's memory holds at once.
    """

    workers: int | None
    fitting: int
    engine: str | None = None
    scheduler: str | None = None


def check_memory(model: Model, study: Study, engine: str | None, workers: int | None) -> int:
    """How many cases of a study fit this machine's memory at once; any number where they run on others.

    Raises
    ------
    InputError
        If those that are to run at once do not fit. On other machines each says so where it runs.
    """
    if engine in engines.REMOTE:
        return len(study.cases)
    asked = None if workers is None else min(workers, len(study.cases))
    return require_memory_at_once([model.needs(case) for case in study.cases], asked)


def run_cases(
    run: Run, names: Sequence[str], parts: WorkDirectory, whole: Container[int], progress: Progress, where: Where
) -> tuple[dict[int, CaseFile], list[str]]:
    """Run every unfinished step of every case.

    Parameters
    ----------
    run : Run
        The run.
    names : sequence of str
        Names of its cases.
    parts : Parts
        Where they are kept.
    whole : container of int
        Numbers of cases that stand in a dataset, and are not run.
    progress : Progress
        Hears of every step.
    where : Where
        Where they run.

    Returns
    -------
    files : dict
        File of every other case, by its number.
    notes : list of str
        Warnings of these, also of the steps finished before.

    Raises
    ------
    CampaignError
        If a worker process died, a height map changed, or steps that a worker has finished are not here.
    """
    # Workers of other machines may stand in another folder.
    predictor = None if run.predictor is None else run.predictor.absolute()
    jobs = {
        number: Job(
            run.model,
            replace(case, directory=case.directory.absolute()),
            run.bins,
            parts.case_file(name).absolute(),
            predictor,
            run.height_maps.get(str(case.surface.map_path), ""),
        )
        for number, (case, name) in enumerate(zip(run.study.cases, names, strict=True))
        if number not in whole
    }
    total = sum(len(case.path) for case in run.study.cases)
    files = {number: CaseFile(job.file) for number, job in jobs.items()}
    missing = {number: job.missing(files[number]) for number, job in jobs.items()}
    progress.start(total, total - sum(missing.values()))
    unfinished = [number for number in jobs if missing[number] or not files[number].has_constants]
    if where.engine in engines.REMOTE:  # whose cores are not known here
        workers, threads = where.workers or len(unfinished), 1
    else:
        most = where.workers or min(where.fitting, _processes(run.model, len(run.study.cases)))
        workers = min(most, len(unfinished))
        # Threads follow from the whole study, not from what is left of it: a resumed run repeats the arithmetic.
        threads = max(1, available_cores() // max(1, min(most, len(run.study.cases))))
    tasks = [partial(run_case, jobs[number], threads) for number in unfinished]
    engines.run(tasks, workers, progress.step, where.engine, where.scheduler)
    for number in unfinished:
        files[number] = CaseFile(jobs[number].file)
        if jobs[number].missing(files[number]):
            raise CampaignError(
                f"{files[number].path}: a worker has finished steps that are not here; share the folder with all"
            )
    return files, list(dict.fromkeys(note for file in files.values() for note in file.notes))


def _processes(model: Model, cases: int) -> int:
    """Processes of a study that asks for no number: one for each core, or where these have not two cases each for more.

    A process more costs a start, and an odd case at the end leaves the others idle.
    """
    cores = available_cores()
    return cores if cases >= 2 * cores else max(1, cores // model.threads)


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
