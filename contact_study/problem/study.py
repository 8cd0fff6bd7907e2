"""A study file: read, checked and expanded into cases.

A :class:`Study` is the file; a :class:`Case` is one point of its sweep, frozen, in plain SI numbers, and all that a
model is given besides the surface.
"""

import itertools
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import tomli_w

from contact_study.fields.observables import Bins
from contact_study.problem import sections
from contact_study.problem.errors import InputError
from contact_study.problem.keys import Key, bind, keys_of
from contact_study.problem.laws import make_law
from contact_study.problem.laws.base import TractionLaw
from contact_study.problem.laws.hard_wall import HardWall
from contact_study.problem.laws.lennard_jones_10_4 import work_of_adhesion
from contact_study.problem.units import EXAMPLES

GOLDEN_MEAN = (1 + 5**0.5) / 2

SECTIONS: dict[str, type] = {
    "study": sections.StudySection,
    "surface": sections.SurfaceSection,
    "material": sections.MaterialSection,
    "interaction": sections.InteractionSection,
    "loading": sections.LoadingSection,
    "solver": sections.SolverSection,
    "atomistic": sections.AtomisticSection,
    "theory": sections.TheorySection,
    "output": sections.OutputSection,
}


@dataclass(frozen=True)
class Case:
    """One point of a study's sweep.

    Attributes
    ----------
    coordinates : dict
        The swept keys, by their last part, and this case's values.
    index : tuple of int
        Position along each swept key.
    """

    study: sections.StudySection
    surface: sections.SurfaceSection
    material: sections.MaterialSection
    interaction: sections.InteractionSection
    loading: sections.LoadingSection
    solver: sections.SolverSection
    atomistic: sections.AtomisticSection
    theory: sections.TheorySection
    output: sections.OutputSection
    coordinates: dict[str, Any] = field(default_factory=dict)
    index: tuple[int, ...] = ()
    directory: Path = Path(".")
    study_bins: Bins | None = None

    def __post_init__(self):
        if self.interaction.law == "hard_wall" and self.loading.control == "pressure" and min(self.loading.path) <= 0:
            raise InputError(
                f"loading.path: {min(self.loading.path):g} Pa cannot be carried by a hard wall without adhesion; "
                "give positive pressures"
            )
        if self.interaction.law != "hard_wall" and self.loading.control == "pressure":
            lowest = -self.law.peak_tensile_stress
            if min(self.loading.path) < lowest:
                raise InputError(
                    f"loading.path: {min(self.loading.path):g} Pa is a tension beyond the law's peak, {lowest:g} Pa; "
                    "no state can carry it"
                )

    @property
    def bins(self) -> Bins:
        """Bins of the distributions; known once :func:`~contact_study.problem.bins.with_bins` has chosen them."""
        if self.study_bins is None:
            raise RuntimeError("the study has no bins yet: call with_bins(study)")
        return self.study_bins

    @property
    def label(self) -> str:
        """Coordinates in words, for progress and messages."""
        return ", ".join(f"{name} = {value}" for name, value in self.coordinates.items())

    @cached_property
    def law(self) -> TractionLaw | HardWall:
        """The traction-separation law."""
        return make_law(self.interaction.law, self.work_of_adhesion, self.interaction.length or 0.0)

    @property
    def contact_distance(self) -> float:
        """Gaps below it count as contact (m)."""
        if self.interaction.contact_distance is not None:
            return self.interaction.contact_distance
        return 2 ** (1 / 6) * (self.interaction.length or 0.0)

    @property
    def path(self) -> list[tuple[float, str]]:
        """Prescribed values in order, each with its branch: "loading" or "unloading"."""
        points = [(value, "loading") for value in self.loading.path]
        if self.loading.unload:
            points += [(value, "unloading") for value in self.loading.path[-2::-1]]
        return points

    @property
    def atoms(self) -> tuple[int, int]:
        """Atoms of the block's bottom layer along y and x.

        Raises
        ------
        InputError
            If a lattice constant is missing or does not divide the lateral size.
        """
        constant = self.material.lattice_constant
        if constant is None:
            raise InputError("missing key material.lattice_constant: atoms and interaction.well_depth need it")
        if self.surface.size is None:
            raise InputError("missing key surface.size: atoms need it")
        counts = []
        for size in self.surface.size:
            number = size / constant
            # An integer up to the rounding of two decimal inputs.
            if abs(number - round(number)) > 1e-6 * number or round(number) < 4:
                raise InputError(
                    f"material.lattice_constant = {constant:g} m: {size:g} m holds {number:.6g} atoms, "
                    "not a whole number of at least 4"
                )
            counts.append(round(number))
        return counts[0], counts[1]

    @property
    def substrate_sites(self) -> tuple[int, int]:
        """Sites of the substrate layer along y and x: the golden mean times the atoms, to the nearest integer."""
        rows, columns = self.atoms
        return round(GOLDEN_MEAN * rows), round(GOLDEN_MEAN * columns)

    @property
    def _densities(self) -> tuple[float, float]:
        (rows, columns), (site_rows, site_columns) = self.atoms, self.substrate_sites
        assert self.surface.size is not None  # atoms checked it
        area = self.surface.size[0] * self.surface.size[1]
        return rows * columns / area, site_rows * site_columns / area

    @property
    def work_of_adhesion(self) -> float:
        """Δγ (J/m²), including ``well_depth_ratio``; zero for a hard wall without adhesion."""
        given = self.interaction
        if given.work_of_adhesion is not None:
            return given.work_of_adhesion * given.well_depth_ratio
        if given.well_depth is None or given.length is None:
            return 0.0
        return work_of_adhesion(given.well_depth * given.well_depth_ratio, given.length, *self._densities)

    @property
    def well_depth(self) -> float:
        """ε of the pair potential (J), including ``well_depth_ratio``."""
        given = self.interaction
        if given.well_depth is not None:
            return given.well_depth * given.well_depth_ratio
        if given.length is None:
            raise InputError("missing key interaction.length: atoms need a pair potential")
        return self.work_of_adhesion / work_of_adhesion(1.0, given.length, *self._densities)


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
    """

    table: dict[str, Any]
    directory: Path
    cases: tuple[Case, ...]
    sweep: dict[str, SweptKey]

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
        Dotted keys ("section.key") and their values, in place of the file's. A swept key takes a value or a list.

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
    for dotted, value in (overrides or {}).items():
        _override(table, dotted, value)
    return make_study(table, path.parent)


def make_study(table: dict[str, Any], directory: Path | str = ".") -> Study:
    """Check a table as TOML would hold it and expand its sweep; errors as :func:`read_study`."""
    exceptions = table.get("override", [])
    swept = table.get("sweep", {})
    for name, content in table.items():
        if name in SECTIONS or name == "sweep":
            if not isinstance(content, dict):
                raise InputError(f"{name} = {content!r}: expected a section, [{name}]")
        elif name != "override":
            raise InputError(f"unknown section [{name}]; known: {', '.join(SECTIONS)}, sweep, override")
    _check_sweep(swept)
    _check_exceptions(exceptions)
    cases = tuple(
        _case(_apply(table, point, exceptions), point, index, Path(directory)) for point, index in _points(swept)
    )
    return Study(table, Path(directory), cases, {_last(dotted): _swept_key(dotted, cases) for dotted in swept})


def all_keys() -> Iterator[tuple[str, str, Key, Any]]:
    """Section, key, declaration and default of everything a study file may hold."""
    for section, declared in SECTIONS.items():
        for name, declaration in keys_of(declared).items():
            yield section, name, declaration, declared.__dataclass_fields__[name].default  # type: ignore[attr-defined]


def _last(dotted: str) -> str:
    return dotted.rpartition(".")[2]


def _split(dotted: str, where: str) -> tuple[str, str]:
    section, _, name = dotted.partition(".")
    if section not in SECTIONS or name not in keys_of(SECTIONS[section]):
        raise InputError(f"{where}: unknown key {dotted!r}; expected section.key, such as interaction.well_depth_ratio")
    return section, name


def _override(table: dict[str, Any], dotted: str, value: Any) -> None:
    section, name = _split(dotted, "command line")
    if dotted in table.get("sweep", {}):
        table["sweep"][dotted] = value if isinstance(value, list) else [value]
    else:
        table.setdefault(section, {})[name] = value


def _check_sweep(swept: dict[str, Any]) -> None:
    seen: set[str] = set()
    for dotted, values in swept.items():
        _split(dotted, "sweep")
        if not isinstance(values, list) or not values:
            raise InputError(f"sweep.{dotted} = {values!r}: expected a list of at least one value")
        if any(isinstance(value, list | dict) for value in values):
            raise InputError(f"sweep.{dotted}: each value must be a number or a text")
        if len({str(value) for value in values}) < len(values):
            raise InputError(f"sweep.{dotted} = {values!r}: holds a value twice")
        if _last(dotted) in seen:
            raise InputError(f"sweep: two swept keys are called {_last(dotted)}")
        seen.add(_last(dotted))


def _check_exceptions(exceptions: Any) -> None:
    if not isinstance(exceptions, list) or not all(isinstance(item, dict) for item in exceptions):
        raise InputError('override: expected tables, [[override]] with when = { "section.key" = value }')
    for item in exceptions:
        if not isinstance(item.get("when"), dict) or not item["when"]:
            raise InputError('override: needs when = { "section.key" = value }')
        for dotted in [*item["when"], *(key for key in item if key != "when")]:
            _split(dotted, "override")


def _swept_key(dotted: str, cases: tuple[Case, ...]) -> SweptKey:
    section, name = _split(dotted, "sweep")
    declaration = keys_of(SECTIONS[section])[name]
    written = declaration.kind.partition(" or ")[0]
    units = written.replace("J/m^2", "J m-2") if written in EXAMPLES else "1"
    return SweptKey(tuple(dict.fromkeys(case.coordinates[name] for case in cases)), units, declaration.description)


def _points(swept: dict[str, list[Any]]) -> Iterator[tuple[dict[str, Any], tuple[int, ...]]]:
    for index in itertools.product(*(range(len(values)) for values in swept.values())):
        yield {dotted: values[i] for (dotted, values), i in zip(swept.items(), index, strict=True)}, index


def _apply(table: dict[str, Any], point: dict[str, Any], exceptions: list[dict[str, Any]]) -> dict[str, Any]:
    merged = {name: dict(table.get(name, {})) for name in SECTIONS}
    for dotted, value in point.items():
        section, name = _split(dotted, "sweep")
        merged[section][name] = value
    for item in exceptions:
        if all(merged[_split(k, "override")[0]].get(_last(k)) == value for k, value in item["when"].items()):
            for dotted, value in item.items():
                if dotted != "when":
                    section, name = _split(dotted, "override")
                    merged[section][name] = value
    return merged


def _case(merged: dict[str, Any], point: dict[str, Any], index: tuple[int, ...], directory: Path) -> Case:
    bound: dict[str, Any] = {name: bind(declared, merged[name], name) for name, declared in SECTIONS.items()}
    coordinates = {_last(dotted): _scalar(getattr(bound[dotted.partition(".")[0]], _last(dotted))) for dotted in point}
    return Case(**bound, coordinates=coordinates, index=index, directory=directory)


def _scalar(value: Any) -> Any:
    """One number for a key that takes one for both axes: a sweep's values are scalars."""
    return value[0] if isinstance(value, tuple) else value
