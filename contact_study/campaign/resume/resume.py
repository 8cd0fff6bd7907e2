"""Continue an earlier run: a finished dataset, the steps of an unfinished run, or both.

Every check comes before the first change. Cases that the dataset holds whole stay there until the next dataset is
assembled. Other cases move to this run's work directory by one rename each, as if the run had just been interrupted.
A later resume finishes one that was killed, and the old dataset stays until the new one is complete.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contact_study.campaign.dataset.file import DatasetReader, StoredCase, attributes_of, history_of, states_file
from contact_study.campaign.dataset.predictor import GapFields
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


def existing_dataset(work: WorkDirectory, *, resume: bool, overwrite: bool) -> dict[str, Any] | None:
    """Attributes of the dataset at the output, if this run continues it and no steps in the work directory replace it.

    It raises InputError if the output exists and neither option allows to use or replace it.
    """
    output = work.output
    if not output.exists() or overwrite:
        return None
    if not resume:
        raise InputError(f"{output} exists; use --overwrite to replace it or --resume to continue its run")
    if work.replaces() == history_of(output):
        return None
    attributes = attributes_of(output)
    if attributes is None:
        raise InputError(f"{output} exists and is no readable dataset; use --overwrite or another output")
    return attributes


@dataclass(frozen=True)
class Resumed:
    """Warnings, and the ``earlier`` run of a dataset that holds some cases of this run ``whole``, by both numbers."""

    notes: list[str]
    earlier: RunRecord | None = None
    whole: Mapping[int, int] = field(default_factory=dict)

    @contextmanager
    def opened(self, path: Path, own: Bins) -> Iterator[dict[int, StoredCase]]:
        """Open the cases that the dataset holds whole."""
        if self.earlier is None or not self.whole:
            yield {}
            return
        with DatasetReader(path, self.earlier.study) as dataset:
            bins = dataset.bins(own)
            yield {number: StoredCase(dataset, there, bins) for number, there in self.whole.items()}


def resume_run(
    run: Run,
    work: WorkDirectory,
    unfinished: Mapping[str, Any] | None,
    finished: Mapping[str, Any] | None,
    git_commit: str,
    progress: Progress,
) -> Resumed:
    """Find the finished part of a run; bring cases that no dataset holds whole into its open work directory.

    Earlier runs are given by their attributes: the ``unfinished`` one whose steps the directory holds, and that of the
    ``finished`` dataset at the output. It raises InputError if one is of another study, or if its steps started from
    other fields of the predictor.
    """
    notes: list[str] = []
    earlier: RunRecord | None = None
    matches: dict[int, Match] = {}
    if finished is not None:
        earlier, matches = _match(finished, run, work.output, "exists and belongs to another study or model")
        if run.predictor is not None:
            with DatasetReader(work.output, earlier.study) as dataset:
                _check_starts(run, matches, lambda number: StoredCase(dataset, number, run.bins))
    if unfinished is not None:
        notes += _take_over(unfinished, run, work, progress)
    replaced = history_of(work.output) if finished is None and work.output.exists() else None
    work.claim({**run.record.attributes, "git_commit": git_commit}, replaced)
    if earlier is None:
        return Resumed(notes)
    whole: dict[int, int] = {}
    with DatasetReader(work.output, earlier.study) as dataset:
        bins = dataset.bins(run.bins)
        for number, found in progress.through(matches.items(), "cases of the dataset checked"):
            steps, file = len(run.study.cases[number].path), CaseFile(work.case_file(run.record.case_names[number]))
            if found.steps == steps and bins.hold(run.bins):
                whole[number] = found.earlier
            elif not file.path.exists() or file.finished(steps, last_state=False) < found.steps:
                reason = _extract(dataset, found, bins, run.bins, file.path)
                notes += [_again(run, number, reason)] if reason else []
    return Resumed(list(dict.fromkeys(notes)), earlier, whole)


def _match(attributes: Mapping[str, Any], run: Run, where: Path, fault: str) -> tuple[RunRecord, dict[int, Match]]:
    try:
        return match(attributes, run)
    except NotKeptError as error:
        raise InputError(f"{where}: {error}") from None
    except InputError as error:
        raise InputError(f"{where} {fault}; use --overwrite or another output: {error}") from None


def _take_over(unfinished: Mapping[str, Any], run: Run, work: WorkDirectory, progress: Progress) -> list[str]:
    """Give the case files of an unfinished run the names of this run's cases; drop steps that do not serve."""
    earlier, matches = _match(unfinished, run, work.folder, "holds the steps of another study or version")
    files = [CaseFile(work.case_file(name)) for name in earlier.case_names]
    for file in progress.through(files, "case files of the earlier run checked"):
        file.check()
    _check_starts(run, matches, files.__getitem__)
    # No check comes after this line.
    notes = []
    for number, found in matches.items():
        file, target = files[found.earlier], work.case_file(run.record.case_names[number])
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


def earlier_commits(earlier: list[Mapping[str, Any] | None], now: str) -> list[str]:
    """Name the commits of the program that computed earlier steps, where they differ from the present one."""
    commits = dict.fromkeys(str(attributes.get("git_commit")) for attributes in earlier if attributes)
    return [f"the earlier steps are of commit {commit}, the next of {now}" for commit in commits if commit != now]


def _again(run: Run, number: int, reason: str) -> str:
    label = run.study.cases[number].label
    return f"{label + ': ' if label else ''}computed again: {reason}"


def _check_starts(run: Run, matches: Mapping[int, Match], earlier: Callable[[int], CaseFile | StoredCase]) -> None:
    """Check that every finished step started from the gap field that the predictor holds now."""
    if run.predictor is None:
        return
    for number, found in matches.items():
        case = run.study.cases[number]
        fields = GapFields(run.predictor, case)
        for step in range(found.steps):
            before = earlier(found.earlier).step_text(step, _START)
            if before is None:  # not finished
                break
            if before != fields.fingerprint(step):
                where = f"{case.label}, " if case.label else ""
                raise InputError(
                    f"--predictor {run.predictor}: holds another gap field than the finished step started from ({where}"
                    f"point {step + 1}); use the earlier file, --overwrite or another output"
                )


def _extract(dataset: DatasetReader, found: Match, bins: Bins, own: Bins, path: Path) -> str:
    """Write the usable steps of a dataset's case to a case file; returns why none are usable, if so."""
    if found.steps == 0:
        return found.reason
    if not bins.hold(own):
        return COARSER_BINS
    case = StoredCase(dataset, found.earlier, bins)
    state = case.state(found.steps - 1)
    if not state:
        return found.reason or (
            "the state after its last point was not kept (output.restart = false), or its file "
            f"{states_file(dataset.path).name} is missing, of another dataset or damaged"
        )
    write_case(path, case.constants, [case.step(number)[0] for number in range(found.steps)], bins, state)
    return ""
