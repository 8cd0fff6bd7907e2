"""The datasets to merge, and the one study that they are parts of: equal keys, and the union of their sweeps."""

import copy
import dataclasses
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from contact_study.campaign.dataset.file import ExistingDataset
from contact_study.campaign.model import MODELS, Model
from contact_study.campaign.record import Differences, RunRecord, describe_differences, differences, key_values
from contact_study.campaign.store.files import real
from contact_study.campaign.store.formats import engine_of, readable, require_dataset
from contact_study.inputs.errors import InputError
from contact_study.study.case import Case
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, same
from contact_study.study.schema.keys import default_of, keys_of, suggestion
from contact_study.study.study import Study, make_study

_SEED = "surface.seed"
# Attributes that all datasets share beside the study.
_SHARED = ("model", "version", "schema_version")
# Keys of the whole study that may differ.
_FREE = ("study.title", "output.restart")


@dataclasses.dataclass(frozen=True)
class Source(ExistingDataset):
    """One of the datasets to merge.

    Attributes
    ----------
    model : Model
        Its model.
    record : RunRecord
        The run that wrote it.
    """

    model: Model
    record: RunRecord

    @property
    def study(self) -> Study:
        """Its study."""
        return self.record.study


def read_sources(paths: Sequence[Path]) -> list[Source]:
    """Read the records of datasets of one model and version.

    Raises
    ------
    InputError
        If there are fewer than two, one is given twice, missing or foreign, or if models, versions or height maps
        differ.
    """
    if len(paths) < 2:
        raise InputError("give at least two datasets to join")
    seen: set[str] = set()
    for path in paths:
        if real(path) in seen:
            raise InputError(f"{path} is given twice")
        seen.add(real(path))
    first, *others = sources = [_read_source(path) for path in paths]
    maps: dict[str, tuple[Path, str]] = {}
    for source in sources:
        for name, content in source.record.height_maps.items():
            known, other = maps.setdefault(name, (source.path, content))
            if other != content:
                raise InputError(
                    f"{known} and {source.path} cannot be joined: the height map {name} had another content "
                    f"(SHA-256 {other[:12]}… and {content[:12]}…)"
                )
    for source in others:
        fault = next(
            (
                f"{name} is {first.attributes.get(name)} in the one and {source.attributes.get(name)} in the other"
                for name in _SHARED
                if first.attributes.get(name) != source.attributes.get(name)
            ),
            "",
        )
        if not fault and bool(first.record.predictor) != bool(source.record.predictor):
            fault = "one was run with --predictor, one without"
        if fault:
            raise InputError(f"{first.path} and {source.path} cannot be joined: {fault}")
    return sources


def _read_source(path: Path) -> Source:
    require_dataset(path)
    with readable(path), xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False) as dataset:
        attributes, sizes = dict(dataset.attrs), dict(dataset.sizes)
        held = {str(name): dataset[name].values.tolist() for name in dataset.dims if name in dataset.coords}
    kind = str(attributes.get("model"))
    if kind not in MODELS or "schema_version" not in attributes:
        raise InputError(f"{path}: is no dataset of bem-adhesion, md-reference or persson-theory")
    model = MODELS[kind]
    try:
        record = RunRecord.read(attributes, path.parent, model.ignores)
        record.require_height_maps()
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    for name, swept in record.study.sweep.items():
        if held.get(name) != list(swept.values):
            raise InputError(
                f"{path}: does not hold the points of {name} that its study sweeps ({sizes.get(name, 0)} of "
                f"{len(swept.values)}), as if it had been cut or joined by other means; give files as they were written"
            )
    return Source(path, attributes, model, record)


