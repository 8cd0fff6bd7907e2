"""A study while it is written on a page: what its keys are, what the checks say of it, where it is kept.

A draft is the table that a study file holds. Nothing here has widgets.
"""

import copy
import json
import re
import tomllib
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from contact_study.campaign import expectation
from contact_study.campaign.model import MODELS
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import stress
from contact_study.results.schema import SPECTRUM_MARK
from contact_study.study.case import realise
from contact_study.study.checks import describe_maps
from contact_study.study.schema.dotted_keys import SECTIONS, read, replace_keys, split, typed, written
from contact_study.study.schema.keys import MISSING, Key, TaggedUnion, as_written, default_of, keys_of
from contact_study.study.study import Study, make_study
from contact_study.study.uncertainty import DRAW

Table = dict[str, Any]
LARGEST_UPLOAD = 256 * 2**20  # bytes
_NEVER = (".toml", ".py", ".pkl", ".pickle")  # of uploads: code, and lists of further files
_NAME = re.compile(r"[\w][\w .()+-]{0,80}")
_COARSE = 64  # points along the shorter side of a first look
_CURVE = np.geomspace(0.01, 1.0, 10)  # pressures of the theory's curve over the largest of the study
_GOOD, _FAIR, _BAD, _PLAIN = "good", "fair", "bad", "plain"


@dataclass(frozen=True)
class Light:
    """One line of the checks: a kind (good, fair, bad or plain), what it is of, and words."""

    kind: str
    title: str
    words: str


@dataclass(frozen=True)
class Judgement:
    """Answer of the checks: the study, None with an ``error``; lights; further lines."""

    study: Study | None
    lights: list[Light] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)
    error: str = ""


def parsed(text: str) -> Table:
    """The table of a study's text; InputError with the place of a mistake."""
    try:
        return tomllib.loads(text)
    except ValueError as error:
        raise InputError(f"the text of the study: {error}") from None


def text_of(table: Mapping[str, Any]) -> str:
    """The text of a study file."""
    return tomli_w.dumps(table)


def keys_shown(table: Table, section: str) -> dict[str, tuple[Key, str, str]]:
    """Declaration, default and value, as one types them, of the keys that a section has with the kind chosen."""
    declared, content, swept = SECTIONS[section], table.get(section, {}), table.get("sweep", {})
    kind = declared.section_of(content) if isinstance(declared, TaggedUnion) else declared
    found = {}
    for name, key in keys_of(declared).items():
        if kind is not None and name not in keys_of(kind):
            continue
        default = default_of(declared if kind is None or name == getattr(declared, "tag", "") else kind, name)
        words = "" if default in (MISSING, None) else as_written(default)
        value = swept.get(f"{section}.{name}", content.get(name))
        found[name] = key, words, "" if value is None else _typed_back(value)
    return found


def _typed_back(value: Any) -> str:
    """Return what a user types for a value."""
    if isinstance(value, bool | dict) or (isinstance(value, list) and any(isinstance(one, list) for one in value)):
        return json.dumps(value)
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def with_key(table: Table, dotted: str, text: str) -> Table:
    """The draft with another value of a key; without the key if the text is empty."""
    section, name = split(dotted, "")
    changed = copy.deepcopy(table)
    if text.strip():
        replace_keys(changed, {dotted: typed(text.strip())})
    else:
        changed.get(section, {}).pop(name, None)
        changed.get("sweep", {}).pop(dotted, None)
        changed = {name: content for name, content in changed.items() if content or name not in ("sweep", section)}
    return changed


def check_inside(table: Table, folder: Path) -> None:
    """InputError if a draft names a file outside the folder, or an object of a Python module."""
    for dotted, given in written(table):
        section, _, name = dotted.partition(".")
        for value in given if isinstance(given, list) else [given]:  # a sweep has several
            if name == "object" or (name in ("kind", "law") and isinstance(value, str) and ":" in value):
                raise InputError(f"{dotted} = {value!r}: the page runs no Python code; use bem-adhesion run")
            if section != "loading" and (name == "path" or name.endswith("_path")) and isinstance(value, str):
                inside(folder, value)


def inside(folder: Path, name: str) -> Path:
    """A path below the folder; InputError for one that leads out of it."""
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise InputError(f"{name}: lies outside the folder of this page; copy the file into {folder.name}")
    return path


def keep_upload(folder: Path, name: str, content: bytes) -> Path:
    """Keep an uploaded map in the folder under a free name; InputError for a name or size that the page refuses."""
    plain = Path(name).name
    if not _NAME.fullmatch(plain) or not Path(plain).suffix or Path(plain).suffix.lower() in _NEVER:
        raise InputError(f"{name!r}: no name of a height map; use letters and digits, and an ending such as .npy")
    if len(content) > LARGEST_UPLOAD:
        raise InputError(f"{plain}: has {len(content) >> 20} MB; the page takes {LARGEST_UPLOAD >> 20}, copy the file")
    return _kept(folder, Path(plain).stem, Path(plain).suffix, content)


