"""Run the unfinished cases of a study by an engine."""

import os
from collections.abc import Container, Sequence
from dataclasses import dataclass, replace
from functools import partial

from contact_study.campaign import engines
from contact_study.campaign.engines import CampaignError
from contact_study.campaign.memory import require_memory_at_once
from contact_study.campaign.model import Model
from contact_study.campaign.progress import Progress
from contact_study.campaign.record import Run
from contact_study.campaign.resume.work_directory import WorkDirectory
from contact_study.campaign.store.case_file import CaseFile
from contact_study.campaign.worker.case_run import Job, run_case
from contact_study.study.study import Study


@dataclass(frozen=True)
class RunOptions:
    """How a campaign runs; no option changes a number.

    Parameters
    ----------
    resume, overwrite : bool
        Whether to continue, or to replace, a dataset or unfinished run at the output.
    workers : int or None
        Number of processes; None for one per case, at most the cores.
    engine : str or None
        Name of one of :data:`contact_study.campaign.engines.ENGINES`; None for the one that the workers need.
    scheduler : str or None
        Address or file of a cluster's scheduler, for an engine that has one.
    """

    resume: bool = False
    overwrite: bool = False
    workers: int | None = None
    engine: str | None = None
    scheduler: str | None = None


def count_fitting_cases(model: Model, study: Study, engine: str | None, workers: int | None) -> int:
    """Number of cases of a study that this machine's memory holds at once; all of them on other machines.

    Raises
    ------
    InputError
        If the cases that are to run at once do not fit. Other machines check this where a case runs.
    """
    if engine in engines.REMOTE:
        return len(study.cases)
    asked = None if workers is None else min(workers, len(study.cases))
    return require_memory_at_once([model.needs(case) for case in study.cases], asked)


def run_cases(
    run: Run,
    names: Sequence[str],
    work: WorkDirectory,
    whole: Container[int],
    progress: Progress,
    options: RunOptions,
    fitting: int,
) -> tuple[dict[int, CaseFile], list[str]]:
    """Run every unfinished step of every case.

    Parameters
    ----------
    run : Run
        The run.
    names : sequence of str
        Names of its cases.
    work : WorkDirectory
        Folder of the case files.
    whole : container of int
        Numbers of cases that a dataset holds; they do not run.
    progress : Progress
        Receives every step.
    options : RunOptions
        Workers, engine and scheduler.
    fitting : int
        Number of cases that this machine's memory holds at once.

    Returns
    -------
    files : dict
        File of every other case, by its number.
    notes : list of str
        Warnings of these cases, earlier steps included.

    Raises
    ------
    CampaignError
        If a worker process died, a height map changed, or finished steps of a worker are missing on this machine.
    """
    # Workers on other machines may have another working directory.
    predictor = None if run.predictor is None else run.predictor.absolute()
    jobs = {
        number: Job(
            run.model,
            replace(case, directory=case.directory.absolute()),
            run.bins,
            work.case_file(name).absolute(),
            predictor,
            run.record.height_maps.get(str(case.surface.map_path), ""),
        )
        for number, (case, name) in enumerate(zip(run.study.cases, names, strict=True))
        if number not in whole
    }
    total = sum(len(case.path) for case in run.study.cases)
    files = {number: CaseFile(job.file) for number, job in jobs.items()}
    missing = {number: job.missing(files[number]) for number, job in jobs.items()}
    progress.start(total, total - sum(missing.values()))
    unfinished = [number for number in jobs if missing[number] or not files[number].has_constants]
    if options.engine in engines.REMOTE:  # the number of its cores is unknown
        workers, threads = options.workers or len(unfinished), 1
    else:
        most = options.workers or min(fitting, _processes(run.model, len(run.study.cases)))
        workers = min(most, len(unfinished))
        # The number of threads follows from the whole study: a resumed run repeats the arithmetic.
        threads = max(1, available_cores() // max(1, min(most, len(run.study.cases))))
    tasks = [partial(run_case, jobs[number], threads) for number in unfinished]
    try:
        engines.run(tasks, workers, progress.step, options.engine, options.scheduler)
    except CampaignError as error:
        kept = f"{progress.done} of {total} steps are finished and kept, --resume continues"
        raise CampaignError(f"{error}; {kept}") from None
    for number in unfinished:
        files[number] = CaseFile(jobs[number].file)
        if jobs[number].missing(files[number]):
            raise CampaignError(
                f"{files[number].path}: a worker has finished steps that are not here; share the folder with all"
            )
    return files, list(dict.fromkeys(note for file in files.values() for note in file.notes))


def _processes(model: Model, cases: int) -> int:
    """Default number of processes: one per core, or per ``model.threads`` cores where cores have fewer than two cases.

    A further process costs its start, and an odd case at the end leaves the others idle.
    """
    cores = available_cores()
    return cores if cases >= 2 * cores else max(1, cores // model.threads)


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
