"""A campaign: check a study, resume what earlier runs finished, run the other cases by an engine, write the dataset."""

import math
import os
from collections.abc import Container, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import xarray as xr

from contact_study.campaign import engines, record
from contact_study.campaign.dataset.assembly import assemble_cases, last_states
from contact_study.campaign.dataset.file import DatasetReader, StoredCase, read_flags
from contact_study.campaign.dataset.predictor import check_predictor
from contact_study.campaign.dataset.work_directory import WorkDirectory
from contact_study.campaign.memory import require_at_once, seconds_of
from contact_study.campaign.model import Model, check_study
from contact_study.campaign.progress import Progress
from contact_study.campaign.record import Run
from contact_study.campaign.resume import existing_dataset, resume_run
from contact_study.campaign.store.case_file import CaseFile
from contact_study.campaign.store.files import check_name, is_dataset, writable_output
from contact_study.campaign.worker import Job, run_case
from contact_study.inputs.errors import InputError
from contact_study.study.checks import describe_maps
from contact_study.study.study import Study


@dataclass(frozen=True)
class RunOptions:
    """How a campaign runs; no option changes a number."""

    resume: bool = False
    overwrite: bool = False
    workers: int | None = None  # None: one per case, at most the cores
    engine: str | None = None
    scheduler: str | None = None  # address or file


def run_campaign(
    model: Model,
    study: Study,
    output: Path,
    progress: Progress,
    command: str,
    predictor: Path | None,
    options: RunOptions,
) -> Mapping[str, xr.Dataset]:
    """Run a study by the user's ``command``; write its dataset, return its groups, of a complete one the flags."""
    choices = {"resume": options.resume, "overwrite": options.overwrite}
    check_name(output)
    study_notes = check_study(model, study)
    run = record.prepare_run(model, study, predictor if predictor is not None and is_dataset(predictor) else None)
    if predictor is not None:
        study_notes += check_predictor(predictor, study, run.height_maps)
    work = WorkDirectory(output)
    finished = existing_dataset(work, **choices)
    commit = record.git_commit()
    if finished is not None and run.attributes.items() <= finished.items():
        if not work.clear_leftovers():
            progress.warn(f"{work.folder} holds steps of another run, which are left alone")
        if (other := finished["git_commit"]) != commit:
            progress.warn(f"{output} is of commit {other}, this is {commit}; --overwrite computes it again")
        return read_flags(output)
    engines.check(options.engine, options.scheduler)
    fitting = _count_fitting_cases(run, options)
    writable_output(output)
    try:
        unfinished = work.open(**choices)
        finished = existing_dataset(work, **choices)  # under the lock it cannot change any more
        commits = dict.fromkeys(str(found.get("git_commit")) for found in (unfinished, finished) if found)
        words = "the earlier steps are of commit {}, the next of {}"
        study_notes += [words.format(one, commit) for one in commits if one != commit]
        resumed, earlier, whole = resume_run(run, work, unfinished, finished, commit, progress)
        for line in [*study.choices, *describe_maps(study.cases)]:
            progress.report(line)
        for note in [*study_notes, *resumed]:
            progress.warn(note)
        files, notes = _run_cases(run, work, whole, progress, options, fitting)
        progress.close()
        work.check_output()
        sources: list[CaseFile | StoredCase] = [*files]
        with DatasetReader(output, earlier.study) if earlier and whole else nullcontext() as dataset:
            if dataset is not None:
                held = dataset.bins(run.study.bins)
                for at, number in whole.items():
                    sources[at] = StoredCase(dataset, number, held)
            groups, late = assemble_cases(study, run.study.bins, sources, progress)
            if finished is not None and earlier is not None:
                notes = [*earlier.carried_warnings(finished), *notes]
            notes += late
            known = [finished] if finished is not None else []
            groups[""].attrs.update(run.origin(known, [*study_notes, *notes], command, commit))
            work.write(groups, last_states(study, sources))
        work.publish()
    except (InputError, OSError):
        work.drop_if_empty()
        raise
    finally:
        progress.close()
        work.close()
    for note in dict.fromkeys(notes):
        progress.warn(note)
    return groups


def _count_fitting_cases(run: Run, options: RunOptions) -> int:
    """Count the cases that this machine's memory holds at once; other machines check this where a case runs."""
    cases = run.study.cases
    if options.engine == engines.REMOTE:
        return len(cases)
    asked = None if options.workers is None else min(options.workers, len(cases))
    return require_at_once([run.model.needs(case) for case in cases], asked)


def _run_cases(
    run: Run, work: WorkDirectory, whole: Container[int], progress: Progress, options: RunOptions, fitting: int
) -> tuple[list[CaseFile], list[str]]:
    """Run the cases that no dataset holds ``whole``, ``fitting`` at once; returns the file of each, and warnings."""
    # Workers on other machines may have another working directory.
    predictor = None if run.start is None else run.start.absolute()
    cases = run.study.cases
    jobs = [
        Job(
            run.model,
            replace(case, directory=case.directory.absolute()),
            run.study.bins,
            work.case_file(name).absolute(),
            predictor,
            run.height_maps,
        )
        for case, name in zip(cases, run.case_names, strict=True)
    ]
    total = sum(len(case.path) for case in cases)
    files = [CaseFile(job.file) for job in jobs]
    missing = [0 if number in whole else jobs[number].missing(files[number]) for number in range(len(cases))]
    progress.start(total, total - sum(missing))
    unfinished = [at for at, file in enumerate(files) if missing[at] or not (at in whole or file.has_constants)]
    if options.engine == engines.REMOTE:  # the number of its cores is unknown
        workers, threads = options.workers or len(unfinished), 1
    else:
        cores = available_cores()
        # One process per core, or per model.threads cores where cores have fewer than two cases: a further process
        # costs its start, and an odd case at the end leaves the others idle.
        processes = cores if len(cases) >= 2 * cores else max(1, cores // run.model.threads)
        most = options.workers or min(fitting, processes)
        workers = min(most, len(unfinished))
        # The number of threads follows from the whole study: a resumed run repeats the arithmetic.
        threads = max(1, cores // max(1, min(most, len(cases))))
    usual = seconds_of(run.model.kind, [(cases[number], missing[number]) for number in unfinished])
    progress.expected = math.sqrt(usual[0] * usual[1]) / max(1, workers) if usual else 0.0
    tasks = [partial(run_case, jobs[number], threads) for number in unfinished]
    try:
        engines.run(tasks, workers, progress.step, options.engine, options.scheduler)
    except engines.CampaignError as error:
        kept = f"{progress.done} of {total} steps are finished and kept, --resume continues"
        raise engines.CampaignError(f"{error}; {kept}") from None
    for number in unfinished:
        files[number] = CaseFile(jobs[number].file)
        if jobs[number].missing(files[number]):
            raise engines.CampaignError(
                f"{files[number].path}: a worker has finished steps that are not here; share the folder with all"
            )
    notes = (note for at, file in enumerate(files) if at not in whole for note in file.notes)
    return files, list(dict.fromkeys(notes))


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
