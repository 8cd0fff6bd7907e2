"""Keys of a study file: how each is read, checked and described, in one declaration beside the dataclass field."""

import contextlib
import difflib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cached_property
from typing import Any

from contact_study.inputs import units
from contact_study.inputs.errors import InputError

Reader = tuple[Callable[[Any, str], Any], str]  # how a value is read, and its kind in words


@dataclass(frozen=True)
class Key:
    """How one key is read and described."""

    read: Callable[[Any, str], Any]
    kind: str
    description: str

    @property
    def unit(self) -> str | None:
        """SI unit of its numbers, None for pure ones and words, and where another key says which unit."""
        first = self.kind.partition(" or ")[0]
        unit = first.rpartition(" ")[2]
        others = first.split(",")[:-1]
        return unit if unit in units.EXAMPLES and not units.EXAMPLES.keys() & others else None


def key(reader: Reader, description: str, default: Any = MISSING) -> Any:
    """A dataclass field bound to a key of the study file; without a default the key must be given."""
    return field(default=default, metadata={"key": Key(*reader, description)})


def quantity(
    unit: str, *, positive: bool = False, minimum: float | None = None, maximum: float | None = None, why: str = ""
) -> Reader:
    """A dimensional number, in SI or as a string with a unit; ``positive`` excludes zero, ``why`` is of the minimum."""

    def read(value: Any, name: str) -> float:
        number = units.quantity(value, unit, name)
        if positive and number <= 0:
            raise InputError(f"{name} = {value!r}: must be positive")
        _check_limits(number, value, name, minimum, maximum, why)
        return number

    return read, unit if unit != "1" else "number"


METRES, PASCALS, SECONDS, FACTOR, PER_METRE = (quantity(unit, positive=True) for unit in ("m", "Pa", "s", "1", "m^-1"))
JOULES, PER_AREA, KILOGRAMS = (quantity(unit, positive=True) for unit in ("J", "J/m^2", "kg"))
SHARE = quantity("1", positive=True, maximum=1.0)
ANGLE = quantity("rad")


def integer(minimum: int | None = None, maximum: int | None = None) -> Reader:
    """A whole number."""

    def read(value: Any, name: str) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise InputError(f"{name} = {value!r}: expected a whole number")
        _check_limits(value, value, name, minimum, maximum)
        return value

    return read, "integer"


def _check_limits(
    number: float, value: Any, name: str, minimum: float | None, maximum: float | None, why: str = ""
) -> None:
    form = "" if isinstance(number, int) else "g"
    if minimum is not None and number < minimum:
        raise InputError(f"{name} = {value!r}: must be at least {minimum:{form}}{why and f'; {why}'}")
    if maximum is not None and number > maximum:
        raise InputError(f"{name} = {value!r}: must be at most {maximum:{form}}")


def choice(*allowed: str) -> Reader:
    """One of a few words."""

    def read(value: Any, name: str) -> str:
        if value not in allowed:
            raise InputError(f"{name} = {value!r}: expected one of {', '.join(allowed)}{suggestion(value, allowed)}")
        return value

    return read, " | ".join(allowed)


def choices(*allowed: str) -> Reader:
    """One of a few words, or a list of different ones."""
    read_any, _ = one_or_several(choice(*allowed))

    def read(value: Any, name: str) -> str | tuple[str, ...]:
        given = read_any(value, name)
        if isinstance(given, tuple) and len(set(given)) < len(given):
            raise InputError(f"{name} = {value!r}: names one twice")
        return given[0] if len(given) == 1 else given

    return read, f"{' | '.join(allowed)}, or a list"


def _as_it_is(fits: Callable[[Any], bool], expected: str, kind: str) -> Reader:
    def read(value: Any, name: str) -> Any:
        if not fits(value):
            raise InputError(f"{name} = {value!r}: expected {expected}")
        return value

    return read, kind


FLAG = _as_it_is(lambda value: isinstance(value, bool), "true or false", "true | false")
TEXT = _as_it_is(lambda value: isinstance(value, str), "text", "text")
NAME_OR_NUMBER = _as_it_is(
    lambda value: isinstance(value, str) or (isinstance(value, int) and not isinstance(value, bool) and value >= 0),
    "a name or a number from 0",
    "text or integer",
)


def or_word(reader: Reader, word: str) -> Reader:
    """A value of another reader, or one word in its place."""
    read_other, kind = reader
    return lambda value, name: value if value == word else read_other(value, name), kind


