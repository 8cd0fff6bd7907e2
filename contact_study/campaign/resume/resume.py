"""Going on from an earlier run: a dataset that is finished, the steps of one that is not, or both.

All that may refuse comes first; only then is anything moved. Cases that stand whole in a dataset are read there when
the next one is assembled. Those of which a part stands are brought into the folder of this run's parts, from where the
campaign goes on as if it had just been interrupted. A kill on the way leaves what a later resume sorts out: cases move
by one rename each, and the dataset stays until its successor is complete.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.campaign.dataset.file import DatasetReader, attributes_of
from contact_study.campaign.dataset.states import states_file
from contact_study.campaign.predictor import GapFields
from contact_study.campaign.progress import Progress
from contact_study.campaign.resume.identity import Cases, Match, NotKeptError, Run, match
from contact_study.campaign.resume.work_directory import WorkDirectory
from contact_study.campaign.store.case_file import CaseFile, write_case
from contact_study.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.study.case import Case
from contact_study.study.sweep import SweptKey

# Fingerprint of the field that a step started from.
STARTED = "predictor_field"

# Why a case of a dataset is computed again, where only its bins are in the way.
COARSER = "the bins of its distributions were coarser than those asked for now"


@dataclass(frozen=True)
class ExistingDataset:
    """A finished dataset that stands at the output.

    Attributes
    ----------
    path : pathlib.Path
        The file.
    attributes : dict
        Its global attributes.
    """

    path: Path
    attributes: Mapping[str, Any]

    def is_of(self, run: Run) -> bool:
        """Whether it is this very run's."""
        return all(self.attributes.get(name) == value for name, value in run.attributes.items())


def finished_at(parts: WorkDirectory, *, resume: bool, overwrite: bool) -> ExistingDataset | None:
    """The dataset at the output, if it is there to be gone on from, and not to be replaced by the steps in the parts.

    Raises
    ------
    InputError
        If there is a file that is not to be touched.
    """
    output = parts.output
    if not output.exists() or overwrite:
        return None
    if not resume:
        raise InputError(f"{output} exists; use --overwrite to replace it or --resume to continue its run")
    attributes = attributes_of(output)
    if parts.replaces() == _history(attributes):
        return None
    if attributes is None:
        raise InputError(f"{output} exists and is no readable dataset; use --overwrite or another output")
    return ExistingDataset(output, attributes)


def _history(attributes: Mapping[str, Any] | None) -> str:
    """What was asked for a dataset, and when; empty of what is none."""
    return str((attributes or {}).get("history", ""))


class InPlace:
    """A case that stands whole in a dataset, where it is read.

    Parameters
    ----------
    dataset : Earlier
        The dataset.
    case : Case
        The case there.
    number : int
        Its number there.
    bins : Bins
        Those of the dataset.
    """

    def __init__(self, dataset: DatasetReader, case: Case, number: int, bins: Bins):
        self._dataset, self._index, self._number, self._bins = dataset, case.index, number, bins

    @property
    def constants(self) -> dict[str, Any]:
        """What does not change along the path."""
        return self._dataset.constants(self._index)

    def step(self, number: int) -> tuple[dict[str, Any], Bins]:
        """Quantities and fields of one step, and the bins of its distributions."""
        return self._dataset.step(self._index, number), self._bins

    def state(self, number: int) -> dict[str, np.ndarray]:
        """State after the last step; empty if it was not kept."""
        return self._dataset.state(self._number)