def keep_study(folder: Path, name: str, table: Table) -> Path:
    """Write a draft to a study file of the folder; a name that another study has gets a number."""
    if not _NAME.fullmatch(name):
        raise InputError(f"{name!r}: no name of a study; use letters and digits")
    return _kept(folder, name.removesuffix(".toml"), ".toml", text_of(table).encode())


def _kept(folder: Path, stem: str, suffix: str, content: bytes) -> Path:
    """Write a new file, or find the one with this content."""
    for number in range(1, 1000):
        path = folder / f"{stem}{f'-{number}' if number > 1 else ''}{suffix}"
        try:
            with path.open("xb") as file:
                file.write(content)
        except FileExistsError:
            if path.is_file() and path.read_bytes() != content:
                continue
        return path
    raise InputError(f"{stem}{suffix}: all its numbers are taken; choose another name")


def judge(table: Table, folder: Path) -> Judgement:
    """Check a draft as ``bem-adhesion check`` does."""
    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always")
        try:
            check_inside(table, folder)
            study = make_study(copy.deepcopy(table), folder)
            lights, notes = [], dict[str, None]()
            for model in MODELS:
                try:
                    _, memory, time, remark, found = expectation.judged(model, study)
                    words = f"{memory} a case, {time} on one core" + (f"; {remark}" if remark else "")
                    lights.append(Light(_GOOD, model, words))
                    notes.update(dict.fromkeys(found))
                except InputError as error:
                    lights.append(Light(_PLAIN, model, str(error)))
            if all(light.kind == _PLAIN for light in lights):
                lights = [Light(_BAD, light.title, light.words) for light in lights]
            title = ""
            for number, value, words in expectation.numbers(study.cases):
                title = number or title
                lights.append(Light(_kind(title, words), f"{title}: {value}", words))
        except (InputError, OSError, MemoryError) as error:
            return Judgement(None, error=str(error) or "not enough memory; use fewer points")
    modulus = stress(study.cases[0].solid.contact_modulus)
    lines = [*expectation.extent(study), f"E* = {modulus}", *study.choices, *describe_maps(study.cases)]
    lights += [Light(_FAIR, "warning", note) for note in [*notes, *(str(one.message) for one in raised)]]
    return Judgement(study, lights, lines)


def _kind(title: str, words: str) -> str:
    """Kind of a number's light: grids are good to bad; the others only tell what to expect."""
    kinds = zip((_GOOD, _FAIR, _BAD), expectation.meanings()[title].values(), strict=False)
    return next(kind for kind, meant in kinds if words.startswith(meant)) if title == expectation.ZONE else _PLAIN


def coarser(table: Table, folder: Path) -> Table:
    """The draft on half its points along each side, again and again, as long as it can run and has more than 64."""
    found = table
    while given := found.get("surface", {}).get("shape"):
        shape = read("surface.shape", given)
        if min(shape) < 2 * _COARSE or any(points % 2 for points in shape):
            break
        half = with_key(found, "surface.shape", str([points // 2 for points in shape]))
        try:
            make_study(copy.deepcopy(half), folder)
        except InputError:
            break
        found = half
    return found


def theory_curve(study: Study) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Pressure (Pa) and relative contact area by each theory, for the first case; empty if they do not apply."""
    case, highest = study.cases[0], max(study.cases[0].loading.path)
    if case.loading.control != "pressure" or highest <= 0:
        return {}
    part = {name: value for name, value in study.table.items() if name not in ("sweep", "override", "uncertainty")}
    part = copy.deepcopy(part)
    swept = study.table.get("sweep", {}).items()
    replace_keys(part, {dotted: values[0] for dotted, values in swept if dotted != DRAW})
    part["loading"] = {"path": [float(one) for one in highest * _CURVE]}
    (case,), curves = make_study(part, study.directory).cases, dict[str, list[float]]()
    code = MODELS["theory"].code
    code.check(case)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for step in code.solve_path(case, realise(case), restart=None, start=0):
            for name, value in step.values.items():
                theory, _, quantity = name.partition("/")  # of the first spectrum, not of branches
                if quantity == "relative_contact_area" and SPECTRUM_MARK not in theory:
                    curves.setdefault(theory, []).append(float(value))
    return {theory: (highest * _CURVE[: len(areas)], np.array(areas)) for theory, areas in curves.items()}
