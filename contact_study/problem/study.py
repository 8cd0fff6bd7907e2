"""A study file: read, checked and expanded into cases.

A :class:`Study` is the file, a :class:`~contact_study.problem.case.Case` one point of its sweep.
"""

import itertools
import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

from contact_study.problem import automatic, sections
from contact_study.problem.case import Case
from contact_study.problem.elasticity import ELASTICITIES
from contact_study.problem.errors import InputError
from contact_study.problem.keys import Key, Kinds, bind, default_of, keys_of, listed
from contact_study.problem.laws import INTERACTIONS
from contact_study.problem.spectrum_file import with_spectrum
from contact_study.problem.surfaces import SURFACES
from contact_study.problem.tables import with_columns
from contact_study.problem.units import EXAMPLES

SECTIONS: dict[str, type | Kinds] = {
    "study": sections.StudySection,
    "surface": SURFACES,
    "material": sections.MaterialSection,
    "elasticity": ELASTICITIES,
    "interaction": INTERACTIONS,
    "loading": sections.LoadingSection,
    "solver": sections.SolverSection,
    "atomistic": sections.AtomisticSection,
    "overdamped": sections.OverdampedSection,
    "sampling": sections.SamplingSection,
    "dynamics": sections.DynamicsSection,
    "theory": sections.TheorySection,
    "output": sections.OutputSection,
}
WHOLE_STUDY = ("study", "output")  # sections that every point of a sweep shares


@dataclass(frozen=True)
class SweptKey:
    """A key that a study varies: its values in SI, their unit (UDUNITS) and meaning."""

    values: tuple[Any, ...]
    units: str
    description: str


@dataclass(frozen=True)
class Study:
    """A study file, checked.

    Attributes
    ----------
    table : dict
        The whole input, overrides included, as TOML would hold it.
    directory : pathlib.Path
        Where relative paths of the study start.
    cases : tuple of Case
        Every point of the sweep, the last swept key running fastest.
    sweep : dict
        Swept keys by their last part, the leading dimensions of every dataset.
    notes : tuple of str
        What in the file has no effect.
    choices : tuple of str
        What the file left to be chosen, and what was.
    """

    table: dict[str, Any]
    directory: Path
    cases: tuple[Case, ...]
    sweep: dict[str, SweptKey]
    notes: tuple[str, ...] = ()
    choices: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """The study's title."""
        return self.cases[0].study.title

    @property
    def toml(self) -> str:
        """The whole input as TOML text."""
        return tomli_w.dumps(self.table)


def read_study(path: Path | str, overrides: Mapping[str, Any] | None = None) -> Study:
    """Read a study file.

    Parameters
    ----------
    path : path-like
        A TOML file.
    overrides : mapping, optional
        Dotted keys ("section.key") and their values, in place of the file's. A swept key takes a value or a list; a
        list for a key that takes one value sweeps it.

    Raises
    ------
    InputError
        If the file cannot be read or any key is unknown, missing or impossible.
    """
    path = Path(path)
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "is no text"
        raise InputError(f"{path}: cannot be read ({reason}); expected a study file (TOML)") from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is no valid TOML: {error}") from None
    _check_structure(table)
    for dotted, value in (overrides or {}).items():
        _leave_kind(table, dotted, value)
    for dotted, value in (overrides or {}).items():
        _override(table, dotted, value)
    return make_study(table, path.parent)


def make_study(table: dict[str, Any], directory: Path | str = ".") -> Study:
    """Check a table as TOML would hold it and expand its sweep; errors as :func:`read_study`."""
    _check_structure(table)
    table = _with_files(table, Path(directory))
    swept, exceptions = table.get("sweep", {}), table.get("override", [])
    points = list(_points(swept))
    merged = _of_own_kind([_apply(table, point, exceptions) for point, _ in points])
    cases = tuple(_case(one, *point, Path(directory)) for one, point in zip(merged, points, strict=True))
    _check_field_steps(cases)
    notes = tuple(
        f"override {number} ({', '.join(f'{k} = {v!r}' for k, v in item['when'].items())}) matches no point"
        for number, item in enumerate(exceptions, 1)
        if not any(_matches(one, item["when"]) for one in merged)
    )
    keys = {_last(dotted): _swept_key(dotted, cases, swept) for dotted in swept}
    return Study(table, Path(directory), cases, keys, notes, automatic.choices(merged, cases))


def _check_field_steps(cases: tuple[Case, ...]) -> None:
    """Every point whose fields are to be kept is on some path."""
    longest = max(len(case.path) for case in cases)
    for number in cases[0].output.field_steps or ():
        if not -longest <= number < longest:
            raise InputError(
                f"output.field_steps: {number} is no point of the path, which has {longest}: 0 to {longest - 1}, or "
                "-1 for the last"
            )


