"""Going on from an earlier run: a dataset that is finished, the steps of one that is not, or both.

All that may refuse comes first; only then is anything moved. Steps that stand are brought into the folder of this
run's parts, from where the campaign goes on as if it had just been interrupted. A kill on the way leaves what a later
resume sorts out: cases move by one rename each, and the dataset stays until its successor is complete.
"""

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign import steps as store
from contact_study.campaign.dataset.file import Earlier
from contact_study.campaign.predictor import GapFields
from contact_study.campaign.record import Step
from contact_study.campaign.resume.folder import Parts
from contact_study.campaign.resume.identity import Cases, Match, Run, match
from contact_study.fields.distributions import Bins
from contact_study.problem.case import Case
from contact_study.problem.errors import InputError
from contact_study.problem.sweep import SweptKey

# Fingerprint of the field that a step started from.
STARTED = "predictor_field"


@dataclass(frozen=True)
class Finished:
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


def finished_at(parts: Parts, *, resume: bool, overwrite: bool) -> Finished | None:
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
    attributes = _attributes_at(output)
    if parts.replaces() == _history(attributes):
        return None
    if attributes is None:
        raise InputError(f"{output} exists and is no readable dataset; use --overwrite or another output")
    return Finished(output, attributes)


def _attributes_at(output: Path) -> dict[str, Any] | None:
    """Global attributes of the dataset at an output; None of what is no dataset."""
    try:
        with xr.open_dataset(output) as dataset:
            return dict(dataset.attrs)
    except (OSError, ValueError):
        return None


def _history(attributes: Mapping[str, Any] | None) -> str:
    """What was asked for a dataset, and when; empty of what is none."""
    return str((attributes or {}).get("history", ""))


def take_up(
    run: Run,
    names: Sequence[str],
    parts: Parts,
    unfinished: Mapping[str, Any] | None,
    finished: Finished | None,
    git_commit: str,
) -> list[str]:
    """Bring the steps of earlier runs that stand in this one into its parts.

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

    Returns
    -------
    list of str
        What is to be known of the earlier steps.

    Raises
    ------
    InputError
        If an earlier run is of another study, or its steps started from other fields of the predictor.
    """
    notes: list[str] = []
    taken, kept = _Matched(), _Matched()
    if finished is not None:
        taken = _Matched.of(finished.attributes, run, f"{finished.path} exists and belongs to another study or model")
        with Earlier(finished.path, taken.sweep) as dataset:
            _check_starts(run, taken, lambda found, step: dataset.text(STARTED, taken.case(found).index, step))
    if unfinished is not None:
        kept = _Matched.of(unfinished, run, f"{parts.folder} holds the steps of another study or version")
        folders = [parts.case_folder(name) for name in kept.names]
        _check_starts(run, kept, lambda found, step: _text(folders[found.earlier], STARTED, step))
        # Nothing refuses from here on.
        for number, found in kept.matches.items():
            folder, target = folders[found.earlier], parts.case_folder(names[number])
            if folder != target and folder.exists():
                folder.rename(target)
            usable = _on_usable_bins(target, run.bins)
            store.drop_steps(target, min(found.steps, usable))
            if found.anew and not store.step_numbers(target):
                notes.append(_anew(run, number, found.anew))
    replaced = _history(_attributes_at(parts.output)) if finished is None and parts.output.exists() else None
    parts.claim({**run.attributes, "git_commit": git_commit}, replaced)
    damaged = parts.drop_damaged()
    if damaged:
        notes.append(f"{damaged} damaged files of the earlier run are dropped and computed again")
    if finished is not None:
        with Earlier(finished.path, taken.sweep) as dataset:
            for number, found in taken.matches.items():
                folder = parts.case_folder(names[number])
                if not folder.exists():
                    why = unpack(dataset, taken.case(found), found, run.study.cases[number], run.bins, folder)
                    notes += [_anew(run, number, why)] if why else []
    return list(dict.fromkeys(notes))


@dataclass(frozen=True)
class _Matched:
    """The cases of an earlier run and where they stand in this one."""

    earlier: Cases | None = None
    matches: Mapping[int, Match] = field(default_factory=dict)

    @classmethod
    def of(cls, attributes: Mapping[str, Any], run: Run, whose: str) -> "_Matched":
        try:
            return cls(*match(attributes, run))
        except InputError as error:
            raise InputError(f"{whose}; use --overwrite or another output: {error}") from None

    @property
    def sweep(self) -> Mapping[str, SweptKey]:
        return self.earlier.study.sweep if self.earlier else {}

    @property
    def names(self) -> list[str]:
        return self.earlier.case_names() if self.earlier else []

    def case(self, found: Match) -> Case:
        assert self.earlier is not None
        return self.earlier.study.cases[found.earlier]


def earlier_commits(unfinished: Mapping[str, Any] | None, finished: Finished | None, now: str) -> list[str]:
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


def _text(folder: Path, name: str, number: int) -> str | None:
    try:
        return store.step_text(folder, number, name)
    except (OSError, ValueError, KeyError):  # not finished, or damaged: dropped later
        return None


def _on_usable_bins(folder: Path, bins: Bins) -> int:
    """Number of the first step whose distributions cannot be brought onto the bins.

    If all can, that of the first after the one that may be unfinished.
    """
    numbers = store.step_numbers(folder)
    for number in numbers:
        try:
            usable = store.step_bins(folder, number).hold(bins)
        except (OSError, ValueError, KeyError):
            continue  # damaged: dropped later
        if not usable:
            return number
    return numbers[-1] + 2 if numbers else 1


def unpack(dataset: Earlier, before: Case, found: Match, case: Case, own: Bins, folder: Path) -> str:
    """Put what stands of a case of a finished dataset into the folder of a run's case.

    Parameters
    ----------
    dataset : Earlier
        The dataset.
    before, case : Case
        The case there and here.
    found : Match
        Where it stands there, and how much of it stands here.
    own : Bins
        Those of the run.
    folder : pathlib.Path
        Folder of the case; it appears by rename.

    Returns
    -------
    str
        Why nothing of it can be used; empty if it can.
    """
    if found.steps == 0:
        return found.anew
    bins = recorded_bins(dataset, own)
    if not bins.hold(own):
        return "the bins of its distributions were coarser than those asked for now"
    state = dataset.state(found.earlier) if found.steps == len(before.path) else {}
    if found.steps < len(case.path) and not state:
        return found.anew or "the state after its last point was not kept (output.restart = false)"
    partial = folder.with_name("taken")
    shutil.rmtree(partial, ignore_errors=True)
    store.save_constants(partial, dataset.constants(before.index))
    for number in range(found.steps):
        store.save_values(partial, number, Step(dataset.step(before.index, number), bins=bins))
    if state:
        store.save_state(partial, found.steps - 1, state)
    partial.rename(folder)
    return ""


def recorded_bins(dataset: Earlier, own: Bins) -> Bins:
    """Bins of a dataset, from their centres; those of ``own`` for a distribution that it lacks."""
    edges = []
    for centres, default in zip(dataset.bin_centres, (own.pressure_edges, own.gap_edges), strict=True):
        if centres is None:
            edges.append(default)
        else:
            width = (centres[-1] - centres[0]) / (centres.size - 1)
            edges.append(np.linspace(centres[0] - width / 2, centres[-1] + width / 2, centres.size + 1))
    return replace(own, pressure_edges=edges[0], gap_edges=edges[1])
