"""The study inside a dataset: model, keys and files of a run, its origin, and in what two such records differ.

Model, version, every key that the model reads, the content of height maps, the path up to a step and the predictor's
gap field decide its numbers; title, kept output, units and threads do not.
"""

import hashlib
import json
import os
import subprocess
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from contact_study.campaign.model import Model, check_study
from contact_study.inputs.errors import InputError
from contact_study.inputs.files import content_hash
from contact_study.results.schema import CONVENTIONS, SCHEMA_VERSION
from contact_study.study.case import Case
from contact_study.study.schema.dotted_keys import SECTIONS, WHOLE_STUDY, same
from contact_study.study.schema.keys import keys_of, shown
from contact_study.study.study import Study, make_study
from contact_study.version import __version__

# Keys of a case that decide no number, or only the numbers of some steps (see contact_study.campaign.resume).
_NOT_DECIDING = ("loading.path", "loading.unload", "loading.cycles", "solver.threads")

_NAMED_KEYS = 3  # differing keys that a message names

_PLACE = "contact_study/campaign/"  # of this file's folder in a checkout


@dataclass(frozen=True)
class Run:
    """A run of a model on a study, as attributes record it; height maps and predictor by name and SHA-256."""

    model: Model
    study: Study
    height_maps: Mapping[str, str]
    predictor: str = ""
    start: Path | None = None  # the predictor, from whose gap fields steps may start

    @classmethod
    def read(cls, attributes: Mapping[str, Any], directory: Path, model: Model) -> "Run":
        """Read the record of a run of this model from global attributes; an InputError does not name the dataset."""
        study, maps = recorded_study(attributes, directory), recorded_height_maps(attributes)
        for case in study.cases:
            for path in case.height_maps:
                if path not in maps:
                    raise InputError(f"does not record the content of its height map {path}")
        return cls(model, study, maps, str(attributes.get("predictor", "")))

    @property
    def attributes(self) -> dict[str, str]:
        """The record as attributes of a dataset."""
        return {
            "model": self.model.kind,
            "study_toml": self.study.toml,
            "version": __version__,
            "schema_version": SCHEMA_VERSION,
            "predictor": self.predictor,
            "height_maps": "\n".join(f"sha256:{content} {path}" for path, content in self.height_maps.items()),
        }

    def deciding_keys(self, case: Case) -> dict[str, Any]:
        """Return every key that decides the numbers of a case, with its value in SI."""
        sections = [section for section in SECTIONS if section not in (*WHOLE_STUDY, *self.model.ignores)]
        values = {dotted: value for dotted, value in key_values(case, sections) if dotted not in _NOT_DECIDING}
        files = {dotted: path for dotted, path in case.map_keys.items() if dotted in values}
        return values | {dotted: f"a file of SHA-256 {self.height_maps[path]}" for dotted, path in files.items()}

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

    def origin(
        self, earlier: Sequence[Mapping[str, Any]], warnings: Sequence[str], command: str, commit: str
    ) -> dict[str, Any]:
        """All attributes of the dataset; ``command`` heads the history, that of ``earlier`` datasets follows."""
        history = [f"{datetime.now(UTC).isoformat(timespec='seconds')}: {command}"]
        for own in earlier:
            history += str(own.get("history", "")).splitlines()
        return {
            "Conventions": CONVENTIONS,
            "title": self.study.title,
            "source": f"bem-adhesion {__version__}, {self.model.command}: {self.model.description}",
            "history": "\n".join(dict.fromkeys(history)),
            "references": self.model.references,
            "git_commit": commit,
            "warnings": "\n".join(dict.fromkeys(warnings)),
            **self.attributes,
        }

    def carried_warnings(self, attributes: Mapping[str, Any]) -> list[str]:
        """Warnings of this earlier run's dataset about its steps, without those about its study as a whole."""
        try:
            study_notes = check_study(self.model, self.study)
        except InputError:  # a height map has moved since
            study_notes = []
        return [line for line in str(attributes.get("warnings", "")).splitlines() if line not in study_notes]


def prepare_run(model: Model, study: Study, start: Path | None = None) -> Run:
    """Describe the run of a model on a study; hashes the height maps and the predictor."""
    maps = {name: path for case in study.cases for name, path in case.height_maps.items()}
    hashes = {name: content_hash(path) for name, path in maps.items()}
    return Run(model, study, hashes, f"{start.name} sha256:{content_hash(start)}" if start else "", start)


def recorded_study(attributes: Mapping[str, Any], directory: Path) -> Study:
    """Read the study that attributes record; an InputError does not name the dataset."""
    try:
        return make_study(tomllib.loads(str(attributes["study_toml"])), directory)
    except (KeyError, tomllib.TOMLDecodeError):
        raise InputError("does not hold the study it came from (attribute study_toml)") from None
    except InputError as error:
        raise InputError(f"its study is not one this version can read: {error}") from None


def recorded_height_maps(attributes: Mapping[str, Any]) -> dict[str, str]:
    """SHA-256 of each height map that attributes record, by its path as the study writes it."""
    pairs = (line.partition(" ") for line in str(attributes.get("height_maps", "")).splitlines())
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


def describe_differences(different: Mapping[str, tuple[Any, Any]], one: str, other: str) -> str:
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


@cache
def git_commit() -> str:
    """Commit of the checkout that runs, marked if it has been changed; "unknown" outside one."""

    def git(*words: str) -> str:
        command = ["git", "-C", os.path.dirname(__file__), *words]
        return subprocess.run(command, capture_output=True, text=True, timeout=10).stdout.strip()

    try:
        # In an environment inside someone else's repository this file does not belong to that repository.
        own = git("rev-parse", "--show-prefix") == _PLACE
        return (own and git("describe", "--always", "--dirty", "--abbrev=40", "--exclude=*")) or "unknown"
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
