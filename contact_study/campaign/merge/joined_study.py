"""The one study that several datasets are parts of: their keys side by side, their sweeps together."""

import copy
import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from contact_study.campaign.merge.sources import Source
from contact_study.campaign.resume.identity import Cases, differing_keys, rounded
from contact_study.errors import InputError
from contact_study.study.case import Case
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, same
from contact_study.study.schema.keys import default_of, keys_of, shown, suggestion
from contact_study.study.study import Study, make_study

_SEED = "surface.seed"
_SHOWN = 3  # differing keys that a message names
# Keys of the whole study that decide neither a number nor how it is kept.
_FREE = ("study.title", "output.restart")


def joined_study(sources: Sequence[Source], along: Sequence[str] = ()) -> Study:
    """The study whose sweep holds the cases of every dataset.

    Its keys are the first dataset's. What some dataset sweeps is swept, numbers in increasing order; the others have
    one value of it each. Samples of one random surface that no dataset sweeps are joined over their seeds.

    Parameters
    ----------
    sources : sequence of Source
        The datasets.
    along : sequence of str
        Keys, ``"section.key"``, whose values in the datasets become a sweep, too.

    Raises
    ------
    InputError
        If the datasets differ in any other key, which the message names.
    """
    for dotted in along:
        _check_sweepable(dotted)
    swept = dict.fromkeys(dotted for source in sources for dotted in source.study.table.get("sweep", {}))
    swept |= dict.fromkeys(dotted for dotted in along)
    if _SEED not in swept and _differ_in_seeds(sources):
        swept[_SEED] = None
    table = copy.deepcopy(sources[0].study.table)
    for dotted in swept:
        if dotted not in table.get("sweep", {}):
            section, _, name = dotted.partition(".")
            table.get(section, {}).pop(name, None)
        table.setdefault("sweep", {})[dotted] = _values(sources, dotted)
    study = make_study(table, sources[0].study.directory)
    whole = Cases(sources[0].model, study, {name: content for s in sources for name, content in s.height_maps.items()})
    for source in sources:
        _check_same(whole, sources[0], source)
    return study


def place_of(study: Study, case: Case) -> int:
    """Number of the case of a joined study that stands at the same point of its sweep."""
    number = 0
    for dotted in study.table.get("sweep", {}):
        values, value = study.sweep[dotted.rpartition(".")[2]].values, _value(case, dotted)
        alike = (at for at, other in enumerate(values) if same(value, other))
        number = number * len(values) + (values.index(value) if value in values else next(alike))
    return number


def _value(case: Case, dotted: str) -> Any:
    """What a case has of a key, one number for a pair of equal ones, as a sweep holds it."""
    section, _, name = dotted.partition(".")
    value = getattr(getattr(case, section), name, None)
    return value[0] if isinstance(value, tuple) and len(value) == 2 and value[0] == value[1] else value


def _check_sweepable(dotted: str) -> None:
    known = [
        f"{section}.{name}"
        for section, declared in SECTIONS.items()
        if section not in WHOLE_STUDY
        for name in keys_of(declared)
    ]
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


def _check_same(whole: Cases, first: Source, source: Source) -> None:
    """Refuse a dataset whose cases are not those of the joined study at their places."""
    for case in source.study.cases:
        one = _keys(whole, whole.study.cases[place_of(whole.study, case)])
        different = dict(differing_keys(one, _keys(source, case)))
        if different:
            raise InputError(f"{first.path} and {source.path} are of different studies: {_words(different)}")


def _keys(cases: Cases, case: Case) -> dict[str, Any]:
    """Every key by which a dataset of one case differs from another's but its title and the work it took."""
    values = cases.deciding(case)
    values["loading.path"], values["loading.unload"] = rounded(case.loading.path), case.loading.unload
    for section in WHOLE_STUDY:
        for name in keys_of(SECTIONS[section]):
            if f"{section}.{name}" not in _FREE:
                values[f"{section}.{name}"] = rounded(getattr(getattr(case, section), name))
    return values


def _words(different: Mapping[str, tuple[Any, Any]]) -> str:
    words = [
        f"{name} is {shown(one)} in the one and {shown(two)} in the other" for name, (one, two) in different.items()
    ]
    more = f", and {len(words) - _SHOWN} keys more differ" if len(words) > _SHOWN else ""
    alone = next(iter(different))
    advice = ""
    if (
        len(different) == 1
        and not any(isinstance(value, list) for value in different[alone])
        and (alone.partition(".")[0] not in WHOLE_STUDY)
    ):
        advice = f" (--along {alone} joins them over it)"
    return ", ".join(words[:_SHOWN]) + more + advice