@dataclass(frozen=True)
class Taken:
    """What stands of earlier runs.

    Attributes
    ----------
    notes : list of str
        What is to be known of it.
    path : pathlib.Path or None
        A finished dataset.
    earlier : Cases or None
        Its cases.
    whole : dict
        Those of this run that stand whole in it, by their number.
    bins : Bins or None
        Those of its distributions.
    """

    notes: list[str]
    path: Path | None = None
    earlier: Cases | None = None
    whole: Mapping[int, Match] = field(default_factory=dict)
    bins: Bins | None = None

    @contextmanager
    def opened(self) -> Iterator[dict[int, InPlace]]:
        """The cases that stand whole in the finished dataset, to be read."""
        if self.path is None or self.earlier is None or self.bins is None or not self.whole:
            yield {}
            return
        cases, bins = self.earlier.study.cases, self.bins
        with DatasetReader(self.path, self.earlier.study.sweep) as dataset:
            yield {
                number: InPlace(dataset, cases[found.earlier], found.earlier, bins)
                for number, found in self.whole.items()
            }


def resume_run(
    run: Run,
    names: Sequence[str],
    parts: WorkDirectory,
    unfinished: Mapping[str, Any] | None,
    finished: ExistingDataset | None,
    git_commit: str,
    progress: Progress,
) -> Taken:
    """Find what of earlier runs stands in this one, and bring what is no whole case of a dataset into its parts.

    Parameters
    ----------
    run : Run
        This run.
    names : sequence of str
        Names of its cases.
    parts : Parts
        Its parts, opened.
    unfinished : mapping or None
        What the steps in the parts belong to.
    finished : Finished or None
        A dataset of an earlier run.
    git_commit : str
        Commit of the program now.
    progress : Progress
        Shows how far it is.

    Raises
    ------
    InputError
        If an earlier run is of another study, or its steps started from other fields of the predictor.
    """
    notes: list[str] = []
    taken, kept = _Matched(), _Matched()
    if finished is not None:
        taken = _Matched.of(finished.attributes, run, finished.path, "exists and belongs to another study or model")
        if run.predictor is not None:
            with DatasetReader(finished.path, taken.sweep) as dataset:
                _check_starts(run, taken, lambda found, step: dataset.text(STARTED, taken.case(found).index, step))
    if unfinished is not None:
        kept = _Matched.of(unfinished, run, parts.folder, "holds the steps of another study or version")
        files = [CaseFile(parts.case_file(name)) for name in kept.names]
        for file in progress.through(files, "steps of the earlier run checked, of cases"):
            file.check()
        _check_starts(run, kept, lambda found, step: files[found.earlier].step_text(step, STARTED))
        # Nothing refuses from here on.
        for number, found in kept.matches.items():
            file, target = files[found.earlier], parts.case_file(names[number])
            usable = file.usable_steps(run.bins)
            file.keep(min(found.steps, usable), partial=usable < found.steps and not file.has_step(usable))
            if file.path != target and file.path.exists():
                file.path.rename(target)
            if found.anew and not file.has_steps:
                notes.append(_anew(run, number, found.anew))
        damaged = sum(file.damaged for file in files)
        if damaged:
            notes.append(f"{damaged} damaged files of the earlier run; what they lost is computed again")
    replaced = _history(attributes_of(parts.output)) if finished is None and parts.output.exists() else None
    parts.claim({**run.attributes, "git_commit": git_commit}, replaced)
    if finished is None:
        return Taken(notes)
    whole: dict[int, Match] = {}
    with DatasetReader(finished.path, taken.sweep) as dataset:
        bins = recorded_bins(dataset, run.bins)
        for number, found in progress.through(taken.matches.items(), "cases of the dataset taken up"):
            case, file = run.study.cases[number], CaseFile(parts.case_file(names[number]))
            if found.steps == len(case.path) and bins.hold(run.bins):
                whole[number] = found
            elif not file.path.exists() or file.finished(len(case.path), last_state=False) < found.steps:
                why = _unpack(dataset, taken.case(found), found, case, bins, run.bins, file.path)
                notes += [_anew(run, number, why)] if why else []
    return Taken(list(dict.fromkeys(notes)), finished.path, taken.earlier, whole, bins)


