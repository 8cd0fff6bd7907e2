"""Continue an earlier run: a finished dataset, the steps of an unfinished run, or both.

Every check comes before the first change. Cases that the dataset holds whole stay there until the next dataset is
assembled. Other cases move to this run's work directory by one rename each, as if the run had just been interrupted.
A later resume finishes one that was killed, and the old dataset stays until the new one is complete.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contact_study.campaign.dataset.file import DatasetReader, ExistingDataset, StoredCase, attributes_of
from contact_study.campaign.dataset.predictor import GapFields
from contact_study.campaign.dataset.states import states_file
from contact_study.campaign.progress import Progress
from contact_study.campaign.record import Run, RunRecord
from contact_study.campaign.resume.matching import Match, NotKeptError, match
from contact_study.campaign.resume.work_directory import WorkDirectory
from contact_study.campaign.store.case_file import CaseFile, write_case
from contact_study.inputs.errors import InputError
from contact_study.numerics.distributions import Bins

# Fingerprint of the gap field that a step started from.
_START = "predictor_field"

# Why the bins of a finished distribution do not serve.
COARSER_BINS = "the bins of its distributions were coarser than those asked for now"


def existing_dataset(work: WorkDirectory, *, resume: bool, overwrite: bool) -> ExistingDataset | None:
    """The dataset at the output, if this run continues it and no steps in the work directory replace it.

    Raises
    ------
    InputError
        If the output exists and neither option allows to use or replace it.
    """
    output = work.output
    if not output.exists() or overwrite:
        return None
    if not resume:
        raise InputError(f"{output} exists; use --overwrite to replace it or --resume to continue its run")
    attributes = attributes_of(output)
    if work.replaces() == _history(attributes):
        return None
    if attributes is None:
        raise InputError(f"{output} exists and is no readable dataset; use --overwrite or another output")
    return ExistingDataset(output, attributes)


def _history(attributes: Mapping[str, Any] | None) -> str:
    return str((attributes or {}).get("history", ""))


@dataclass(frozen=True)
class Resumed:
    """The part of a run that earlier runs have finished.

    Attributes
    ----------
    notes : list of str
        Warnings.
    path : pathlib.Path or None
        A finished dataset.
    earlier : RunRecord or None
        The run that wrote it.
    whole : dict
        Cases that this dataset holds whole, by their number in this run.
    bins : Bins or None
        Bins of its distributions.
    """

    notes: list[str]
    path: Path | None = None
    earlier: RunRecord | None = None
    whole: Mapping[int, Match] = field(default_factory=dict)
    bins: Bins | None = None

    @contextmanager
    def opened(self) -> Iterator[dict[int, StoredCase]]:
        """Open the cases that the dataset holds whole."""
        if self.path is None or self.earlier is None or self.bins is None or not self.whole:
            yield {}
            return
        with DatasetReader(self.path, self.earlier.study) as dataset:
            yield {number: dataset.case(found.earlier, self.bins) for number, found in self.whole.items()}


def resume_run(
    run: Run,
    names: Sequence[str],
    work: WorkDirectory,
    unfinished: Mapping[str, Any] | None,
    finished: ExistingDataset | None,
    git_commit: str,
    progress: Progress,
) -> Resumed:
    """Find the finished part of a run; bring cases that no dataset holds whole into its work directory.

    Parameters
    ----------
    run : Run
        The run.
    names : sequence of str
        Names of its cases.
    work : WorkDirectory
        Its work directory, open.
    unfinished : mapping or None
        Attributes of the run whose steps the work directory holds.
    finished : ExistingDataset or None
        Dataset of an earlier run.
    git_commit : str
        Commit of the program now.
    progress : Progress
        Shows progress.

    Raises
    ------
    InputError
        If an earlier run is of another study, or its steps started from other fields of the predictor.
    """
    notes: list[str] = []
    earlier: RunRecord | None = None
    matches: dict[int, Match] = {}
    if finished is not None:
        fault = "exists and belongs to another study or model"
        earlier, matches = _match(finished.attributes, run, finished.path, fault)
        if run.predictor is not None:
            with DatasetReader(finished.path, earlier.study) as dataset:
                _check_starts(run, matches, lambda number, step: dataset.text(_START, number, step))
    if unfinished is not None:
        notes += _take_over(unfinished, run, names, work, progress)
    replaced = _history(attributes_of(work.output)) if finished is None and work.output.exists() else None
    work.claim({**run.record.attributes, "git_commit": git_commit}, replaced)
    if finished is None or earlier is None:
        return Resumed(notes)
    whole: dict[int, Match] = {}
    with DatasetReader(finished.path, earlier.study) as dataset:
        bins = dataset.bins(run.bins)
        for number, found in progress.through(matches.items(), "cases of the dataset checked"):
            case, file = run.study.cases[number], CaseFile(work.case_file(names[number]))
            if found.steps == len(case.path) and bins.hold(run.bins):
                whole[number] = found
            elif not file.path.exists() or file.finished(len(case.path), last_state=False) < found.steps:
                reason = _extract(dataset, found, bins, run.bins, file.path)
                notes += [_again(run, number, reason)] if reason else []
    return Resumed(list(dict.fromkeys(notes)), finished.path, earlier, whole, bins)


def _match(attributes: Mapping[str, Any], run: Run, where: Path, fault: str) -> tuple[RunRecord, dict[int, Match]]:
    try:
        return match(attributes, run)
    except NotKeptError as error:
        raise InputError(f"{where}: {error}") from None
    except InputError as error:
        raise InputError(f"{where} {fault}; use --overwrite or another output: {error}") from None


def _take_over(
    unfinished: Mapping[str, Any], run: Run, names: Sequence[str], work: WorkDirectory, progress: Progress
) -> list[str]:
    """Give the case files of an unfinished run the names of this run's cases; drop steps that do not serve."""
    earlier, matches = _match(unfinished, run, work.folder, "holds the steps of another study or version")
    files = [CaseFile(work.case_file(name)) for name in earlier.case_names()]
    for file in progress.through(files, "case files of the earlier run checked"):
        file.check()
    _check_starts(run, matches, lambda number, step: files[number].step_text(step, _START))
    # No check comes after this line.
    notes = []
    for number, found in matches.items():
        file, target = files[found.earlier], work.case_file(names[number])
        usable = file.usable_steps(run.bins)
        file.keep(min(found.steps, usable), partial=usable < found.steps and not file.has_step(usable))
        if file.path != target and file.path.exists():
            file.path.rename(target)
        if found.reason and not file.has_steps:
            notes.append(_again(run, number, found.reason))
    damaged = sum(file.damaged for file in files)
    if damaged:
        notes.append(f"{damaged} damaged files of the earlier run: this run computes their lost steps again")
    return notes


