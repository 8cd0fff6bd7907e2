"""Merge datasets of parts of one study; their cases are read in place."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.dataset import provenance
from contact_study.campaign.dataset.assembly import assemble_cases, last_states
from contact_study.campaign.dataset.file import DatasetReader, StoredCase
from contact_study.campaign.merge.joined_study import Source, joined_study, maps, position, read_sources
from contact_study.campaign.model import check_study
from contact_study.campaign.progress import Progress
from contact_study.campaign.record import Run, RunRecord
from contact_study.campaign.resume.resume import COARSER_BINS
from contact_study.campaign.resume.work_directory import WorkDirectory
from contact_study.campaign.store.files import real, writable_output
from contact_study.campaign.store.formats import check_name
from contact_study.inputs.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.study.bins import bins_of
from contact_study.study.study import Study

# Quantities that may differ between two datasets of one case: wall times, and distributions on other bins.
_FREE = ("wall_time", "pressure_pdf", "gap_pdf")

# Datasets that hold a case of the joined study: number of the dataset, number of the case in it.
_Holders = Mapping[int, list[tuple[int, int]]]


def merge(
    paths: Sequence[Path],
    output: Path,
    command: str,
    progress: Progress,
    along: Sequence[str] = (),
    overwrite: bool = False,
) -> tuple[Mapping[str, xr.Dataset], list[str]]:
    """Merge datasets of one study.

    Parameters
    ----------
    paths : sequence of pathlib.Path
        Datasets that the models' commands or this one wrote.
    output : pathlib.Path
        Dataset to write.
    command : str
        The user's command, for the dataset's history.
    progress : Progress
        Shows progress.
    along : sequence of str
        Keys, ``"section.key"``, over which to join datasets that do not sweep them.
    overwrite : bool
        Whether to replace a dataset at the output.

    Returns
    -------
    groups : mapping
        Groups of the merged dataset by name.
    notes : list of str
        Warnings.

    Raises
    ------
    InputError
        If the datasets are of different studies, disagree where they overlap or lack points of the joined sweep, or if
        the output exists; nothing is written then.
    """
    check_name(output)
    if real(output) in {real(path) for path in paths}:
        raise InputError(f"{output}: is one of the datasets to join; choose another output")
    work = WorkDirectory(output)
    if output.exists() and not overwrite:
        work.clear_leftovers()
        raise InputError(f"{output} exists; use --overwrite to replace it")
    sources = read_sources(paths)
    study = joined_study(sources, along)
    with ExitStack() as opened:
        datasets = [opened.enter_context(DatasetReader(source.path, source.study)) for source in sources]
        holders = _holders(sources, study)
        for number, held in holders.items():
            _check_agreement([(sources[i], datasets[i], at) for i, at in held], study.cases[number].label)
        run = _run(sources, study, _bins(study, datasets))
        cases = list(_stored_cases(sources, datasets, [held[0] for held in holders.values()], run.bins))
        writable_output(output)
        opened.callback(work.close)
        work.open(resume=False, overwrite=overwrite)
        if output.exists() and not overwrite:  # by now
            raise InputError(f"{output} exists; use --overwrite to replace it")
        opened.callback(work.remove)
        work.claim(run.record.attributes)
        groups, notes = assemble_cases(study, run.bins, cases, progress)
        groups[""].attrs.update(_attributes(run, sources, notes, command))
        work.write(groups, last_states(study, cases))
        work.publish()
    return groups, [*notes, *_unused(sources, holders)]


def _run(sources: Sequence[Source], study: Study, bins: Bins) -> Run:
    """The run whose dataset the merged one stands for."""
    model = sources[0].model
    predictors = "\n".join(dict.fromkeys(source.record.predictor for source in sources))
    record = RunRecord(model.kind, study, maps(sources), model.ignores, predictor=predictors)
    return Run(model, record, bins)


def _stored_cases(
    sources: Sequence[Source], datasets: Sequence[DatasetReader], chosen: Sequence[tuple[int, int]], own: Bins
) -> Iterator[StoredCase]:
    """Open cases by dataset and number; their distributions must fit the bins of the merged dataset."""
    bins = [dataset.bins(own) for dataset in datasets]
    for which, number in chosen:
        if not bins[which].hold(own):
            raise InputError(
                f"{sources[which].path}: {COARSER_BINS}; run all parts with one output.pressure_range and gap_range"
            )
        yield datasets[which].case(number, bins[which])


def _bins(study: Study, datasets: Sequence[DatasetReader]) -> Bins:
    """Bins of the joined study; those that all parts share where its height map is missing."""
    try:
        return bins_of(study)
    except InputError:
        none = Bins.evenly((0, 1, 1), (0, 1, 1))
        first, *others = (dataset.bins(none) for dataset in datasets)
        if all(first.equal(other) for other in others):
            return first
        raise


def _holders(sources: Sequence[Source], study: Study) -> _Holders:
    """Find the datasets that hold each case of the joined study."""
    held: dict[int, list[tuple[int, int]]] = {number: [] for number in range(len(study.cases))}
    for which, source in enumerate(sources):
        for at, case in enumerate(source.study.cases):
            held[position(study, case)].append((which, at))
    missing = [number for number, found in held.items() if not found]
    if missing:
        raise InputError(
            f"the joined study lacks {len(missing)} of its {len(held)} cases, first {study.cases[missing[0]].label}; "
            "run them and give their datasets, too"
        )
    return held


def _unused(sources: Sequence[Source], holders: _Holders) -> list[str]:
    """Name the datasets that contribute no case."""
    used = {held[0][0] for held in holders.values()}
    return [
        f"{source.path}: holds nothing that the datasets before it do not"
        for which, source in enumerate(sources)
        if which not in used
    ]


def _check_agreement(held: Sequence[tuple[Source, DatasetReader, int]], label: str) -> None:
    """Refuse datasets that have different numbers of one case."""
    (first, one, at), *others = held
    for source, other, there in others:
        pairs = {"": (one.constants(at), other.constants(there))}
        for number in range(len(first.study.cases[at].path)):
            pairs[f"point {number + 1}"] = one.step(at, number), other.step(there, number)
        for point, (mine, yours) in pairs.items():
            for name in _disagreeing(mine, yours):
                where = ", ".join(filter(None, (label, point)))
                raise InputError(
                    f"{first.path} and {source.path} disagree{f' at {where}' if where else ''}: {name} is "
                    f"{_words(mine, name)} in the one and {_words(yours, name)} in the other; leave one of them out"
                )


def _disagreeing(one: Mapping[str, Any], other: Mapping[str, Any]) -> Iterator[str]:
    for name in {**one, **other}:
        if not name.endswith(_FREE) and (
            name not in one or name not in other or not _equal(np.asarray(one[name]), np.asarray(other[name]))
        ):
            yield name


def _equal(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two values of a quantity have the same bits; a sweep pads arrays of its smaller cells at their ends."""
    if one.ndim != other.ndim or one.dtype.kind != other.dtype.kind:
        return False
    shared = tuple(slice(min(pair)) for pair in zip(one.shape, other.shape, strict=True))
    return np.array_equal(one[shared], other[shared], equal_nan=one.dtype.kind == "f")


def _words(values: Mapping[str, Any], name: str) -> str:
    value = np.asarray(values[name]) if name in values else None
    if value is None:
        return "absent"
    return f"{value.item()!r}" if value.ndim == 0 else f"another field of mean {np.nanmean(value):.17g}"


def _attributes(run: Run, sources: Sequence[Source], notes: Sequence[str], command: str) -> dict[str, Any]:
    """Attributes of the root; those of all parts, a line each, where the parts differ."""
    try:
        warnings = check_study(run.model, run.study)[1]
    except InputError:  # this machine could not run it
        warnings = []
    for source in sources:
        warnings += provenance.carried_warnings(run.model, source, source.record)
    commits = dict.fromkeys(str(source.attributes.get("git_commit")) for source in sources)
    if len(commits) > 1:
        warnings.append(f"the parts are of several commits: {', '.join(commits)}")
    earlier = [source.attributes for source in sources]
    return provenance.attributes(run, earlier, [*warnings, *notes], command, ", ".join(commits))