@dataclass(frozen=True)
class _Matched:
    """The cases of an earlier run and where they stand in this one."""

    earlier: Cases | None = None
    matches: Mapping[int, Match] = field(default_factory=dict)

    @classmethod
    def of(cls, attributes: Mapping[str, Any], run: Run, where: Path, whose: str) -> "_Matched":
        try:
            return cls(*match(attributes, run))
        except NotKeptError as error:
            raise InputError(f"{where}: {error}") from None
        except InputError as error:
            raise InputError(f"{where} {whose}; use --overwrite or another output: {error}") from None

    @property
    def sweep(self) -> Mapping[str, SweptKey]:
        return self.earlier.study.sweep if self.earlier else {}

    @property
    def names(self) -> list[str]:
        return self.earlier.case_names() if self.earlier else []

    def case(self, found: Match) -> Case:
        assert self.earlier is not None
        return self.earlier.study.cases[found.earlier]


def earlier_commits(unfinished: Mapping[str, Any] | None, finished: ExistingDataset | None, now: str) -> list[str]:
    """Which commits of the program earlier steps are of, where it is not this one."""
    earlier = [attributes for attributes in (unfinished, finished and finished.attributes) if attributes]
    commits = dict.fromkeys(str(attributes.get("git_commit")) for attributes in earlier)
    return [f"the earlier steps are of commit {commit}, the next of {now}" for commit in commits if commit != now]


def _anew(run: Run, number: int, why: str) -> str:
    label = run.study.cases[number].label
    return f"{label + ': ' if label else ''}computed anew: {why}"


def _check_starts(run: Run, earlier: _Matched, started: Callable[[Match, int], str | None]) -> None:
    """Every step that stands started from the field that the predictor holds now."""
    if run.predictor is None:
        return
    for number, found in earlier.matches.items():
        case = run.study.cases[number]
        fields = GapFields(run.predictor, case)
        for step in range(found.steps):
            before = started(found, step)
            if before is None:  # not finished
                break
            if before != fields.fingerprint(step):
                where = f"{case.label}, " if case.label else ""
                raise InputError(
                    f"--predictor {run.predictor}: holds another gap field than the finished step started from ({where}"
                    f"point {step + 1}); use the earlier file, --overwrite or another output"
                )


def _unpack(dataset: DatasetReader, before: Case, found: Match, case: Case, bins: Bins, own: Bins, path: Path) -> str:
    """Put what stands of a case of a finished dataset into the file of a run's case, which appears by rename.

    Parameters
    ----------
    dataset : Earlier
        The dataset.
    before, case : Case
        The case there and here.
    found : Match
        Where it stands there, and how much of it stands here.
    bins, own : Bins
        Those of the dataset and of the run.
    path : pathlib.Path
        The file.

    Returns
    -------
    str
        Why nothing of it can be used; empty if it can.
    """
    if found.steps == 0:
        return found.anew
    if not bins.hold(own):
        return COARSER
    state = dataset.state(found.earlier) if found.steps == len(before.path) else {}
    if not state:
        no_file = f"no {states_file(dataset.path).name} of this dataset"
        return found.anew or f"the state after its last point was not kept (output.restart = false, or {no_file})"
    steps = [dataset.step(before.index, number) for number in range(found.steps)]
    write_case(path, dataset.constants(before.index), steps, bins, state)
    return ""


def recorded_bins(dataset: DatasetReader, own: Bins) -> Bins:
    """Bins of a dataset, from their centres; those of ``own`` for a distribution that it lacks."""
    edges = []
    for centres, default in zip(dataset.bin_centres, (own.pressure_edges, own.gap_edges), strict=True):
        if centres is None:
            edges.append(default)
        else:
            width = (centres[-1] - centres[0]) / (centres.size - 1)
            edges.append(np.linspace(centres[0] - width / 2, centres[-1] + width / 2, centres.size + 1))
    return replace(own, pressure_edges=edges[0], gap_edges=edges[1])
