"""A campaign: check a study, resume what earlier runs finished, run the other cases, write the dataset."""

from collections.abc import Mapping
from pathlib import Path

import xarray as xr

from contact_study.campaign import engines
from contact_study.campaign.dataset import provenance
from contact_study.campaign.dataset.assembly import assemble_cases, last_states
from contact_study.campaign.dataset.file import ExistingDataset
from contact_study.campaign.dataset.predictor import check_predictor
from contact_study.campaign.model import Model, check_study
from contact_study.campaign.progress import Progress
from contact_study.campaign.record import prepare_run
from contact_study.campaign.resume.resume import earlier_commits, existing_dataset, resume_run
from contact_study.campaign.resume.work_directory import WorkDirectory
from contact_study.campaign.store.files import writable_output
from contact_study.campaign.store.formats import check_name, is_dataset
from contact_study.campaign.worker.runner import RunOptions, count_fitting_cases, run_cases
from contact_study.inputs.errors import InputError
from contact_study.study.checks.height_maps import describe_maps
from contact_study.study.study import Study


def run_campaign(
    model: Model,
    study: Study,
    output: Path,
    progress: Progress,
    command: str,
    predictor: Path | None = None,
    options: RunOptions | None = None,
) -> Mapping[str, xr.Dataset]:
    """Run a study and write its dataset.

    Parameters
    ----------
    model : Model
        The model.
    study : Study
        The study.
    output : pathlib.Path
        Dataset to write.
    progress : Progress
        Receives every step and every warning.
    command : str
        The user's command, for the dataset's history.
    predictor : pathlib.Path, optional
        Dataset whose gap fields the steps start from.
    options : RunOptions, optional
        How to run it.

    Returns
    -------
    mapping
        Groups of the dataset by name; of a dataset that was complete before only the flags ``converged``.

    Raises
    ------
    InputError
        If the study, the predictor or the output cannot be used; nothing is written.
    CampaignError
        If the run cannot finish; finished steps are kept.
    """
    options = options or RunOptions()
    choices = {"resume": options.resume, "overwrite": options.overwrite}
    check_name(output)
    bins, study_notes = check_study(model, study)
    run = prepare_run(model, study, bins, predictor if predictor is not None and is_dataset(predictor) else None)
    if predictor is not None:
        study_notes += check_predictor(predictor, study, run.record.height_maps)
    work = WorkDirectory(output)
    finished = existing_dataset(work, **choices)
    if finished is not None and run.record.is_recorded_in(finished.attributes):
        return _already_done(work, finished, progress)
    engines.check(options.engine, options.scheduler)
    fitting = count_fitting_cases(model, study, options.engine, options.workers)
    writable_output(output)
    commit = provenance.git_commit()
    try:
        unfinished = work.open(**choices)
        finished = existing_dataset(work, **choices)  # under the lock it cannot change any more
        names = run.record.case_names()
        study_notes += earlier_commits(unfinished, finished, commit)
        resumed = resume_run(run, names, work, unfinished, finished, commit, progress)
        for line in [*study.choices, *describe_maps(study.cases)]:
            progress.report(line)
        for note in [*study_notes, *resumed.notes]:
            progress.warn(note)
        files, notes = run_cases(run, names, work, resumed.whole, progress, options, fitting)
        progress.close()
        work.check_output()
        with resumed.opened() as stored:
            sources = [stored.get(number) or files[number] for number in range(len(study.cases))]
            groups, late = assemble_cases(study, bins, sources, progress)
            notes = [*provenance.carried_warnings(model, finished, resumed.earlier), *notes, *late]
            earlier = [finished.attributes] if finished is not None else []
            groups[""].attrs.update(provenance.attributes(run, earlier, [*study_notes, *notes], command, commit))
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


def _already_done(work: WorkDirectory, finished: ExistingDataset, progress: Progress) -> Mapping[str, xr.Dataset]:
    if not work.clear_leftovers():
        progress.warn(f"{work.folder} holds steps of another run, which are left alone")
    commit, now = finished.attributes["git_commit"], provenance.git_commit()
    if commit != now:
        progress.warn(f"{finished.path} is of commit {commit}, this is {now}; --overwrite computes it again")
    return provenance.read_flags(finished.path)
