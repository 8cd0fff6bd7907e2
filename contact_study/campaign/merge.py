"""Merge datasets of parts of one study: equal keys, and the union of their sweeps. Their cases are read in place.

The merged file equals that of one run bit for bit, but for wall times and attributes of origin; no case runs here.
"""

import copy
import dataclasses
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from contact_study.campaign.dataset.assembly import assemble_cases, last_states
from contact_study.campaign.dataset.file import DatasetReader, StoredCase, opened
from contact_study.campaign.dataset.work_directory import WorkDirectory
from contact_study.campaign.model import MODELS, check_study
from contact_study.campaign.progress import Progress
from contact_study.campaign.record import Run, describe_differences, differences, key_values
from contact_study.campaign.resume import COARSER_BINS
from contact_study.campaign.store.files import check_name, real, require_dataset, writable_output
from contact_study.inputs.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.study.case import Case
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, same
from contact_study.study.schema.keys import default_of, keys_of, suggestion
from contact_study.study.study import Study, make_study

_SEED = "surface.seed"
# Attributes that all datasets share beside the study.
_SHARED = ("model", "version", "schema_version")
# Keys of the whole study that may differ.
_FREE_KEYS = ("study.title", "output.restart")
# Quantities that may differ between two datasets of one case: wall times, and distributions on other bins.
_FREE = ("wall_time", "pressure_pdf", "gap_pdf")


def merge(
    paths: Sequence[Path],
    output: Path,
    command: str,
    progress: Progress,
    along: Sequence[str] = (),
    overwrite: bool = False,
) -> tuple[Mapping[str, xr.Dataset], list[str]]:
    """Merge datasets of one study, ``along`` further keys; returns the groups by name, and warnings."""
    check_name(output)
    if real(output) in {real(path) for path in paths}:
        raise InputError(f"{output}: is one of the datasets to join; choose another output")
    work = WorkDirectory(output)
    if output.exists() and not overwrite:
        work.clear_leftovers()
        raise InputError(f"{output} exists; use --overwrite to replace it")
    sources = _read_sources(paths)
    run = _joined_run(sources, along)
    study = run.study
    with ExitStack() as stack:
        datasets = [stack.enter_context(DatasetReader(source.path, source.run.study)) for source in sources]
        holders = _holders(sources, study)
        own = _bins(run, datasets)
        bins = [dataset.bins(own) for dataset in datasets]
        cases = []
        for held, case in zip(holders, study.cases, strict=True):
            alike = [(sources[i].path, StoredCase(datasets[i], at, bins[i])) for i, at in held]
            _check_agreement(alike, case)
            cases.append(alike[0][1])
        used = dict.fromkeys(held[0][0] for held in holders)
        for which in used:
            if not bins[which].hold(own):
                raise InputError(
                    f"{sources[which].path}: {COARSER_BINS}; run all parts with one output.pressure_range and gap_range"
                )
        writable_output(output)
        stack.callback(work.close)
        work.open(resume=False, overwrite=overwrite)
        if output.exists() and not overwrite:  # by now
            raise InputError(f"{output} exists; use --overwrite to replace it")
        stack.callback(work.remove)
        work.claim(run.attributes)
        groups, notes = assemble_cases(study, own, cases, progress)
        groups[""].attrs.update(_attributes(run, sources, notes, command))
        work.write(groups, last_states(study, cases))
        work.publish()
    unused = [source.path for which, source in enumerate(sources) if which not in used]
    return groups, [*notes, *(f"{path}: holds nothing that the datasets before it do not" for path in unused)]


class _Source(NamedTuple):
    """One of the datasets to merge: its attributes, and the run that wrote it."""

    path: Path
    attributes: Mapping[str, Any]
    run: Run


def _read_sources(paths: Sequence[Path]) -> list[_Source]:
    """Read the records of at least two datasets of one model and version."""
    if len(paths) < 2:
        raise InputError("give at least two datasets to join")
    known_paths = set[str]()
    for path in paths:
        if real(path) in known_paths:
            raise InputError(f"{path} is given twice")
        known_paths.add(real(path))
    first, *others = sources = [_read_source(path) for path in paths]
    maps: dict[str, tuple[Path, str]] = {}
    for source in sources:
        for name, content in source.run.height_maps.items():
            known, other = maps.setdefault(name, (source.path, content))
            if other != content:
                raise InputError(
                    f"{known} and {source.path} cannot be joined: the map {name} had another content "
                    f"(SHA-256 {other[:12]}… and {content[:12]}…)"
                )
    for source in others:
        pairs = {name: (first.attributes.get(name), source.attributes.get(name)) for name in _SHARED}
        words = "{} is {} in the one and {} in the other"
        faults = [words.format(name, *pair) for name, pair in pairs.items() if pair[0] != pair[1]]
        if bool(first.run.predictor) != bool(source.run.predictor):
            faults.append("one was run with --predictor, one without")
        if faults:
            raise InputError(f"{first.path} and {source.path} cannot be joined: {faults[0]}")
    return sources


