"""A campaign from its study to its dataset: checked, taken up where an earlier run stands, run, assembled."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from contact_study.campaign import engines
from contact_study.campaign.check import checked
from contact_study.campaign.dataset import provenance
from contact_study.campaign.dataset.assembly import assembled, last_states
from contact_study.campaign.dataset.formats import check_name, is_dataset
from contact_study.campaign.model import Model
from contact_study.campaign.predictor import check_predictor
from contact_study.campaign.progress import Progress
from contact_study.campaign.resume.identity import Run, run_of
from contact_study.campaign.resume.resume import ExistingDataset, earlier_commits, finished_at, resume_run
from contact_study.campaign.resume.work_directory import WorkDirectory
from contact_study.campaign.store.files import writable_output
from contact_study.campaign.worker.runner import Where, check_memory, run_cases
from contact_study.errors import InputError
from contact_study.study.checks.height_maps import describe_maps
from contact_study.study.study import Study


@dataclass(frozen=True)
class RunOptions:
    """How a campaign is carried out; nothing here decides a number.

    Parameters
    ----------
    resume, overwrite : bool
        What to do about a dataset, or the steps of one, that stand at the output: continue them, or replace them.
    workers : int or None
        Processes; None for one a case, at most the cores.
    engine : str or None
        Where cases run, a name of :data:`contact_study.campaign.engines.ENGINES`; None for what the workers ask for.
    scheduler : str or None
        Where a cluster answers, for an engine that has one.
    """

    resume: bool = False
    overwrite: bool = False
    workers: int | None = None
    engine: str | None = None
    scheduler: str | None = None


def run_campaign(
    model: Model,
    study: Study,
    output: Path,
    progress: Progress,
    command: str,
    predictor: Path | None = None,
    conditions: RunOptions | None = None,
) -> Mapping[str, xr.Dataset]:
    """Carry out a study and write its dataset.

    Parameters
    ----------
    model : Model
        The model.
    study : Study
        The study.
    output : pathlib.Path
        Dataset to write.
    progress : Progress
        Hears of every step and every warning.
    command : str
        What was asked, for the dataset's history.
    predictor : pathlib.Path, optional
        Dataset whose gap fields the steps start from.
    conditions : Conditions, optional
        How.

    Returns
    -------
    mapping
        Groups of the dataset by name, at least which of their steps converged.

    Raises
    ------
    InputError
        If the study, the predictor or what stands at the output cannot be used; nothing is written then.
    CampaignError
        If it could not be brought to its end; finished steps are kept.
    """
    how = conditions or RunOptions()
    check_name(output)
    bins, said = checked(model, study)
    run = run_of(model, study, bins, predictor if predictor is not None and is_dataset(predictor) else None)
    if predictor is not None:
        said += check_predictor(predictor, study, run.height_maps)
    parts = WorkDirectory(output)
    finished = finished_at(parts, resume=how.resume, overwrite=how.overwrite)
    if finished is not None and finished.is_of(run):
        return _already_done(run, parts, finished, progress)
    engines.check(how.engine, how.scheduler)
    fitting = check_memory(model, study, how.engine, how.workers)
    writable_output(output)
    commit = provenance.git_commit()
    try:
        unfinished = parts.open(resume=how.resume, overwrite=how.overwrite)
        finished = finished_at(parts, resume=how.resume, overwrite=how.overwrite)  # by now it changes no more
        names = run.case_names()
        commits = earlier_commits(unfinished, finished, commit)
        taken = resume_run(run, names, parts, unfinished, finished, commit, progress)
        for line in [*study.choices, *describe_maps(study.cases)]:
            progress.say(line)
        for note in [*said, *commits, *taken.notes]:
            progress.warn(note)
        where = Where(how.workers, fitting, how.engine, how.scheduler)
        files, notes = run_cases(run, names, parts, taken.whole, progress, where)
        progress.close()
        parts.check_output()
        with taken.opened() as standing:
            sources = [standing.get(number) or files[number] for number in range(len(study.cases))]
            groups, late = assembled(run, sources, progress)
            notes = [*provenance.carried_warnings(run, finished, taken.earlier), *notes, *late]
            earlier = [finished.attributes] if finished is not None else []
            groups[""].attrs.update(provenance.provenance(run, earlier, [*said, *notes, *commits], command, commit))
            parts.write(groups, last_states(run, sources))
        parts.publish()
    except (InputError, OSError):
        parts.drop_if_empty()
        raise
    finally:
        progress.close()
        parts.close()
    for note in dict.fromkeys(notes):
        progress.warn(note)
    return groups


def _already_done(
    run: Run, parts: WorkDirectory, finished: ExistingDataset, progress: Progress
) -> Mapping[str, xr.Dataset]:
    if not parts.tidy(run.attributes):
        progress.warn(f"{parts.folder} holds steps of another run, which are left alone")
    commit, now = finished.attributes["git_commit"], provenance.git_commit()
    if commit != now:
        progress.warn(f"{finished.path} is of commit {commit}, this is {now}; use --overwrite to compute it anew")
    return provenance.read_flags(finished)
