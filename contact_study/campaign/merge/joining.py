"""Datasets of one study into one file: what the run of the whole study would have written.

The cases are read where they stand, as ``--resume`` does with a finished dataset. The joined file is bit for bit that
of one run, but for the times that steps took and what says where it is from.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.check import checked
from contact_study.campaign.dataset.assembly import assembled, last_states
from contact_study.campaign.dataset.file import DatasetReader
from contact_study.campaign.dataset.formats import check_name
from contact_study.campaign.dataset.provenance import carried_warnings, provenance
from contact_study.campaign.merge.joined_study import joined_study, place_of
from contact_study.campaign.merge.sources import Source, read_sources
from contact_study.campaign.progress import Progress
from contact_study.campaign.resume.identity import Run
from contact_study.campaign.resume.resume import COARSER, ExistingDataset, InPlace, recorded_bins
from contact_study.campaign.resume.work_directory import WorkDirectory
from contact_study.campaign.store.files import real, writable_output
from contact_study.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.study.bins import bins_of
from contact_study.study.study import Study

# Says how long a step took, not what came out; distributions may stand on other bins.
_OF_THE_WORK = "wall_time"
_BINNED = ("pressure_pdf", "gap_pdf")


def merge(
    paths: Sequence[Path],
    output: Path,
    command: str,
    progress: Progress,
    along: Sequence[str] = (),
    overwrite: bool = False,
) -> tuple[Mapping[str, xr.Dataset], list[str]]:
    """Join datasets of one study.

    Parameters
    ----------
    paths : sequence of pathlib.Path
        Datasets as the models' commands wrote them, or as this did.
    output : pathlib.Path
        Dataset to write.
    command : str
        What was asked, for the dataset's history.
    progress : Progress
        Shows how far it is.
    along : sequence of str
        Keys, ``"section.key"``, over which datasets are joined that do not sweep them.
    overwrite : bool
        Whether a dataset at the output may be replaced.

    Returns
    -------
    groups : mapping
        Groups of the joined dataset by name.
    notes : list of str
        What is to be known of it.

    Raises
    ------
    InputError
        If the datasets are of different studies, disagree where they overlap or leave points of the joined sweep out,
        or the output is there already; nothing is written then.
    """
    check_name(output)
    if real(output) in {real(path) for path in paths}:
        raise InputError(f"{output}: is one of the datasets to join; choose another output")
    if output.exists() and not overwrite:
        raise InputError(f"{output} exists; use --overwrite to replace it")
    sources = read_sources(paths)
    study = joined_study(sources, along)
    parts = WorkDirectory(output)
    with ExitStack() as opened:
        datasets = [opened.enter_context(DatasetReader(source.path, source.study.sweep)) for source in sources]
        holders = _holders(sources, study)
        for number, held in holders.items():
            _check_agreement([(sources[i], datasets[i], at) for i, at in held], study.cases[number].label)
        maps = {name: content for source in sources for name, content in source.height_maps.items()}
        run = Run(sources[0].model, study, maps, _bins(study, datasets))
        cases = list(_standing(sources, datasets, [held[0] for held in holders.values()], run.bins))
        writable_output(output)
        opened.callback(parts.close)
        parts.open(resume=False, overwrite=overwrite)
        if output.exists() and not overwrite:  # by now
            raise InputError(f"{output} exists; use --overwrite to replace it")
        opened.callback(parts.remove)
        parts.claim(run.attributes)
        groups, notes = assembled(run, cases, progress)
        groups[""].attrs.update(_attributes(run, sources, notes, command))
        parts.write(groups, last_states(run, cases))
        parts.publish()
    return groups, [*notes, *_idle(sources, holders)]


def _standing(
    sources: Sequence[Source], datasets: Sequence[DatasetReader], taken: Sequence[tuple[int, int]], own: Bins
) -> Iterator[InPlace]:
    """Cases by dataset and number, with distributions that can be brought onto the bins of the joined dataset."""
    bins = [recorded_bins(dataset, own) for dataset in datasets]
    for which, number in taken:
        if not bins[which].hold(own):
            raise InputError(
                f"{sources[which].path}: {COARSER}; run all parts with one output.pressure_range and gap_range"
            )
        yield InPlace(datasets[which], sources[which].study.cases[number], number, bins[which])


def _bins(study: Study, datasets: Sequence[DatasetReader]) -> Bins:
    """Bins of the joined study; those that all parts have where its height map is not at hand."""
    try:
        return bins_of(study)
    except InputError:
        none = Bins.evenly((0, 1, 1), (0, 1, 1))
        first, *others = (recorded_bins(dataset, none) for dataset in datasets)
        if all(first.equal(other) for other in others):
            return first
        raise


def _idle(sources: Sequence[Source], holders: Mapping[int, list[tuple[int, int]]]) -> list[str]:
    """Names the datasets from which nothing was taken."""
    taken = {held[0][0] for held in holders.values()}
    return [
        f"{source.path}: holds nothing that the datasets before it do not"
        for which, source in enumerate(sources)
        if which not in taken
    ]


def _holders(sources: Sequence[Source], study: Study) -> dict[int, list[tuple[int, int]]]:
    """For each case of the joined study the datasets that hold it, each with the number of the case there."""
    held: dict[int, list[tuple[int, int]]] = {number: [] for number in range(len(study.cases))}
    for which, source in enumerate(sources):
        for at, case in enumerate(source.study.cases):
            held[place_of(study, case)].append((which, at))
    missing = [number for number, found in held.items() if not found]
    if missing:
        raise InputError(
            f"the joined study lacks {len(missing)} of its {len(held)} cases, first {study.cases[missing[0]].label}; "
            "run them and give their datasets, too"
        )
    return held


def _check_agreement(held: Sequence[tuple[Source, DatasetReader, int]], label: str) -> None:
    """Refuse datasets that have other numbers of one case."""
    (first, one, at), *others = held
    for source, other, there in others:
        left, right = first.study.cases[at], source.study.cases[there]
        pairs = {"": (one.constants(left.index), other.constants(right.index))}
        for number in range(len(left.path)):
            pairs[f"point {number + 1}"] = one.step(left.index, number), other.step(right.index, number)
        for point, (mine, yours) in pairs.items():
            for name in _disagreeing(mine, yours):
                where = ", ".join(filter(None, (label, point)))
                raise InputError(
                    f"{first.path} and {source.path} disagree{f' at {where}' if where else ''}: {name} is "
                    f"{_size(mine, name)} in the one and {_size(yours, name)} in the other; leave one of them out"
                )


def _disagreeing(one: Mapping[str, Any], other: Mapping[str, Any]) -> Iterator[str]:
    for name in {**one, **other}:
        if name.endswith(_OF_THE_WORK) or name.endswith(_BINNED):
            continue
        if name not in one or name not in other or not _equal(np.asarray(one[name]), np.asarray(other[name])):
            yield name


def _equal(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two values of a quantity are the same bits; a sweep pads arrays of its smaller cells at their ends."""
    if one.ndim != other.ndim or one.dtype.kind != other.dtype.kind:
        return False
    shared = tuple(slice(min(pair)) for pair in zip(one.shape, other.shape, strict=True))
    return np.array_equal(one[shared], other[shared], equal_nan=one.dtype.kind == "f")


def _size(values: Mapping[str, Any], name: str) -> str:
    value = np.asarray(values[name]) if name in values else None
    if value is None:
        return "absent"
    return f"{value.item()!r}" if value.ndim == 0 else f"another field of mean {np.nanmean(value):.17g}"


def _of_the_whole(run: Run) -> list[str]:
    """What is to be known of the joined study; nothing where this machine could not run it."""
    try:
        return checked(run.model, run.study)[1]
    except InputError:
        return []


def _attributes(run: Run, sources: Sequence[Source], notes: Sequence[str], command: str) -> dict[str, Any]:
    """Attributes of the root: where the parts differ, those of all of them, a line each."""
    attributes = [source.attributes for source in sources]
    said = _of_the_whole(run)
    for source in sources:
        said += carried_warnings(run, ExistingDataset(source.path, source.attributes))
    commits = dict.fromkeys(str(own.get("git_commit")) for own in attributes)
    predictors = dict.fromkeys(str(own.get("predictor", "")) for own in attributes)
    if len(commits) > 1:
        said.append(f"the parts are of several commits: {', '.join(commits)}")
    return provenance(run, attributes, [*said, *notes], command, ", ".join(commits)) | {
        "predictor": "\n".join(predictors)
    }