def pair(reader: Reader, *, broadcast: bool = False, names: str = "[y, x]") -> Reader:
    """Two values, along y and x unless named otherwise; with ``broadcast`` one value stands for both."""
    read_one, kind = reader

    def read(value: Any, name: str) -> tuple[Any, Any]:
        if isinstance(value, str) and "," in value:
            value = listed(value, name)
        if broadcast and not isinstance(value, list):
            value = [value, value]
        if not isinstance(value, list) or len(value) != 2:
            raise InputError(f"{name} = {value!r}: expected two values, {names}")
        return read_one(value[0], f"{name}[0]"), read_one(value[1], f"{name}[1]")

    return read, f"{kind} or {names}" if broadcast else f"{names} in {kind}"


OFFSET = pair(quantity("m"))


def sequence(reader: Reader) -> Reader:
    """A list of at least one value."""
    read_one, kind = reader

    def read(value: Any, name: str) -> tuple[Any, ...]:
        given = listed(value, name) if isinstance(value, str) else value if isinstance(value, list) else [value]
        if not given:
            raise InputError(f"{name} = []: is empty; give at least one value")
        return tuple(read_one(item, f"{name}[{i}]") for i, item in enumerate(given))

    return read, f"list of {kind}"


def one_or_several(reader: Reader) -> Reader:
    """One value, or a list of at least one."""
    read_one, kind = reader
    read_all, _ = sequence(reader)

    def read(value: Any, name: str) -> Any:
        several = isinstance(value, list) or (isinstance(value, str) and "," in value)
        return read_all(value, name) if several else read_one(value, name)

    return read, f"{kind} or a list"


def listed(text: str, name: str = "") -> list[Any]:
    """The values of a list written as text: bare numbers, "512, 512", or each with its unit, "1 nm, 2 um"."""
    if name:
        units.refuse_decimal_comma(text, name)
    parts = [part.strip() for part in text.split(",")]
    numbers = [_number(part) for part in parts]
    with_unit = any(isinstance(number, str) and number[:1] in set("+-.0123456789") for number in numbers)
    return parts if with_unit else numbers


def _number(text: str) -> Any:
    for kind in (int, float):
        with contextlib.suppress(ValueError):
            return kind(text)
    return text


@dataclass(frozen=True)
class TaggedUnion:
    """A section whose keys depend on one of them: a dataclass for each kind. Kinds may share keys of one meaning."""

    tag: str  # key that names the kind; every dataclass has it as a field
    declared: dict[str, Any]  # dataclass of each kind
    followers: list["TaggedUnion"] = field(default_factory=list)  # sections that take the same kinds
    inherited: tuple[str, ...] = ()  # keys whose default is the value in [surface]

    def register(self, kind: str, section: type) -> None:
        """Make a kind of surface or solid from outside the package known to studies.

        Parameters
        ----------
        kind : str
            Its name in a study, ``surface.kind = kind`` or ``elasticity.kind = kind``.
        section : type
            Frozen dataclass of its keys. A surface's methods ``realise`` and ``scales`` give the heights and their
            scales; a solid's method ``solid`` makes the solid of a material.

        Returns
        -------
        None

        Raises
        ------
        ValueError
            If there is another kind of that name, or a key is taken for another unit.

        Examples
        --------
        >>> import contact_study
        >>> contact_study.register_surface("ridge", RidgeSection)  # doctest: +SKIP
        >>> contact_study.register_solid("stiff", StiffSection)  # doctest: +SKIP
        """
        if self.declared.get(kind, section) is not section:
            raise ValueError(f"{self.tag} = {kind!r} is {self.declared[kind].__name__}; give another name")
        for name, declaration in keys_of(section).items():
            known = self.keys.get(name)
            if known and known.unit != declaration.unit:
                raise ValueError(f"{kind}: key {name} is in {declaration.unit}, that of other kinds in {known.unit}")
        self.declared[kind] = section
        self.__dict__.pop("keys", None)
        for other in self.followers:
            other.register(kind, section)

    @cached_property
    def keys(self) -> dict[str, Key]:
        """The keys of all kinds; those that not every kind has say whose they are."""
        owners: dict[str, dict[str, Key]] = {}
        with_keys = sum(len(keys_of(section)) > 1 for section in self.declared.values())
        for kind, section in self.declared.items():
            for name, declaration in keys_of(section).items():
                owners.setdefault(name, {})[kind] = declaration
        found = {}
        for name, kinds in owners.items():
            first = next(iter(kinds.values()))
            whose = f" ({', '.join(kinds)})" if len(kinds) < with_keys else ""
            found[name] = replace(first, description=first.description + whose)
        return {**found, self.tag: Key(*choice(*self.declared), found[self.tag].description)}

    def section_of(self, table: Mapping[str, Any]) -> type | None:
        """The dataclass of the kind that a table names; None if it names none that is known."""
        kind = table.get(self.tag, default_of(self, self.tag))
        return self.declared.get(kind) if isinstance(kind, str) else None

    def has(self, table: Mapping[str, Any], name: str) -> bool:
        section = self.section_of(table)
        return section is None or name in keys_of(section)