def joined_study(sources: Sequence[Source], along: Sequence[str] = ()) -> Study:
    """Make the study whose sweep holds the cases of every dataset.

    Its keys are those of the first dataset. A key that some dataset sweeps is swept, numbers in increasing order; the
    other datasets have one value of it each. Samples of one random surface that no dataset sweeps are joined over their
    seeds.

    Parameters
    ----------
    sources : sequence of Source
        The datasets.
    along : sequence of str
        Further keys, ``"section.key"``, whose values become a sweep.

    Raises
    ------
    InputError
        If the datasets differ in any other key; the message names it.
    """
    for dotted in along:
        _check_sweepable(dotted)
    swept = dict.fromkeys(dotted for source in sources for dotted in source.study.table.get("sweep", {}))
    swept |= dict.fromkeys(along)
    if _SEED not in swept and _differ_in_seeds(sources):
        swept[_SEED] = None
    first = sources[0]
    table = copy.deepcopy(first.study.table)
    for dotted in swept:
        if dotted not in table.get("sweep", {}):
            section, _, name = dotted.partition(".")
            table.get(section, {}).pop(name, None)
        table.setdefault("sweep", {})[dotted] = _values(sources, dotted)
    whole = dataclasses.replace(first.record, study=make_study(table, first.study.directory), height_maps=maps(sources))
    for source in sources:
        for case in source.study.cases:
            other = whole.study.cases[position(whole.study, case)]
            different = differences(_compared_keys(whole, other), _compared_keys(source.record, case))
            if different:
                raise InputError(f"{first.path} and {source.path} are of different studies: {_words(different)}")
    return whole.study


def maps(sources: Sequence[Source]) -> dict[str, str]:
    """SHA-256 of every height map of the datasets, by its path as the studies write it."""
    return {name: content for source in sources for name, content in source.record.height_maps.items()}


def position(study: Study, case: Case) -> int:
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


def _check_sweepable(dotted: str) -> None:
    sections = {section: declared for section, declared in SECTIONS.items() if section not in WHOLE_STUDY}
    known = [f"{section}.{name}" for section, declared in sections.items() for name in keys_of(declared)]
    if dotted not in known:
        raise InputError(f"--along {dotted}: is no key that a study sweeps{suggestion(dotted, known)}")


def _differ_in_seeds(sources: Sequence[Source]) -> bool:
    """Whether the datasets are of different samples of random surfaces, one each."""
    seeds = [{case.surface.realisation for case in source.study.cases} for source in sources]
    return all(len(own) == 1 and None not in own for own in seeds) and len(set.union(*seeds)) > 1


def _values(sources: Sequence[Source], dotted: str) -> list[Any]:
    """Every value that a dataset has of a key, as its study writes it; numbers in increasing order."""
    found: dict[Any, Any] = {}
    for source in sources:
        for size, written in _own_values(source, dotted):
            found.setdefault(size, written)
    if not all(isinstance(size, int | float) and not isinstance(size, bool) for size in found):
        return list(found.values())
    sizes = sorted(found)
    return [found[size] for size, before in zip(sizes, [None, *sizes], strict=False) if not same(size, before)]


def _own_values(source: Source, dotted: str) -> Iterator[tuple[Any, Any]]:
    """Values of a key in one dataset, in SI and as written."""
    study, (section, _, name) = source.study, dotted.partition(".")
    if dotted in study.table.get("sweep", {}):
        yield from zip(study.sweep[name].values, study.table["sweep"][dotted], strict=True)
        return
    values = dict.fromkeys(_value(case, dotted) for case in study.cases)
    if len(values) > 1 or None in values:
        raise InputError(
            f"{source.path} cannot be joined along {dotted}: it "
            + ("has several values of it at different points of its sweep" if len(values) > 1 else "has no value of it")
        )
    written = study.table.get(section, {}).get(name, default_of(SECTIONS[section], name))
    size = next(iter(values))
    yield size, size if written is dataclasses.MISSING or isinstance(written, list | tuple) else written


def _compared_keys(record: RunRecord, case: Case) -> dict[str, Any]:
    """Every key in which two datasets of one case may not differ."""
    whole = {dotted: value for dotted, value in key_values(case, WHOLE_STUDY) if dotted not in _FREE}
    path = {"loading.path": case.loading.path, "loading.unload": case.loading.unload}
    return {**record.deciding_keys(case), **path, **whole}


def _words(different: Differences) -> str:
    key, values = next(iter(different.items()))
    joinable = len(different) == 1 and key.partition(".")[0] not in WHOLE_STUDY
    joinable = joinable and not any(isinstance(value, tuple) for value in values)
    advice = f" (--along {key} joins them over it)" if joinable else ""
    return describe_differences(different, "in the one", "in the other") + advice