def earlier_commits(unfinished: Mapping[str, Any] | None, finished: ExistingDataset | None, now: str) -> list[str]:
    """Name the commits of the program that computed earlier steps, where they differ from the present one."""
    earlier = [attributes for attributes in (unfinished, finished and finished.attributes) if attributes]
    commits = dict.fromkeys(str(attributes.get("git_commit")) for attributes in earlier)
    return [f"the earlier steps are of commit {commit}, the next of {now}" for commit in commits if commit != now]


def _again(run: Run, number: int, reason: str) -> str:
    label = run.study.cases[number].label
    return f"{label + ': ' if label else ''}computed again: {reason}"


def _check_starts(run: Run, matches: Mapping[int, Match], fingerprint: Callable[[int, int], str | None]) -> None:
    """Check that every finished step started from the gap field that the predictor holds now."""
    if run.predictor is None:
        return
    for number, found in matches.items():
        case = run.study.cases[number]
        fields = GapFields(run.predictor, case)
        for step in range(found.steps):
            before = fingerprint(found.earlier, step)
            if before is None:  # not finished
                break
            if before != fields.fingerprint(step):
                where = f"{case.label}, " if case.label else ""
                raise InputError(
                    f"--predictor {run.predictor}: holds another gap field than the finished step started from ({where}"
                    f"point {step + 1}); use the earlier file, --overwrite or another output"
                )


def _extract(dataset: DatasetReader, found: Match, bins: Bins, own: Bins, path: Path) -> str:
    """Write the usable steps of a dataset's case to a case file.

    Parameters
    ----------
    dataset : DatasetReader
        The dataset.
    found : Match
        The case in it.
    bins, own : Bins
        Bins of the dataset and of the run.
    path : pathlib.Path
        The case file; it appears by rename.

    Returns
    -------
    str
        Why no step is usable; empty if some are.
    """
    if found.steps == 0:
        return found.reason
    if not bins.hold(own):
        return COARSER_BINS
    case = dataset.case(found.earlier, bins)
    state = case.state(found.steps - 1)
    if not state:
        return found.reason or (
            "the state after its last point was not kept (output.restart = false), or its file "
            f"{states_file(dataset.path).name} is missing, of another dataset or damaged"
        )
    write_case(path, case.constants, [case.step(number)[0] for number in range(found.steps)], bins, state)
    return ""
