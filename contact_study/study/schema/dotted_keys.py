"""The sections that a study file may have, and their keys by dotted names, such as ``interaction.length``."""

import math
from collections.abc import Iterator
from typing import Any

from contact_study.inputs.errors import InputError
from contact_study.study.schema import sections
from contact_study.study.schema.elasticity import ELASTICITIES
from contact_study.study.schema.interaction import INTERACTIONS
from contact_study.study.schema.keys import Key, TaggedUnion, default_of, keys_of, replacement
from contact_study.study.schema.surface import SURFACES

SECTIONS: dict[str, type | TaggedUnion] = {
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


def all_keys() -> Iterator[tuple[str, str, Key, Any]]:
    """Section, key, declaration and default of everything a study file may hold."""
    for section, declared in SECTIONS.items():
        for name, declaration in keys_of(declared).items():
            yield section, name, declaration, default_of(declared, name)


def split(dotted: str, where: str) -> tuple[str, str]:
    """Section and name of a dotted key.

    Raises InputError if there is no such key; ``where`` says what holds it.
    """
    section, _, name = dotted.partition(".")
    if section not in SECTIONS or name not in keys_of(SECTIONS[section]):
        meant = replacement(dotted) or "; expected section.key, such as interaction.well_depth_ratio"
        raise InputError(f"{where}: unknown key {dotted!r}{meant}")
    return section, name


def last(dotted: str) -> str:
    """The name of a dotted key."""
    return dotted.rpartition(".")[2]


def read(dotted: str, value: Any, where: str = "") -> Any:
    """The value of a key as its section will hold it."""
    section, name = split(dotted, where)
    return keys_of(SECTIONS[section])[name].read(value, where + dotted)


def is_sweep(dotted: str, value: Any, several: Any) -> bool:
    """Test whether a value is a list of values for a key that takes one."""
    if not isinstance(several, list) or not several:
        return False
    if _reads(dotted, value) or _reads(dotted, several[:1]):  # a list for a key of lists has its own message
        return False
    return all(_reads(dotted, one) for one in several)


def _reads(dotted: str, value: Any) -> bool:
    try:
        return read(dotted, value) is not None
    except InputError:
        return False


def same(one: Any, other: Any) -> bool:
    """Compare two values of a key up to the rounding of a unit's conversion."""
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-12)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(same(*pair) for pair in zip(one, other, strict=True))
    return bool(one == other)