def _with_files(table: dict[str, Any], directory: Path) -> dict[str, Any]:
    """The table with the numbers of files that its sections name, see :func:`with_columns`, :func:`with_spectrum`."""
    found = with_spectrum(table, directory)
    for section, declared in SECTIONS.items():
        if isinstance(declared, Kinds) and section in table:
            kind = declared.declared.get(declared.kind_of(table[section]))
            columns = getattr(kind, "columns", None)
            if columns:
                found[section] = with_columns(table[section], section, columns, directory)
    return found


def all_keys() -> Iterator[tuple[str, str, Key, Any]]:
    """Section, key, declaration and default of everything a study file may hold."""
    for section, declared in SECTIONS.items():
        for name, declaration in keys_of(declared).items():
            yield section, name, declaration, default_of(declared, name)


def _last(dotted: str) -> str:
    return dotted.rpartition(".")[2]


def _split(dotted: str, where: str) -> tuple[str, str]:
    section, _, name = dotted.partition(".")
    if section not in SECTIONS or name not in keys_of(SECTIONS[section]):
        raise InputError(f"{where}: unknown key {dotted!r}; expected section.key, such as interaction.well_depth_ratio")
    return section, name


def _leave_kind(table: dict[str, Any], dotted: str, value: Any) -> None:
    """Drop what a file says of other kinds than the one that the command line chooses."""
    section, _, name = dotted.partition(".")
    kinds = SECTIONS.get(section)
    if not isinstance(kinds, Kinds) or name != kinds.tag or dotted in table.get("sweep", {}):
        return
    chosen = {name: value}
    for content, prefix in ((table.get(section, {}), ""), *((part, f"{section}.") for part in _sweeping(table))):
        for key in [key for key in content if key.startswith(prefix)]:
            if key.removeprefix(prefix) in keys_of(kinds) and not kinds.has(chosen, key.removeprefix(prefix)):
                del content[key]


def _sweeping(table: dict[str, Any]) -> list[dict[str, Any]]:
    """The parts of a table that hold dotted keys."""
    return [table.get("sweep", {}), *table.get("override", [])]


def _override(table: dict[str, Any], dotted: str, value: Any) -> None:
    section, name = _split(dotted, "command line")
    several = listed(value) if isinstance(value, str) and "," in value else value
    if dotted in table.get("sweep", {}):
        table["sweep"][dotted] = several if isinstance(several, list) else [several]
    elif section not in WHOLE_STUDY and _each_but_not_all(dotted, value, several):
        table.setdefault("sweep", {})[dotted] = several
    else:
        table.setdefault(section, {})[name] = value
    for item in table.get("override", []):  # the command line has the last word
        item.pop(dotted, None)


def _each_but_not_all(dotted: str, value: Any, several: Any) -> bool:
    """Whether a value is none of its key, but a list of such values."""
    if not isinstance(several, list) or not several:
        return False
    try:
        _read(dotted, value)
    except InputError:
        pass
    else:
        return False
    try:
        return all(_read(dotted, one) is not None for one in several)
    except InputError:
        return False


def _check_structure(table: dict[str, Any]) -> None:
    """Sections, sweep and overrides are what they should be, and every value alone can be read."""
    for section, content in table.items():
        if section in SECTIONS or section == "sweep":
            if not isinstance(content, dict):
                raise InputError(f"{section} = {content!r}: expected a section, [{section}]")
        elif section != "override":
            raise InputError(f"unknown section [{section}]; known: {', '.join(SECTIONS)}, sweep, override")
    _check_sweep(table.get("sweep", {}))
    _check_exceptions(table.get("override", []), table.get("sweep", {}))
    for dotted in table.get("sweep", {}):  # a value that the sweep replaces is written there to be read, too
        section, name = _split(dotted, "sweep")
        if name in table.get(section, {}):
            _read(dotted, table[section][name])


def _check_sweep(swept: dict[str, Any]) -> None:
    seen: set[str] = set()
    for dotted, values in swept.items():
        section, name = _split(dotted, "sweep")
        if section in WHOLE_STUDY:
            raise InputError(f"sweep.{dotted}: section [{section}] is one for the whole study and cannot be swept")
        if dotted == "loading.path":
            raise InputError(
                "sweep.loading.path: a path cannot be swept; give points of a sweep their own by [[override]]"
            )
        if not isinstance(values, list) or not values:
            raise InputError(f"sweep.{dotted} = {values!r}: expected a list of at least one value")
        if dotted == automatic.LENGTH and automatic.AUTO in values:
            raise InputError(f'sweep.{dotted}: "{automatic.AUTO}" is no number to sweep over; give it in [[override]]')
        if any(isinstance(value, list | dict) for value in values):
            raise InputError(f"sweep.{dotted}: each value must be a number or a text")
        if name in seen:
            raise InputError(f"sweep: two swept keys are called {name}")
        seen.add(name)


