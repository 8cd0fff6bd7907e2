"""Keys that a study gives and that nothing reads, beside what else it asks for."""

from collections.abc import Sequence

from contact_study.problem.case import Case
from contact_study.problem.elasticity import Viscoelastic
from contact_study.problem.sections import LoadingSection
from contact_study.problem.sweep import points


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