def keys_of(section: type | TaggedUnion) -> dict[str, Key]:
    """The keys of a section, in the order of declaration."""
    if isinstance(section, TaggedUnion):
        return section.keys
    return {one.name: one.metadata["key"] for one in fields(section) if "key" in one.metadata}


def default_of(section: type | TaggedUnion, name: str) -> Any:
    """The default of a key, of the first kind that has it; ``MISSING`` if it must be given."""
    if isinstance(section, TaggedUnion):
        section = next(one for one in section.declared.values() if name in keys_of(one))
    return section.__dataclass_fields__[name].default  # type: ignore[union-attr]


def bind(declared: type | TaggedUnion, table: Mapping[str, Any], name: str) -> Any:
    """Build a section from a TOML table; InputError if a key is unknown, missing, of the wrong kind or out of range."""
    section: Any = declared
    known, tag, kind = keys_of(declared), "", None
    if isinstance(declared, TaggedUnion):
        tag, kind = declared.tag, table.get(declared.tag, default_of(declared, declared.tag))
        if kind is MISSING:
            raise InputError(f"missing key {name}.{tag} ({known[tag].kind}: {known[tag].description})")
        section = declared.declared[known[tag].read(kind, f"{name}.{tag}")]
    own = keys_of(section)
    for given in table:
        if given in own:
            continue
        if isinstance(declared, TaggedUnion) and given in known:
            raise InputError(
                f'{name}.{given}: {tag} = "{kind}" has no such key; it belongs to '
                + ", ".join(other for other, one in declared.declared.items() if given in keys_of(one))
            )
        meant = replacement(f"{name}.{given}") or suggestion(given, own)
        raise InputError(f"unknown key {name}.{given}{meant}; known: {', '.join(own)}")
    for needed, key in own.items():
        if needed in table or default_of(section, needed) is not MISSING:
            continue
        if kind is not None:
            raise InputError(f'missing key {name}.{needed}: {tag} = "{kind}" needs it ({key.kind}: {key.description})')
        raise InputError(f"missing key {name}.{needed} ({key.kind}: {key.description})")
    return section(**{given: own[given].read(value, f"{name}.{given}") for given, value in table.items()})


def check_table(bound: Any, section: str, kind: str) -> None:
    """Raise InputError unless a section's table was read from its file, and has both columns."""
    if bound.path is not None:
        raise InputError(f"{section}.path: one table a study; it cannot be swept or overridden")
    first, second = bound.columns
    if getattr(bound, first) is None or getattr(bound, second) is None:
        raise InputError(f"missing key {section}.path: {kind} needs a table, or {section}.{first} and {second}")


# Names of keys that may be looked for in a section, and where they are.
_ELSEWHERE = dict.fromkeys(
    ("atomistic.seed", "sampling.seed", "sampling.random_seed", "dynamics.seed", "dynamics.random_seed"),
    "atomistic.random_seed",
)


def replacement(dotted: str, mark: str = "") -> str:
    """The key meant by another, after a ``mark`` such as "--", for the end of a message; empty if there is none."""
    return f" (use {mark}{_ELSEWHERE[dotted]})" if dotted in _ELSEWHERE else ""


def suggestion(given: Any, known: Iterable[str]) -> str:
    """A known name close to the one given, for the end of a message; empty if there is none."""
    close = difflib.get_close_matches(str(given), list(known), n=1)
    return f" (did you mean {close[0]}?)" if close else ""


def as_written(default: Any) -> str:
    """A default as the command line takes it."""
    if isinstance(default, tuple):
        return ", ".join(map(as_written, default))
    return str(default).lower() if isinstance(default, bool) else str(default)


def few(items: Sequence[Any], most: int = 24) -> list[Any]:
    """The items of a list to show, the middle of a long one replaced by a word on their number."""
    if len(items) <= most:
        return list(items)
    return [*items[:5], f"… {len(items) - 6} more …", items[-1]]


def shown(value: Any) -> str:
    """A value of a key for a message."""
    if isinstance(value, tuple | list):
        return "[" + ", ".join(shown(item) for item in few(value)) + "]"
    return "not given" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