def _check_exceptions(exceptions: Any, swept: dict[str, Any]) -> None:
    if not isinstance(exceptions, list) or not all(isinstance(item, dict) for item in exceptions):
        raise InputError('override: expected tables, [[override]] with when = { "section.key" = value }')
    for item in exceptions:
        if not isinstance(item.get("when"), dict) or not item["when"]:
            raise InputError('override: needs when = { "section.key" = value }')
        changes = {dotted: value for dotted, value in item.items() if dotted != "when"}
        for dotted, value in [*item["when"].items(), *changes.items()]:
            _split(dotted, "override")
            _read(dotted, value, "override: ")
        for dotted in changes:
            if dotted in swept:
                raise InputError(f"override: {dotted} is swept; an override may change other keys only")
            if dotted.partition(".")[0] in WHOLE_STUDY:
                raise InputError(f"override: {dotted} is one for the whole study and cannot differ between points")


def _read(dotted: str, value: Any, where: str = "") -> Any:
    """The value of a key as its section will hold it."""
    section, name = _split(dotted, where)
    return keys_of(SECTIONS[section])[name].read(value, where + dotted)


def _matches(merged: dict[str, Any], when: dict[str, Any]) -> bool:
    """Whether a point has these values, however they are written: 8, 8.0; "1 nm", "10 angstrom"."""
    for dotted, wanted in when.items():
        section, name = _split(dotted, "override")
        given = merged[section]
        value = _read(dotted, given[name]) if name in given else default_of(SECTIONS[section], name)
        if not same(value, _read(dotted, wanted)):
            return False
    return True


def same(one: Any, other: Any) -> bool:
    """Whether two values of a key are equal but for the rounding of a unit's conversion."""
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-12)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(same(*pair) for pair in zip(one, other, strict=True))
    return bool(one == other)


def _swept_key(dotted: str, cases: tuple[Case, ...], swept: dict[str, Any]) -> SweptKey:
    section, name = _split(dotted, "sweep")
    declaration = keys_of(SECTIONS[section])[name]
    written = declaration.kind.partition(" or ")[0]
    units = written.replace("J/m^2", "J m-2") if written in EXAMPLES else "1"
    values = tuple(dict.fromkeys(case.coordinates[name] for case in cases))
    if len(values) < len(swept[dotted]) or any(same(*pair) for pair in itertools.combinations(values, 2)):
        raise InputError(f"sweep.{dotted} = {swept[dotted]!r}: holds a value twice")
    return SweptKey(values, units, declaration.description)


def _points(swept: dict[str, list[Any]]) -> Iterator[tuple[dict[str, Any], tuple[int, ...]]]:
    for index in itertools.product(*(range(len(values)) for values in swept.values())):
        yield {dotted: values[i] for (dotted, values), i in zip(swept.items(), index, strict=True)}, index


def _apply(table: dict[str, Any], point: dict[str, Any], exceptions: list[dict[str, Any]]) -> dict[str, Any]:
    merged = {name: dict(table.get(name, {})) for name in SECTIONS}
    for dotted, value in point.items():
        section, name = _split(dotted, "sweep")
        merged[section][name] = value
    for item in exceptions:
        if _matches(merged, item["when"]):
            for dotted, value in item.items():
                if dotted != "when":
                    section, name = _split(dotted, "override")
                    merged[section][name] = value
    return merged


def _of_own_kind(merged: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The points of a sweep, each with the keys of its own kinds only."""
    for section, declared in SECTIONS.items():
        if isinstance(declared, Kinds):
            own = declared.without_others([one[section] for one in merged])
            merged = [{**one, section: table} for one, table in zip(merged, own, strict=True)]
    return merged


def _case(merged: dict[str, Any], point: dict[str, Any], index: tuple[int, ...], directory: Path) -> Case:
    bound: dict[str, Any] = {}
    for name, declared in SECTIONS.items():
        asked = merged[name] if name != "interaction" else automatic.with_length(merged[name], bound, directory)
        bound[name] = bind(declared, asked, name)
    coordinates = {_last(dotted): _scalar(_read(dotted, value), dotted) for dotted, value in point.items()}
    return Case(**bound, coordinates=coordinates, index=index, directory=directory)


def _scalar(value: Any, dotted: str) -> Any:
    """One number for a key that takes one for both axes: a sweep's values are scalars."""
    if not isinstance(value, tuple):
        return value
    if value[0] != value[1]:
        raise InputError(f"sweep.{dotted}: holds {list(value)}; a swept pair must have two equal values")
    return value[0]
