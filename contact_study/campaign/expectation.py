"""Expectations of a study before it runs: models that can run it, their needs, and numbers of its adhesion."""

import math
from collections.abc import Iterator, Sequence

from contact_study.campaign import model as models
from contact_study.campaign.memory import duration, in_words, require_at_once, seconds_of
from contact_study.inputs.units import length
from contact_study.physics.process_zone import (
    DMT_LIKE,
    JKR_LIKE,
    POINTS_FOR_ONE_STATE,
    POINTS_PER_PROCESS_ZONE,
    process_zone,
)
from contact_study.physics.spheres.numbers import tabor_parameter
from contact_study.study.case import Case
from contact_study.study.study import Study

ZONE, _THETA = "grid points per process zone", "theta = Δγ / U_full (Persson, Tosatti)"
_TABOR, _AREA = "Tabor parameter of the asperities", "area without adhesion, largest load (%)"


def judged(kind: str, study: Study) -> tuple[str, str, str, str, list[str]]:
    """Whether a model can run a study: "yes", memory of a case, time on one core, a remark and warnings, in words.

    Raises InputError if it cannot.
    """
    model = models.MODELS[kind]
    notes = models.check_study(model, study)
    needs = [model.needs(case) for case in study.cases]
    require_at_once(needs, None)
    found, remark = seconds_of(model.kind, [(case, len(case.path)) for case in study.cases]), ""
    if found is None:
        time, remark = "not known", "thermal motion: try one load step first"
    else:
        low, high = map(duration, found)
        time = low if low == high else f"{low} to {high}"
        if model.own_steps and any(case.loading.adaptive for case in study.cases):
            remark = "adaptive steps take longer"
    return "yes", in_words(max(need.size for need in needs)), time, remark, notes


def extent(study: Study) -> Iterator[str]:
    """Describe the cases, load steps and points."""
    steps = [len(case.path) for case in study.cases]
    swept = []
    for name, key in study.sweep.items():
        values = [f"{value:.4g}" if isinstance(value, float) else str(value) for value in key.values]
        shown = values if len(values) <= 6 else [values[0], f"{values[1]} ... {values[-1]}"]
        swept.append(f"{name}: {', '.join(shown)}")
    each = f"{steps[0]} load steps" if min(steps) == max(steps) else f"{min(steps)} to {max(steps)} load steps"
    cases = f"1 case of {each}" if len(steps) == 1 else f"{len(steps)} cases of {each}, {sum(steps)} in all"
    yield f"{cases} ({'; '.join(swept)})" if swept else cases
    grids = {(case.scales.shape, case.scales.size) for case in study.cases if not case.surface.absent}
    for shape, size in sorted(grids)[:3]:
        spacing = max(side / points for side, points in zip(size, shape, strict=True))
        yield f"{shape[0]} x {shape[1]} points on {length(*size)} (y, x), spacing {length(spacing)}"
    if len(grids) > 3:
        yield f"and {len(grids) - 3} other grids"


def numbers(cases: Sequence[Case]) -> Iterator[tuple[str, str, str]]:
    """Yield number, value and meaning, a row for each meaning that a number has in some case."""
    return rows([_numbers(case) for case in cases])


def rows(cases: Sequence[dict[str, float]]) -> Iterator[tuple[str, str, str]]:
    """Yield the rows of :func:`numbers` of such numbers by their words."""
    for title, meant in meanings().items():
        groups: dict[str, list[float]] = {}
        lowest = [*meant.values()][-1]
        for value in sorted(case[title] for case in cases if title in case):
            words = next((words for least, words in meant.items() if value >= least), lowest)
            groups.setdefault(words, []).append(value)
        for words, values in groups.items():
            low, high = f"{values[0]:.3g}", f"{values[-1]:.3g}"
            part = "" if len(values) == len(cases) else f" ({len(values)} of {len(cases)} cases)"
            yield title, low if low == high else f"{low} to {high}", words + part
            title = ""


def meanings() -> dict[str, dict[float, str]]:
    """Return the numbers to expect, and what each means from a least value on."""
    more = f"use {POINTS_PER_PROCESS_ZONE} or more"
    return {
        ZONE: {
            POINTS_PER_PROCESS_ZONE: "the grid resolves contact edges",
            POINTS_FOR_ONE_STATE: f"edges are trapped on unloading, pull-off comes out too strong; {more}",
            0: f"too coarse: the area may be wrong by a factor of two, pull-off is the grid's; {more}",
        },
        _THETA: {
            1: "full contact gains energy: surfaces that touch will stick completely",
            0: "full contact costs energy: contact stays partial without a load",
        },
        _TABOR: {
            JKR_LIKE: "JKR-like: contacts jump, loading and unloading will differ",
            DMT_LIKE: "between the limits: the range matters, loading and unloading may differ",
            0: "DMT-like: adhesion hardly deforms the solid, loading and unloading agree",
        },
        _AREA: {
            20: "beyond light contact",
            0: "light contact, in proportion to the load",
        },
    }


def _numbers(case: Case) -> dict[str, float]:
    """Return what a case has of these numbers; θ as B. N. J. Persson, E. Tosatti, J. Chem. Phys. 115, 5597 (2001)."""
    law, solid, scales, found = case.law, case.solid, case.scales, dict[str, float]()
    rough, stress = scales.apex_curvature is None, scales.full_contact_stress(solid)
    if law.attracts and not case.surface.absent:
        found[ZONE] = process_zone(solid.softest_modulus(*scales.grid_waves), law) / scales.pixel
    if law.attracts and rough and scales.spectrum is not None:
        found[_THETA] = law.work_of_adhesion / float(scales.spectrum.full_contact_energy(solid.stiffness))
    if law.attracts and scales.rms_curvature > 0:
        reach = law.length if law.has_wall else law.equilibrium_distance
        about = solid.contact_modulus, law.work_of_adhesion, reach
        found[_TABOR] = float(tabor_parameter(1 / scales.rms_curvature, *about))
    if case.loading.control == "pressure" and stress > 0 and rough:  # by Persson's theory
        found[_AREA] = 100 * math.erf(max(0.0, *case.loading.path) / (math.sqrt(2) * stress))
    return found
