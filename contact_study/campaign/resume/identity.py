"""What decides the numbers of a run, case by case and step by step, and in what two runs differ.

The numbers of a step follow from the model and its version, from every key of the case that the model reads (a height
map by its content), from the points of the path up to the step, of an adaptive path from its least step, too, and from
the gap field that a predictor gave. The title, what is kept, the unit a value is written in and the number of threads
decide nothing.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import contact_study
from contact_study.campaign.model import Model
from contact_study.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.results.schema import SCHEMA_VERSION
from contact_study.study.case import Case
from contact_study.study.load_steps import path_points_of
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY
from contact_study.study.schema.keys import keys_of, shown
from contact_study.study.study import Study, make_study

# Keys of a case that decide none of its numbers, or decide them in a way of their own.
_APART = ("loading.path", "loading.unload", "solver.threads")

# What a step keeps on demand, in rising order, by the key of [output].
_KEPT: Mapping[str, tuple[Any, ...]] = {"fields": (False, True), "atoms": ("none", "surface", "block")}

_SHOWN = 3  # differing keys that a message names


class NotKeptError(InputError):
    """What an earlier run of the same study holds would be lost, or has changed; the message says what to do."""


@dataclass(frozen=True)
class Cases:
    """The cases of a study as a model meets them.

    Attributes
    ----------
    model : Model
        The model.
    study : Study
        The study.
    height_maps : dict
        SHA-256 of each height map by its path as the study writes it.
    """

    model: Model
    study: Study
    height_maps: Mapping[str, str]

    def deciding(self, case: Case) -> dict[str, Any]:
        """Every key that decides the numbers of a case, and its value in SI."""
        values: dict[str, Any] = {}
        for section in SECTIONS:
            if section not in (*WHOLE_STUDY, *self.model.ignores):
                for name in keys_of(type(getattr(case, section))):
                    values[f"{section}.{name}"] = rounded(getattr(getattr(case, section), name))
        for dotted in _APART:
            values.pop(dotted, None)
        if case.height_map is not None:
            values["surface.path"] = f"a file of SHA-256 {self.height_maps[str(case.surface.map_path)]}"
        return values

    @cached_property
    def texts(self) -> list[str]:
        """What decides the numbers of each case, as a text that is equal where they are."""
        return [json.dumps(self.deciding(case), sort_keys=True) for case in self.study.cases]

    def case_names(self) -> list[str]:
        """A name for each case that follows from what decides its numbers and from its place in the sweep."""
        names = []
        for case, text in zip(self.study.cases, self.texts, strict=True):
            # Two points of a sweep may differ in nothing that decides a number, such as the threads.
            apart = {name: rounded(value) for name, value in case.coordinates.items()}
            whole = f"[{text}, {json.dumps(apart, sort_keys=True)}]"
            names.append(hashlib.sha256(whole.encode()).hexdigest()[:16])
        return names


@dataclass(frozen=True)
class Run(Cases):
    """A model, a study and the content of the files that they read.

    Attributes
    ----------
    bins : Bins
        Those of the study's distributions.
    predictor : pathlib.Path or None
        Dataset whose gap fields the steps start from.
    predictor_content : str
        Its SHA-256.
    """

    bins: Bins
    predictor: Path | None = None
    predictor_content: str = ""

    @property
    def attributes(self) -> dict[str, str]:
        """The run as attributes of its dataset."""
        return {
            "model": self.model.kind,
            "study_toml": self.study.toml,
            "version": contact_study.__version__,
            "schema_version": SCHEMA_VERSION,
            "predictor": f"{self.predictor.name} sha256:{self.predictor_content}" if self.predictor else "",
            "height_maps": "\n".join(f"sha256:{content} {path}" for path, content in self.height_maps.items()),
        }


def rounded(value: Any) -> Any:
    """Floats to twelve digits: a value written in another unit differs by a rounding."""
    if isinstance(value, tuple):
        return [rounded(item) for item in value]
    return float(f"{value:.12g}") if isinstance(value, float) else value


def run_of(model: Model, study: Study, bins: Bins, predictor: Path | None = None) -> Run:
    """The run of a model on a study, its files looked at."""
    maps = {str(case.surface.map_path): case.height_map for case in study.cases if case.height_map is not None}
    contents = {name: content_hash(path) for name, path in maps.items()}
    return Run(model, study, contents, bins, predictor, content_hash(predictor) if predictor else "")


def content_hash(path: Path) -> str:
    """SHA-256 of a file's content, or of the names and contents of all files of a folder."""
    if path.is_dir():
        files = sorted(one.relative_to(path).as_posix() for one in path.rglob("*") if one.is_file())
        return hashlib.sha256(json.dumps([(name, content_hash(path / name)) for name in files]).encode()).hexdigest()
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