def _read_source(path: Path) -> _Source:
    require_dataset(path)
    with opened(path) as dataset:
        attributes, sizes = dict(dataset.attrs), dict(dataset.sizes)
        held = {str(name): dataset[name].values.tolist() for name in dataset.dims if name in dataset.coords}
    kind = str(attributes.get("model"))
    if kind not in MODELS or "schema_version" not in attributes:
        raise InputError(f"{path}: is no dataset of bem-adhesion, md-reference or persson-theory")
    try:
        run = Run.read(attributes, path.parent, MODELS[kind])
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    for name, swept in run.study.sweep.items():
        if held.get(name) != list(swept.values):
            raise InputError(
                f"{path}: does not hold the points of {name} that its study sweeps ({sizes.get(name, 0)} of "
                f"{len(swept.values)}), as if it had been cut or joined by other means; give files as they were written"
            )
    return _Source(path, attributes, run)


def _joined_run(sources: Sequence[_Source], along: Sequence[str]) -> Run:
    """Describe the run of the study whose sweep holds the cases of every dataset.

    A key that some dataset sweeps is swept, numbers in increasing order; unswept samples are joined over seeds.
    """
    sections = {section: declared for section, declared in SECTIONS.items() if section not in WHOLE_STUDY}
    known = [f"{section}.{name}" for section, declared in sections.items() for name in keys_of(declared)]
    for dotted in along:
        if dotted not in known:
            raise InputError(f"--along {dotted}: is no key that a study sweeps{suggestion(dotted, known)}")
    swept = dict.fromkeys(dotted for source in sources for dotted in source.run.study.table.get("sweep", {}))
    swept |= dict.fromkeys(along)
    seeds = [{case.geometry.realisation for case in source.run.study.cases} for source in sources]
    if all(len(own) == 1 and None not in own for own in seeds) and len(set.union(*seeds)) > 1:
        swept[_SEED] = None
    first = sources[0]
    table = copy.deepcopy(first.run.study.table)
    for dotted in swept:
        if dotted not in table.get("sweep", {}):
            section, _, name = dotted.partition(".")
            table.get(section, {}).pop(name, None)
        table.setdefault("sweep", {})[dotted] = _values(sources, dotted)
    study = make_study(table, first.run.study.directory)
    maps = {name: content for source in sources for name, content in source.run.height_maps.items()}
    whole = Run(first.run.model, study, maps, "\n".join(dict.fromkeys(source.run.predictor for source in sources)))
    for source in sources:
        for case in source.run.study.cases:
            other = study.cases[_position(study, case)]
            different = differences(_compared_keys(whole, other), _compared_keys(source.run, case))
            if not different:
                continue
            key, values = next(iter(different.items()))
            joinable = len(different) == 1 and key.partition(".")[0] not in WHOLE_STUDY
            joinable = joinable and not any(isinstance(value, tuple) for value in values)
            advice = f" (--along {key} joins them over it)" if joinable else ""
            words = describe_differences(different, "in the one", "in the other")
            raise InputError(f"{first.path} and {source.path} are of different studies: {words}{advice}")
    return whole


def _position(study: Study, case: Case) -> int:
    """Number of the case of a joined study at the same point of its sweep."""
    number = 0
    for dotted in study.table.get("sweep", {}):
        values, value = study.sweep[dotted.rpartition(".")[2]].values, _value(case, dotted)
        alike = (at for at, other in enumerate(values) if same(value, other))
        number = number * len(values) + (values.index(value) if value in values else next(alike))
    return number


def _value(case: Case, dotted: str) -> Any:
    """Value of a key in a case; one number for a pair of equal ones, as a sweep holds it."""
    section, _, name = dotted.partition(".")
    value = getattr(getattr(case, section), name, None)
    return value[0] if isinstance(value, tuple) and len(value) == 2 and value[0] == value[1] else value


