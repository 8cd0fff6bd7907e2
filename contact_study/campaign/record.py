"""The study inside a dataset: model, keys and files of a run, and in what two such records differ.

Model, version, every key that the model reads, the content of height maps, the path up to a step and the predictor's
gap field decide its numbers; title, kept output, units and threads do not.
"""

import hashlib
import json
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_study.inputs.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.results.schema import SCHEMA_VERSION
from contact_study.study.case import Case
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, same
from contact_study.study.schema.keys import keys_of, shown
from contact_study.study.study import Study, make_study
from contact_study.version import __version__

if TYPE_CHECKING:
    from contact_study.campaign.model import Model

Differences = Mapping[str, tuple[Any, Any]]

# Keys of a case that decide no number, or only the numbers of some steps (see contact_study.campaign.resume).
_NOT_DECIDING = ("loading.path", "loading.unload", "solver.threads")

_NAMED_KEYS = 3  # differing keys that a message names


@dataclass(frozen=True)
class RunRecord:
    """The record of a run in a dataset or a work directory; maps and predictor by name and SHA-256."""

    kind: str
    study: Study
    height_maps: Mapping[str, str]
    ignores: tuple[str, ...] = ()
    version: str = __version__
    schema_version: str = SCHEMA_VERSION
    predictor: str = ""

    @classmethod
    def read(cls, attributes: Mapping[str, Any], directory: Path | str, ignores: tuple[str, ...] = ()) -> "RunRecord":
        """Read the record from global attributes; an InputError does not name the dataset."""
        try:
            study = make_study(tomllib.loads(str(attributes["study_toml"])), directory)
        except (KeyError, tomllib.TOMLDecodeError):
            raise InputError("does not hold the study it came from (attribute study_toml)") from None
        except InputError as error:
            raise InputError(f"its study is not one this version can read: {error}") from None
        kind, version, schema = (
            str(attributes.get(name, "unknown")) for name in ("model", "version", "schema_version")
        )
        maps = recorded_height_maps(attributes)
        return cls(kind, study, maps, ignores, version, schema, str(attributes.get("predictor", "")))

    @property
    def attributes(self) -> dict[str, str]:
        """The record as attributes of a dataset."""
        return {
            "model": self.kind,
            "study_toml": self.study.toml,
            "version": self.version,
            "schema_version": self.schema_version,
            "predictor": self.predictor,
            "height_maps": "\n".join(f"sha256:{content} {path}" for path, content in self.height_maps.items()),
        }

    def is_recorded_in(self, attributes: Mapping[str, Any]) -> bool:
        """Whether attributes record this very run."""
        return all(attributes.get(name) == value for name, value in self.attributes.items())

    def require_height_maps(self) -> None:
        """Raise InputError unless the content of every height map of the study is recorded."""
        for case in self.study.cases:
            if case.height_map is not None and str(case.surface.map_path) not in self.height_maps:
                raise InputError(f"does not record the content of its height map {case.surface.map_path}")

    def deciding_keys(self, case: Case) -> dict[str, Any]:
        """Return every key that decides the numbers of a case, with its value in SI."""
        sections = [section for section in SECTIONS if section not in (*WHOLE_STUDY, *self.ignores)]
        values = {dotted: value for dotted, value in key_values(case, sections) if dotted not in _NOT_DECIDING}
        if case.height_map is not None:
            values["surface.path"] = f"a file of SHA-256 {self.height_maps[str(case.surface.map_path)]}"
        return values

    @cached_property
    def case_texts(self) -> list[str]:
        """Keys that decide the numbers of each case, rounded to twelve digits, as a text."""
        return [json.dumps(_rounded(self.deciding_keys(case)), sort_keys=True) for case in self.study.cases]

    @cached_property
    def case_names(self) -> list[str]:
        """Name of each case by its deciding keys and its point of the sweep."""
        # Two points of a sweep may differ only in keys that decide no number, such as the threads.
        points = [json.dumps(_rounded(case.coordinates), sort_keys=True) for case in self.study.cases]
        texts = [f"[{text}, {point}]" for text, point in zip(self.case_texts, points, strict=True)]
        return [hashlib.sha256(text.encode()).hexdigest()[:16] for text in texts]


@dataclass(frozen=True)
class Run:
    """A run of a model on a study, by its dataset's record; steps may start from the predictor's gap fields."""

    model: "Model"
    record: RunRecord
    bins: Bins
    predictor: Path | None = None

    @property
    def study(self) -> Study:
        """The study."""
        return self.record.study


def prepare_run(model: "Model", study: Study, bins: Bins, predictor: Path | None = None) -> Run:
    """Describe the run of a model on a study; hashes the height maps and the predictor."""
    maps = {str(case.surface.map_path): case.height_map for case in study.cases if case.height_map is not None}
    hashes = {name: content_hash(path) for name, path in maps.items()}
    start = f"{predictor.name} sha256:{content_hash(predictor)}" if predictor else ""
    return Run(model, RunRecord(model.kind, study, hashes, model.ignores, predictor=start), bins, predictor)


def content_hash(path: Path) -> str:
    """SHA-256 of a file's content, or of the names and contents of all files of a folder."""
    if path.is_dir():
        files = sorted(one.relative_to(path).as_posix() for one in path.rglob("*") if one.is_file())
        return hashlib.sha256(json.dumps([(name, content_hash(path / name)) for name in files]).encode()).hexdigest()
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def recorded_height_maps(attributes: Mapping[str, Any]) -> dict[str, str]:
    """SHA-256 of each height map that attributes record, by its path as the study writes it."""
    lines = str(attributes.get("height_maps", "")).splitlines()
    pairs = (line.partition(" ") for line in lines)
    return {path: content.removeprefix("sha256:") for content, _, path in pairs}


def key_values(case: Case, sections: Iterable[str] = SECTIONS) -> Iterator[tuple[str, Any]]:
    """Yield every key of some sections of a case, ``"section.key"``, with its value in SI."""
    for section in sections:
        content = getattr(case, section)
        for name in keys_of(type(content)):
            yield f"{section}.{name}", getattr(content, name)


def differences(one: Mapping[str, Any], other: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Return the keys whose values differ, with both values; a missing key has the value None."""
    pairs = {key: (one.get(key), other.get(key)) for key in {**one, **other}}
    return {key: pair for key, pair in pairs.items() if not same(*pair)}


def describe_differences(different: Differences, one: str, other: str) -> str:
    """Name differing keys for a message: ``key is 1 there and 2 here``; ``one`` and ``other`` name the sides."""
    words = [f"{key} is {shown(left)} {one} and {shown(right)} {other}" for key, (left, right) in different.items()]
    more = f", and {len(words) - _NAMED_KEYS} keys more differ" if len(words) > _NAMED_KEYS else ""
    return ", ".join(words[:_NAMED_KEYS]) + more


def _rounded(value: Any) -> Any:
    """Round floats to twelve digits: a value in another unit differs by a rounding, and files keep their names."""
    if isinstance(value, Mapping):
        return {name: _rounded(content) for name, content in value.items()}
    if isinstance(value, tuple):
        return [_rounded(item) for item in value]
    return float(f"{value:.12g}") if isinstance(value, float) else value
