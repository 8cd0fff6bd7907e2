"""Check a study: what it holds, what it needs, what to expect. No solver runs."""

import argparse
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_study.command_line.frame import MODELS, epilog
from contact_study.inputs.errors import DONE, WRONG_INPUT, InputError

if TYPE_CHECKING:
    from contact_study.study.case import Case
    from contact_study.study.study import Study

KEYS = True
USAGE = "STUDY.toml [--model NAME] [--section.key VALUE ...]"
END = epilog("bem-adhesion check study.toml", "bem-adhesion check study.toml --model atoms --surface.shape 512,512")


def add(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    add = parser.add_argument
    add("study", type=Path, metavar="STUDY.toml", help="study file")
    add("--model", choices=MODELS, metavar="NAME", help="continuum, atoms or theory; default: all that can run it")
    add("--section.key", metavar="VALUE", help="any key of the study, as of `bem-adhesion run`")


def run(given: argparse.Namespace) -> int:
    """Check; the exit status is 1 if no model that is asked for can run the study."""
    from contact_study.command_line.terminal import print_table, say
    from contact_study.study.checks import describe_maps
    from contact_study.study.study import read_study

    study = read_study(given.study, given.keys)
    names = [given.model] if given.model else list(MODELS)
    rows, notes = [], dict[str, list[str]]()
    for name in names:
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
    numbers = list(_expected(study.cases))
    if numbers:
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
    from contact_study.campaign.memory import duration, in_words, require_at_once, seconds_of
    from contact_study.campaign.model import MODELS as MODELS_BY_KIND
    from contact_study.campaign.model import check_study

    model = MODELS_BY_KIND[MODELS[name]]
    _, notes = check_study(model, study)
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
    swept = "; ".join(f"{name}: {_listed(key.values)}" for name, key in study.sweep.items())
    each = f"{steps[0]} load steps" if min(steps) == max(steps) else f"{min(steps)} to {max(steps)} load steps"
    cases = f"1 case of {each}" if len(steps) == 1 else f"{len(steps)} cases of {each}, {sum(steps)} in all"
    yield f"{cases}{f' ({swept})' if swept else ''}"
    rough = [case.scales for case in study.cases if not case.surface.absent]
    grids = {(scale.shape, scale.size) for scale in rough}
    for shape, size in sorted(grids)[:3]:
        spacing = max(side / points for side, points in zip(size, shape, strict=True))
        yield f"{shape[0]} x {shape[1]} points on {length(*size)} (y, x), spacing {length(spacing)}"
    if len(grids) > 3:
        yield f"and {len(grids) - 3} other grids"


def _listed(values: Sequence[Any]) -> str:
    words = [f"{value:.4g}" if isinstance(value, float) else str(value) for value in values]
    return ", ".join(words) if len(words) <= 6 else f"{words[0]}, {words[1]} ... {words[-1]}"


def _expected(cases: "tuple[Case, ...]") -> Iterator[tuple[str, str, str]]:
    """Yield a row for each number and each meaning that it has in some case."""
    for title, of, meaning in _NUMBERS:
        found = [value for case in cases if (value := of(case)) is not None]
        groups: dict[str, list[float]] = {}
        for value in found:
            groups.setdefault(meaning(value), []).append(value)
        for words, values in sorted(groups.items(), key=lambda item: min(item[1])):
            low, high = f"{min(values):.3g}", f"{max(values):.3g}"
            part = "" if len(values) == len(cases) else f" ({len(values)} of {len(cases)} cases)"
            yield title, low if low == high else f"{low} to {high}", words + part
            title = ""


def _zone_points(case: "Case") -> float | None:
    if case.surface.absent or not case.law.attracts:
        return None
    from contact_study.physics.process_zone import process_zone

    return process_zone(case.solid.softest_modulus(*case.scales.grid_waves), case.law) / case.scales.pixel


def _zone_meaning(points: float) -> str:
    from contact_study.physics.process_zone import POINTS_FOR_ONE_STATE, POINTS_PER_PROCESS_ZONE

    if points >= POINTS_PER_PROCESS_ZONE:
        return "the grid resolves contact edges"
    more = f"use {POINTS_PER_PROCESS_ZONE} or more"
    if points >= POINTS_FOR_ONE_STATE:
        return f"edges are trapped on unloading, pull-off comes out too strong; {more}"
    return f"too coarse: the area may be wrong by a factor of two, pull-off is the grid's; {more}"


def _theta(case: "Case") -> float | None:
    """Return Δγ over the energy of full contact; B. N. J. Persson, E. Tosatti, J. Chem. Phys. 115, 5597 (2001)."""
    spectrum = case.scales.spectrum
    if spectrum is None or not case.law.attracts or case.scales.apex_curvature is not None:
        return None
    return case.law.work_of_adhesion / float(spectrum.full_contact_energy(case.solid.stiffness))


def _theta_meaning(theta: float) -> str:
    if theta > 1:
        return "full contact gains energy: surfaces that touch will stick completely"
    return "full contact costs energy: contact stays partial without a load"


def _tabor(case: "Case") -> float | None:
    from contact_study.physics.tabor import tabor_parameter

    law, curvature = case.law, case.scales.rms_curvature
    if not law.attracts or not curvature > 0:
        return None
    reach = law.length if law.has_wall else law.equilibrium_distance
    return tabor_parameter(1 / curvature, case.solid.contact_modulus, law.work_of_adhesion, reach)


def _tabor_meaning(tabor: float) -> str:
    from contact_study.physics.tabor import DMT_LIKE, JKR_LIKE

    if tabor > JKR_LIKE:
        return "JKR-like: contacts jump, loading and unloading will differ"
    if tabor > DMT_LIKE:
        return "between the limits: the range matters, loading and unloading may differ"
    return "DMT-like: adhesion hardly deforms the solid, loading and unloading agree"


def _bare_area(case: "Case") -> float | None:
    """Return the contact area without adhesion at the largest pressure, by Persson's theory, in per cent."""
    stress = case.scales.full_contact_stress(case.solid)
    if case.loading.control != "pressure" or not stress > 0 or case.scales.apex_curvature is not None:
        return None
    return 100 * math.erf(max(0.0, *case.loading.path) / (math.sqrt(2) * stress))


def _bare_meaning(area: float) -> str:
    return "light contact, in proportion to the load" if area < 20 else "beyond light contact"


_NUMBERS: tuple[tuple[str, Callable[["Case"], float | None], Callable[[float], str]], ...] = (
    ("grid points per process zone", _zone_points, _zone_meaning),
    ("theta = Δγ / U_full (Persson, Tosatti)", _theta, _theta_meaning),
    ("Tabor parameter of the asperities", _tabor, _tabor_meaning),
    ("area without adhesion, largest load (%)", _bare_area, _bare_meaning),
)
