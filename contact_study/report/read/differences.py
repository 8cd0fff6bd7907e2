"""How the studies of the datasets differ: what makes them different contacts is refused, all else is said."""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from contact_study.errors import InputError
from contact_study.report.models import TARGET, is_simulated
from contact_study.study.case import Case
from contact_study.study.schema.dotted_keys import SECTIONS
from contact_study.study.schema.keys import keys_of
from contact_study.study.study import Study

# Keys that two datasets must share to be of one contact; a difference in any other is said, not refused.
ONE_CONTACT = {
    f"{section}.{name}"
    for section, names in {
        "surface": " ".join(name for name in keys_of(SECTIONS["surface"]) if name != "shape"),
        "material": "youngs_modulus poissons_ratio lattice_constant",
        "elasticity": " ".join(keys_of(SECTIONS["elasticity"])),
        "interaction": "law well_depth work_of_adhesion well_depth_ratio length",
        "loading": "control",
    }.items()
    for name in names.split()
}
SAME = 1e-9  # relative: the same number written in two units differs by roundings of 1e-16


def check_studies(
    names: Sequence[str], paths: Mapping[str, Path], studies: Mapping[str, Study], ignored: Collection[str] = ()
) -> Iterator[str]:
    """Notes on the differences between the study of the first name and each other one.

    Parameters
    ----------
    names : sequence of str
        Models, in the order of trust.
    paths, studies : mapping
        File and study of each model.
    ignored : collection of str, optional
        Keys in which they may differ without a word.

    Raises
    ------
    InputError
        If two studies are of different contacts, or their sweeps have nothing in common.
    """
    first = names[0]
    for other in names[1:]:
        where = f"{paths[first]} and {paths[other]}"
        pairs = _matching_cases(studies[first], studies[other])
        if not pairs:
            raise InputError(f"{where} cannot be compared: their sweeps have no point in common")
        target_only = not is_simulated(other) and all(case.spectra == (TARGET,) for case in studies[other].cases)
        different: dict[str, tuple[Any, Any]] = {}
        for one, two in pairs:
            different |= {key: values for key, values in differences(one, two) if key not in different}
        for key, (one_value, two_value) in different.items():
            if key in ignored or (key == "surface.seed" and target_only):
                continue  # a theory of the ensemble knows no realisation
            values = f"{key} is {_shown(one_value)} in the one and {_shown(two_value)} in the other"
            if key in ONE_CONTACT:
                raise InputError(f"{where} cannot be compared: {values}")
            yield f"{where}: {values}"
        points = {len(study.cases) for study in (studies[first], studies[other])} | {len(pairs)}
        if len(points) > 1 and set(studies[first].sweep) == set(studies[other].sweep):
            yield f"{where} share {len(pairs)} points of their sweeps; only these are compared"


def check_height_maps(names: Sequence[str], paths: Mapping[str, Path], recorded: Mapping[str, str]) -> None:
    """Refuse datasets of height maps that had another content when they were read.

    Parameters
    ----------
    names : sequence of str
        Models, in the order of trust.
    paths, recorded : mapping
        File of each model and its attribute ``height_maps``: lines of a content's hash and the path in the study.

    Raises
    ------
    InputError
        If one path stands for two contents.
    """
    known: dict[str, tuple[str, str]] = {}
    for name in names:
        for line in recorded[name].splitlines():
            content, _, path = line.partition(" ")
            first, other = known.setdefault(path, (name, content))
            if other != content:
                raise InputError(
                    f"{paths[first]} and {paths[name]} cannot be compared: the height map {path} had another content; "
                    "run both again on the same file"
                )


def differences(one: Case, two: Case) -> Iterator[tuple[str, tuple[Any, Any]]]:
    """Every key of the study file whose values differ between two cases, with both values."""
    for section, declared in SECTIONS.items():
        left, right = getattr(one, section), getattr(two, section)
        for name in keys_of(declared):
            values = getattr(left, name, None), getattr(right, name, None)
            if not same(*values):
                yield f"{section}.{name}", values


def same(one: Any, other: Any) -> bool:
    """Whether two values of a key are the same, however they were written."""
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=SAME)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(same(*pair) for pair in zip(one, other, strict=True))
    return bool(one == other)


def _matching_cases(one: Study, two: Study) -> list[tuple[Case, Case]]:
    shared = set(one.sweep) & set(two.sweep)
    return [
        (a, b)
        for a in one.cases
        for b in two.cases
        if all(same(a.coordinates[name], b.coordinates[name]) for name in shared)
    ]


def _shown(value: Any) -> str:
    if value is None:
        return "not given"
    if isinstance(value, tuple):
        return "[" + ", ".join(_shown(item) for item in value) + "]"
    return f"{value:g}" if isinstance(value, float) else str(value)