@dataclass(frozen=True)
class Match:
    """Where the numbers of a case stand in an earlier run.

    Attributes
    ----------
    earlier : int
        Number of the case there.
    steps : int
        How many of its steps have the same numbers.
    anew : str
        Why steps that the earlier run has must be computed again; empty if none must.
    """

    earlier: int
    steps: int
    anew: str = ""


def match(attributes: Mapping[str, Any], run: Run) -> tuple[Cases, dict[int, Match]]:
    """The earlier run that attributes describe, and its part in this one, by the number of this one's cases.

    An earlier run may be widened, by points of the sweep or of the path and by what is kept; nothing of it is given up.

    Raises
    ------
    InputError
        If this run is another one; the message says in what, without saying where the earlier run is.
    NotKeptError
        If it is the same but for what it keeps, or its height map has changed.
    """
    _check_program(attributes, run)
    earlier = _earlier(attributes, run)
    free: dict[str, list[int]] = {}
    for number, text in enumerate(run.texts):
        free.setdefault(text, []).append(number)
    matches: dict[int, Match] = {}
    for number, case in enumerate(earlier.study.cases):
        alike = free.get(earlier.texts[number])
        if not alike:
            others = [run.deciding(other) for other in run.study.cases]
            raise InputError(_differences(earlier.deciding(case), others, case, run.study))
        # Of cases that differ in nothing but how far they go (unload swept) the same one comes first.
        chosen = min(alike, key=lambda other: run.study.cases[other].loading.unload != case.loading.unload)
        matches[chosen] = _match(number, case, run.study.cases[chosen], run)
        alike.remove(chosen)
    return earlier, matches


def _check_program(attributes: Mapping[str, Any], run: Run) -> None:
    wanted = run.attributes
    for name in ("model", "version", "schema_version"):
        if attributes.get(name) != wanted[name]:
            raise InputError(f"{name} is {attributes.get(name, 'unknown')} there and {wanted[name]} here")
    there = str(attributes.get("predictor", ""))
    if bool(there) != bool(run.predictor):
        raise InputError(f"--predictor is {there.partition(' ')[0] or 'none'} there and {run.predictor or 'none'} here")


def _earlier(attributes: Mapping[str, Any], run: Run) -> Cases:
    import tomllib

    maps = recorded_height_maps(attributes)
    try:
        study = make_study(tomllib.loads(str(attributes["study_toml"])), run.study.directory)
    except (KeyError, tomllib.TOMLDecodeError, InputError):
        raise InputError("its study cannot be read") from None
    if any(case.height_map is not None and case.surface.map_path not in maps for case in study.cases):
        raise InputError("it does not say what its height map held")
    return Cases(run.model, study, maps)


def recorded_height_maps(attributes: Mapping[str, Any]) -> dict[str, str]:
    """SHA-256 of each height map of a dataset, by its path as the study writes it."""
    maps = {}
    for line in str(attributes.get("height_maps", "")).splitlines():
        content, _, path = line.partition(" ")
        maps[path] = content.removeprefix("sha256:")
    return maps


def _differences(values: dict[str, Any], others: Sequence[dict[str, Any]], case: Case, study: Study) -> str:
    """In what a case that is not found differs from the nearest that is there."""
    nearest = min(others, key=lambda other: sum(1 for _ in differing_keys(values, other)))
    differing = dict(differing_keys(values, nearest))
    if list(differing) == ["surface.path"] and case.height_map is not None:
        one, two = (str(value).rpartition(" ")[2][:12] for value in differing["surface.path"])
        raise NotKeptError(
            f"the height map {case.surface.map_path} has changed since it was started (SHA-256 {one}… then, {two}… "
            "now); use another output, or --overwrite"
        )
    lost = {dotted.rpartition(".")[2] for dotted in differing} & set(case.coordinates) & set(study.sweep)
    if len(lost) == len(differing):
        return f"the study has its point {case.label} no longer"
    words = [f"{dotted} is {shown(one)} there and {shown(two)} here" for dotted, (one, two) in differing.items()]
    more = f", and {len(words) - _SHOWN} keys more differ" if len(words) > _SHOWN else ""
    return ", ".join(words[:_SHOWN]) + more