def _values(sources: Sequence[_Source], dotted: str) -> list[Any]:
    """Every value that a dataset has of a key, as its study writes it; numbers in increasing order."""
    found: dict[Any, Any] = {}  # by their values in SI
    section, _, name = dotted.partition(".")
    for source in sources:
        study = source.run.study
        if dotted in study.table.get("sweep", {}):
            for size, written in zip(study.sweep[name].values, study.table["sweep"][dotted], strict=True):
                found.setdefault(size, written)
            continue
        size, *more = dict.fromkeys(_value(case, dotted) for case in study.cases)
        if more or size is None:
            fault = "has several values of it at different points of its sweep" if more else "has no value of it"
            raise InputError(f"{source.path} cannot be joined along {dotted}: it {fault}")
        written = study.table.get(section, {}).get(name, default_of(SECTIONS[section], name))
        found.setdefault(size, size if written is dataclasses.MISSING or isinstance(written, list | tuple) else written)
    if not all(isinstance(size, int | float) and not isinstance(size, bool) for size in found):
        return list(found.values())
    sizes = sorted(found)
    return [found[size] for size, before in zip(sizes, [None, *sizes], strict=False) if not same(size, before)]


def _compared_keys(run: Run, case: Case) -> dict[str, Any]:
    """Every key in which two datasets of one case may not differ."""
    whole = {dotted: value for dotted, value in key_values(case, WHOLE_STUDY) if dotted not in _FREE_KEYS}
    path = {"loading.path": case.loading.path, "loading.unload": case.loading.unload}
    return {**run.deciding_keys(case), **path, **whole}


def _bins(run: Run, datasets: Sequence[DatasetReader]) -> Bins:
    """Bins of the joined study; those that all parts share where its height map is missing."""
    try:
        return run.study.bins
    except InputError:
        none = Bins.evenly((0, 1, 1), (0, 1, 1))
        first, *others = (dataset.bins(none) for dataset in datasets)
        if all(first.equal(other) for other in others):
            return first
        raise


def _holders(sources: Sequence[_Source], study: Study) -> list[list[tuple[int, int]]]:
    """Datasets that hold each case of the joined study: number of the dataset, number of the case in it."""
    held: list[list[tuple[int, int]]] = [[] for _ in study.cases]
    for which, source in enumerate(sources):
        for at, case in enumerate(source.run.study.cases):
            held[_position(study, case)].append((which, at))
    missing = [case for case, found in zip(study.cases, held, strict=True) if not found]
    if missing:
        raise InputError(
            f"the joined study lacks {len(missing)} of its {len(held)} cases, first {missing[0].label}; "
            "run them and give their datasets, too"
        )
    return held


def _check_agreement(held: Sequence[tuple[Path, StoredCase]], case: Case) -> None:
    """Refuse datasets that have different numbers of one case."""
    (first, one), *others = held
    for path, other in others:
        pairs = {"": (one.constants, other.constants)}
        for number in range(len(case.path)):
            pairs[f"point {number + 1}"] = one.step(number)[0], other.step(number)[0]
        for point, (mine, yours) in pairs.items():
            for name in {**mine, **yours}:
                if not name.endswith(_FREE) and not _equal(mine.get(name), yours.get(name)):
                    where = ", ".join(filter(None, (case.label, point)))
                    raise InputError(
                        f"{first} and {path} disagree{f' at {where}' if where else ''}: {name} is "
                        f"{_words(mine.get(name))} in the one and {_words(yours.get(name))} in the other; leave one of "
                        "them out"
                    )


def _equal(one: Any, other: Any) -> bool:
    """Whether two values of a quantity have the same bits; a sweep pads arrays of its smaller cells at their ends."""
    one, other = np.asarray(one), np.asarray(other)
    if one.ndim != other.ndim or one.dtype.kind != other.dtype.kind:
        return False
    shared = tuple(slice(min(pair)) for pair in zip(one.shape, other.shape, strict=True))
    return np.array_equal(one[shared], other[shared], equal_nan=one.dtype.kind == "f")


def _words(value: Any) -> str:
    if value is None:
        return "absent"
    return f"another field of mean {np.nanmean(value):.17g}" if np.ndim(value) else f"{np.asarray(value).item()!r}"


def _attributes(run: Run, sources: Sequence[_Source], notes: Sequence[str], command: str) -> dict[str, Any]:
    """Attributes of the root; those of all parts, a line each, where the parts differ."""
    try:
        warnings = check_study(run.model, run.study)
    except InputError:  # this machine could not run it
        warnings = []
    for source in sources:
        warnings += source.run.carried_warnings(source.attributes)
    commits = ", ".join(dict.fromkeys(str(source.attributes.get("git_commit")) for source in sources))
    if ", " in commits:
        warnings.append(f"the parts are of several commits: {commits}")
    return run.origin([source.attributes for source in sources], [*warnings, *notes], command, commits)
