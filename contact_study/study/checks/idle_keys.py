"""Keys that a study gives and that nothing reads, beside what else it asks for."""

import dataclasses
from collections.abc import Sequence

from contact_study.physics.solids import Viscoelastic
from contact_study.study.case import Case
from contact_study.study.schema.sections import LoadingSection
from contact_study.study.sweep import points


def idle_keys(cases: Sequence[Case]) -> list[str]:
    """One line for each reason why keys of some cases are without effect."""
    return _of_walls(cases) + _of_loading(cases)


def _of_walls(cases: Sequence[Case]) -> list[str]:
    names = ("work_of_adhesion", "well_depth", "length", "contact_distance")
    walls = [case.interaction for case in cases if case.law.has_wall and not case.law.attracts]
    idle = [f"interaction.{name}" for name in names if any(getattr(wall, name) is not None for wall in walls)]
    if not idle:
        return []
    return [
        f'{", ".join(idle)}: without effect where interaction.law = "{walls[0].law}", which neither attracts nor '
        "reaches"
    ]


def _of_loading(cases: Sequence[Case]) -> list[str]:
    notes = []
    for name, is_idle, belongs in (
        (
            "adaptive = true",
            lambda case: case.loading.adaptive and not case.law.attracts,
            "it belongs to laws that attract",
        ),
        (
            "resolution",
            lambda case: case.loading.resolution != LoadingSection.resolution and not case.loading.adaptive,
            "it belongs to loading.adaptive = true",
        ),
        (
            "time_steps",
            lambda case: (
                case.loading.time_steps != LoadingSection.time_steps and not isinstance(case.solid, Viscoelastic)
            ),
            'it belongs to elasticity.kind = "viscoelastic"',
        ),
    ):
        idle = [case for case in cases if is_idle(case)]
        if idle:
            notes.append(f"loading.{name}: without effect{points(idle, len(cases))}; {belongs}")
    return notes


def idle_motion(cases: Sequence[Case]) -> list[str]:
    """One line for each way of motion whose keys are given and that no case goes; several may be compared."""
    notes = []
    for section, is_idle, belongs in (
        (
            "overdamped",
            lambda case: case.atomistic.method != "overdamped" and case.solver.path != "overdamped",
            'atomistic.method or solver.path = "overdamped"',
        ),
        ("sampling", lambda case: case.atomistic.method != "sampling", 'atomistic.method = "sampling"'),
        ("dynamics", lambda case: case.atomistic.method != "dynamics", 'atomistic.method = "dynamics"'),
    ):
        if not all(map(is_idle, cases)):
            continue
        given = [getattr(case, section) for case in cases]
        names = [
            f"{section}.{field.name}"
            for field in dataclasses.fields(given[0])
            if any(getattr(one, field.name) != field.default for one in given)
        ]
        if names:
            notes.append(f"{', '.join(names)}: without effect; it belongs to {belongs}")
    return notes