def differing_keys(values: dict[str, Any], other: dict[str, Any]) -> Iterator[tuple[str, tuple[Any, Any]]]:
    """Keys of :meth:`Cases.deciding` that tell two cases apart, with the values of both."""
    for dotted in {**values, **other}:
        if values.get(dotted) != other.get(dotted):
            yield dotted, (values.get(dotted), other.get(dotted))


def _match(number: int, case: Case, other: Case, run: Run) -> Match:
    """How much of a case stands in another that differs in nothing but its path and what is kept."""
    where = f" at {case.label}" if case.label else ""
    more = []
    for name in run.model.keeps:
        there, here = getattr(case.output, name), getattr(other.output, name)
        if (change := _KEPT[name].index(here) - _KEPT[name].index(there)) < 0:
            raise NotKeptError(
                f"it keeps {name} by output.{name} = {_word(there)}, this study has {_word(here)}: set it so, or use "
                "another output or --overwrite"
            )
        more += [name] * (change > 0)
    if case.loading.unload and not other.loading.unload:
        raise InputError(f"loading.unload is true there and false here{where}")
    before, after = (path_points_of(one) for one in (case, other))
    length = len(case.loading.path)
    if after[:length] != before[:length]:
        raise InputError(f"loading.path{where} does not begin with the {length} points that are there")
    fields_anew = _fields_anew(case, other) if "fields" in run.model.keeps and case.output.fields else ""
    same = next((i for i, pair in enumerate(zip(before, after, strict=False)) if pair[0] != pair[1]), len(before))
    for name in more:
        asked = _word(getattr(other.output, name))
        return Match(number, 0, f"output.{name} = {asked}: {name} that were not kept cannot be made from nothing")
    if fields_anew:
        return Match(number, 0, fields_anew)
    if run.model.whole_path and before != after:
        return Match(number, 0, "the path has changed, and what its points share is computed from all of them")
    if run.model.own_steps and case.least_step != other.least_step:
        return Match(number, 0, "the least step of loading.adaptive follows the largest value of the path, which grew")
    if not _ranges_hold(case, run.bins):
        return Match(number, 0, "the distributions there were counted in a narrower range")
    if same < len(before):
        return Match(number, same, "unloading starts from another point")
    return Match(number, same)


def _fields_anew(case: Case, other: Case) -> str:
    """Why steps that keep fields must be computed again, for more of these; empty if none must.

    Raises
    ------
    NotKeptError
        If less of them would be kept.
    """
    digits = case.output.field_precision, other.output.field_precision
    if case.kept_fields - other.kept_fields:
        raise NotKeptError(
            "it keeps fields of points that output.field_steps leaves out: name them, too, or use another output or "
            "--overwrite"
        )
    if digits == ("double", "single"):
        raise NotKeptError(
            "it keeps fields by output.field_precision = double, this study has single: set it so, or use another "
            "output or --overwrite"
        )
    if other.kept_fields.intersection(range(len(case.path))) - case.kept_fields:
        return "output.field_steps: fields that were not kept cannot be made from nothing"
    if digits == ("single", "double"):
        return "output.field_precision = double: digits that were not kept cannot be made up"
    return ""


def _word(value: bool | str) -> str:
    """A flag or a choice as a study file has it."""
    return value if isinstance(value, str) else str(value).lower()


def _ranges_hold(case: Case, bins: Bins) -> bool:
    """Whether ranges that a study has chosen for its distributions hold all of the bins asked for."""
    asked = (bins.pressure_edges, bins.gap_edges)
    for chosen, edges in zip((case.output.pressure_range, case.output.gap_range), asked, strict=True):
        slack = 1e-9 * (edges[-1] - edges[0])
        if chosen is not None and not chosen[0] - slack <= edges[0] < edges[-1] <= chosen[1] + slack:
            return False
    return True
