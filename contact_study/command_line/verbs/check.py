"""Check a study: what it holds, what it needs, what to expect. No solver runs."""

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from contact_study.command_line.frame import MODELS, epilog, print_table, say
from contact_study.inputs.errors import DONE, WRONG_INPUT, InputError

if TYPE_CHECKING:
    from contact_study.study.case import Case
    from contact_study.study.study import Study

KEYS = True
USAGE = "STUDY.toml [--model NAME] [--section.key VALUE ...]"
END = epilog("bem-adhesion check study.toml", "bem-adhesion check study.toml --model atoms --surface.shape 512,512")

# Numbers to expect.
_ZONE, _THETA = "grid points per process zone", "theta = Δγ / U_full (Persson, Tosatti)"
_TABOR, _AREA = "Tabor parameter of the asperities", "area without adhesion, largest load (%)"


def add(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("study", type=Path, metavar="STUDY.toml", help="study file")
    add("--model", choices=MODELS, metavar="NAME", help="continuum, atoms or theory; default: all that can run it")
    add("--section.key", metavar="VALUE", help="any key of the study, as of `bem-adhesion run`")


def run(given: argparse.Namespace) -> int:
    """Check; the exit status is 1 if no model that is asked for can run the study."""
    from contact_study.study.checks import describe_maps
    from contact_study.study.study import read_study

    study = read_study(given.study, given.keys)
    rows, notes = [], dict[str, list[str]]()
    for name in [given.model] if given.model else MODELS:
        try:
            row, found = _judged(name, study)
        except InputError as error:
            if given.model:
                raise
            row, found = (name, "no", "", "", str(error)), []
        rows.append(row)
        for note in found:
            notes.setdefault(note, []).append(name)
    able = [name for name, possible, *_ in rows if possible == "yes"]
    say(f"{given.study}: {study.title}", "bold")
    for line in (*_extent(study), *study.choices, *describe_maps(study.cases)):
        say(line)
    print()
    print_table(("model", "possible", "memory per case", "time on one core", "remark"), rows)
    if numbers := list(_expected([_numbers(case) for case in study.cases])):
        print()
        print_table(("number", "value", "what to expect"), numbers)
    print("", end="\n" if notes else "")
    for note, whose in notes.items():
        who = "" if whose == able else f" ({', '.join(whose)})"
        say(f"warning{who}: {note}", "yellow")
    if not able:
        print(f"{given.command}: no model can run this study", file=sys.stderr)
    return DONE if able else WRONG_INPUT


def _judged(name: str, study: "Study") -> tuple[tuple[str, ...], list[str]]:
    """Return a model's row of the table and its warnings; raises InputError if it cannot run the study."""
    from contact_study.campaign import model as models
    from contact_study.campaign.memory import duration, in_words, require_at_once, seconds_of

    model = models.MODELS[MODELS[name]]
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
    return (name, "yes", in_words(max(need.size for need in needs)), time, remark), notes


def _extent(study: "Study") -> Iterator[str]:
    """Describe the cases, load steps and points."""
    from contact_study.inputs.units import length

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


def _expected(cases: Sequence[dict[str, float]]) -> Iterator[tuple[str, str, str]]:
    """Yield a row for each number and each meaning that it has in some case."""
    for title, meant in _meanings().items():
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


def _meanings() -> dict[str, dict[float, str]]:
    """Return the numbers to expect, and what each means from a least value on."""
    from contact_study.physics.process_zone import DMT_LIKE, JKR_LIKE, POINTS_FOR_ONE_STATE, POINTS_PER_PROCESS_ZONE

    more = f"use {POINTS_PER_PROCESS_ZONE} or more"
    return {
        _ZONE: {
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


def _numbers(case: "Case") -> dict[str, float]:
    """Return what a case has of these numbers; θ as B. N. J. Persson, E. Tosatti, J. Chem. Phys. 115, 5597 (2001)."""
    from contact_study.physics.process_zone import process_zone
    from contact_study.physics.spheres.numbers import tabor_parameter

    law, solid, scales, found = case.law, case.solid, case.scales, dict[str, float]()
    rough, stress = scales.apex_curvature is None, scales.full_contact_stress(solid)
    if law.attracts and not case.surface.absent:
        found[_ZONE] = process_zone(solid.softest_modulus(*scales.grid_waves), law) / scales.pixel
    if law.attracts and rough and scales.spectrum is not None:
        found[_THETA] = law.work_of_adhesion / float(scales.spectrum.full_contact_energy(solid.stiffness))
    if law.attracts and scales.rms_curvature > 0:
        reach = law.length if law.has_wall else law.equilibrium_distance
        about = solid.contact_modulus, law.work_of_adhesion, reach
        found[_TABOR] = float(tabor_parameter(1 / scales.rms_curvature, *about))
    if case.loading.control == "pressure" and stress > 0 and rough:  # by Persson's theory
        found[_AREA] = 100 * math.erf(max(0.0, *case.loading.path) / (math.sqrt(2) * stress))
    return found
