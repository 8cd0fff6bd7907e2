"""Values that a study leaves to be chosen: the range of adhesion, by surface, modulus and work of adhesion."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from contact_study.inputs.errors import InputError
from contact_study.inputs.units import length
from contact_study.physics.laws import LAWS
from contact_study.physics.surfaces.scales import SurfaceScales
from contact_study.physics.tabor import JKR_LIKE, SHARE_OF_HEIGHT, longest_range, tabor_parameter
from contact_study.study.case import Case
from contact_study.study.schema.interaction import AUTO, INTERACTIONS, LENGTH
from contact_study.study.schema.keys import default_of, keys_of


def with_length(
    interaction: Mapping[str, Any], bound: Mapping[str, Any], scales: Callable[[], SurfaceScales]
) -> dict[str, Any]:
    """Replace ``length = "auto"`` of an interaction by the longest that leaves contacts JKR-like.

    ``bound`` holds the sections of material and elasticity, ``scales`` gives the scales of the surface. Raises
    InputError if nothing attracts, adhesion is not given as its work, the surface is flat or cannot be read.
    """
    given = dict(interaction)
    if given.get("length") != AUTO:
        return given
    law = LAWS.get(str(INTERACTIONS.kind_of(given)))
    if law is not None and not law.attracts:
        raise InputError(f'{LENGTH} = "{AUTO}": law = "{INTERACTIONS.kind_of(given)}" does not attract; leave it out')
    if "work_of_adhesion" not in given:
        raise InputError(
            f'{LENGTH} = "{AUTO}": needs interaction.work_of_adhesion, which pairs of atoms would make of it'
        )
    work, ratio = (
        keys_of(INTERACTIONS)[name].read(given.get(name, default_of(INTERACTIONS, name)), f"interaction.{name}")
        for name in ("work_of_adhesion", "well_depth_ratio")
    )
    surface = scales()
    solid = bound["elasticity"].solid(bound["material"])
    try:
        given["length"] = longest_range(surface.rms_curvature, surface.rms_height, solid.contact_modulus, work * ratio)
    except ValueError as error:
        raise InputError(f'{LENGTH} = "{AUTO}": {error}; give the length of the interaction') from None
    return given


def describe_choices(tables: Sequence[Mapping[str, Any]], cases: Sequence[Case]) -> tuple[str, ...]:
    """Describe the values that were chosen, each once, from the tables and cases of all points of a sweep."""
    lines = []
    for table, case in zip(tables, cases, strict=True):
        if table["interaction"].get("length") == AUTO:
            scales = case.scales
            tabor = tabor_parameter(
                1 / scales.rms_curvature, case.solid.contact_modulus, case.work_of_adhesion, case.law.length
            )
            why = (
                f"the longest of a Tabor parameter above {JKR_LIKE:g}"
                if tabor / JKR_LIKE * case.law.length < SHARE_OF_HEIGHT * scales.rms_height
                else "a tenth of the rms height"
            )
            lines.append(
                f'range of adhesion ({LENGTH} = "{AUTO}"): {length(case.law.length)}, {why}; Tabor parameter '
                f"{tabor:.2g}: JKR-like"
            )
    return tuple(dict.fromkeys(lines))
