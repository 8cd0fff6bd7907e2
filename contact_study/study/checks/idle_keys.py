"""Keys that a study gives and that nothing reads, beside what else it asks for."""

import dataclasses
from collections.abc import Sequence

from contact_study.physics.solids import Viscoelastic
from contact_study.study.case import Case
from contact_study.study.schema.sections import LoadingSection
from contact_study.study.sweep import points


def idle_keys(cases: Sequence[Case]) -> list[str]:
    """One line for each reason why keys of some cases are without effect."""
    names = ("work_of_adhesion", "well_depth", "length", "contact_distance")
    walls = [case.interaction for case in cases if case.law.has_wall and not case.law.attracts]
    without = [f"interaction.{name}" for name in names if any(getattr(wall, name) is not None for wall in walls)]
    notes = [
        f'{", ".join(without)}: without effect where interaction.law = "{wall.law}", which neither attracts nor reaches'
        for wall in walls[:1]
        if without
    ]
    for name, default, is_used, belongs in (
        ("adaptive", False, lambda case: case.law.attracts, "laws that attract"),
        ("resolution", LoadingSection.resolution, lambda case: case.loading.adaptive, "loading.adaptive = true"),
        (
            "time_steps",
            LoadingSection.time_steps,
            lambda case: isinstance(case.solid, Viscoelastic),
            'elasticity.kind = "viscoelastic"',
        ),
    ):
        idle = [case for case in cases if getattr(case.loading, name) != default and not is_used(case)]
        if idle:
            said = f"loading.{name} = true" if default is False else f"loading.{name}"
            notes.append(f"{said}: without effect{points(idle, len(cases))}; it belongs to {belongs}")
    return notes


def idle_motion(cases: Sequence[Case]) -> list[str]:
    """One line for each way of motion whose keys are given and that no case goes; several may be compared."""
    notes = []
    for section in ("overdamped", "sampling", "dynamics"):
        if any(section in (case.atomistic.method, case.solver.path) for case in cases):
            continue
        belongs = f'atomistic.method{" or solver.path" if section == "overdamped" else ""} = "{section}"'
        given = [getattr(case, section) for case in cases]
        names = [
            f"{section}.{field.name}"
            for field in dataclasses.fields(given[0])
            if any(getattr(one, field.name) != field.default for one in given)
        ]
        if names:
            notes.append(f"{', '.join(names)}: without effect; it belongs to {belongs}")
    return notes
