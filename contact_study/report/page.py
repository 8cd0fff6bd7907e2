"""The report: one HTML file that needs nothing else."""

from collections.abc import Callable, Mapping
from dataclasses import astuple
from functools import partial
from typing import Any

import xarray as xr

from contact_study.campaign.record import key_values
from contact_study.plots.selection import UNLOADING
from contact_study.report import tables
from contact_study.report.align.cases import scales, sweep_points
from contact_study.report.align.deviations import split_pair
from contact_study.report.facts import overview
from contact_study.report.facts.ranking import Findings, rank_models, relative_errors
from contact_study.report.figures import Figures
from contact_study.report.models import FIGURE_TITLES, TARGET, entry_of, kind_of, spectrum_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.text import wording
from contact_study.report.text.rendering import Both, capitalised, render
from contact_study.report.text.wording import PRESCRIBED, length, listed, number, span
from contact_study.study.schema.dotted_keys import SECTIONS, all_keys
from contact_study.study.schema.keys import few

_UNITS = {"Pa": "Pa", "J": "J", "J/m^2": "J m-2", "K": "K", "s": "s", "kg": "kg"}

# Sections of figures: what each holds, in its order.
_SECTIONS = {
    "loading": ("mean_gap", "force", "leakage"),
    "distributions": ("stress_distribution", "gap_distribution", "interface", "atoms"),
    "regime": ("criteria", "magnification"),
}


def render_report(
    inputs: Inputs,
    deviations: xr.Dataset | None,
    regime: xr.Dataset,
    figures: Figures,
    attrs: Mapping[str, Any],
    findings: Findings,
) -> str:
    """The whole report as HTML."""
    shown = inputs.with_first_spectra
    models, lead = shown.models, overview.lead_model(shown)
    pairs = [] if deviations is None else [split_pair(str(pair)) for pair in deviations["pair"].values]
    references = list(dict.fromkeys(reference for _, reference in pairs))
    ranked = {name: rank_models(inputs.models, deviations, regime, name) for name in references}
    found_loops, changes = overview.loops(shown), overview.differences(models)
    leads = [one for one in found_loops if one.model == lead]
    counts = dict(zip(("total", "unconverged", "detached"), overview.effort(*inputs.models.values()), strict=True))
    return render(
        "report.html.j2",
        attrs=attrs,
        created=str(attrs["created"])[:16].replace("T", " "),
        problem=_problem(shown),
        problem_points=len(sweep_points(models)),
        lead=entry_of(lead),
        area=overview.extent(models, lead, "relative_contact_area"),
        gap=overview.extent(models, lead, "mean_gap"),
        extent_of=partial(_prescribed_range, shown),
        gaps_of=partial(_gap_range, shown),
        prescribed=partial(_prescribed, shown),
        agreement=overview.agreement(shown, deviations),
        nearest=overview.mean_distances(findings.rankings),
        reference=entry_of(references[0]) if references else None,
        pulled=[(one, tables.pull_off_words(one, scales(models, one.at).contact_modulus)) for one in leads],
        errors=relative_errors(models, lead) if inputs.samples > 1 else [],
        samples=inputs.samples,
        averaged=inputs.average.replace("_", " "),
        loop=any(bool((own["branch"] == UNLOADING).any()) for own in models.values()),
        steps=counts,
        several=len(inputs.models) > 1,
        grid=overview.grid_check(shown, regime),
        regime_range={name: overview.overall(regime, name) for name in regime.data_vars},
        summary=tables.agreement_table(shown, findings.rankings) if findings.rankings else None,
        agreements=[
            (entry_of(name), tables.agreement_table(inputs, own), tables.agreement_table(inputs, own, gaps=True))
            for name, own in ranked.items()
            if own
        ],
        findings=findings.sentences(),
        target=_uses_target(inputs),
        changes=tables.difference_table(inputs, changes) if changes else None,
        loops=tables.loop_table(shown, found_loops) if found_loops else None,
        figures=figures.pages,
        captions=figures.captions,
        titles=FIGURE_TITLES,
        sections=_SECTIONS,
        numbers=tables.all_numbers(inputs, deviations),
        regime=tables.regime_table(inputs.models, regime),
        constants=tables.constants_table(inputs.models),
        effort=tables.effort_table(inputs.models),
        settings=settings(shown),
        starts=starts(shown),
        related=_related(inputs),
        file=next(iter(inputs.paths)),
        provenance=_provenance(inputs),
        warnings=collected_warnings(inputs),
        study_toml=inputs.study.toml,
        deviations=deviations is not None,
        hard_wall=not all(law.attracts for law in inputs.laws),
        adhesive=any(law.attracts for law in inputs.laws),
        rough=bool(regime["tabor_parameter"].notnull().any()),
        simulated=bool(inputs.simulations),
    )


def _problem(inputs: Inputs) -> list[str | Both]:
    """The problem in numbers: size, roughness, elasticity, adhesion, steps, models."""
    models = inputs.models
    sizes = [overview.constants_of(models, f"surface_size_{axis}") for axis in ("y", "x")]
    words: list[str | Both] = [" × ".join(_values(own, length) for own in sizes)] if all(sizes) else []
    counter = any(case.material.counter_modulus is not None for case in inputs.cases)
    kinds: list[tuple[str, str, Callable[[float], str]]] = [
        ("contact_modulus", "combined E* of two bodies" if counter else "E*", partial(wording.pressure, digits=3)),
        ("work_of_adhesion", "Δγ", lambda value: f"{number(value, 3)} J/m²"),
    ]
    if any(case.geometry.periodic for case in inputs.cases):
        kinds = [("rms_height", "h_rms", length), ("rms_slope", "rms gradient", partial(number, digits=3)), *kinds]
    radii = sorted({getattr(case.surface, "radius", 0.0) for case in inputs.cases} - {0.0})
    words += [f"sphere of radius {_values(radii, length)}"] if radii else []
    words += sorted({case.form.words for case in inputs.cases if case.form.kind != "none"})
    for name, symbol, show in kinds:
        if values := [value for value in overview.constants_of(models, name) if value]:
            words.append(f"{symbol} {_values(values, show)}")
    count = len({kind_of(name) for name in models})
    steps = max(overview.effort(own)[0] // own.sizes.get(inputs.average, 1) for own in models.values())
    words.append(f"{steps} load step{'s' if steps != 1 else ''}")
    if inputs.samples > 1:
        words.append(f"{inputs.samples} {'surfaces' if inputs.average == 'seed' else 'values of ' + inputs.average}")
    return [*words, f"{count} models" if count > 1 else entry_of(next(iter(models))).label]


def _values(values: list[float], show: Callable[[float], str]) -> str:
    """Up to four values with their unit once, or the first and the last."""
    shown = list(dict.fromkeys(show(value) for value in values))
    if len(shown) > 4:
        return span(show(min(values)), show(max(values)))
    units = {words.partition(" ")[2] for words in shown}
    if len(units) == 1 and len(shown) > 1:
        return f"{' / '.join(words.partition(' ')[0] for words in shown)} {units.pop()}".strip()
    return " / ".join(shown)


def _prescribed_range(inputs: Inputs, extent: tuple[overview.At, overview.At]) -> Both:
    """Pressures or gaps between which a quantity has its extremes."""
    words = [_prescribed(inputs, value) for value in sorted(at.prescribed for at in extent)]
    head = "" if inputs.control == "pressure" else f"{PRESCRIBED[inputs.control]} = "
    ranges = (span(*(own.removeprefix(head) for own in ends)) for ends in zip(*map(astuple, words), strict=True))
    return Both(*(head + ends for ends in ranges))


def _prescribed(inputs: Inputs, value: float) -> Both:
    """A pressure or gap of the path."""
    scale = scales(inputs.models, sweep_points(inputs.models)[0])
    unit = wording.control_unit(inputs.models, inputs.control)
    physical = f"{number(value / unit.size, 4)} {unit.name}"
    if inputs.control == "pressure":
        return Both(physical, f"{number(value / scale.contact_modulus, 3)} E*")
    reduced = f"{number(value / scale.rms_height, 3)} {scale.height_symbol}"
    return Both(*(f"{PRESCRIBED[inputs.control]} = {words}" for words in (physical, reduced)))


def _gap_range(inputs: Inputs, extent: tuple[overview.At, overview.At]) -> Both:
    ends = []
    for at in extent:
        scale, rounded = scales(inputs.models, at.point), float(f"{at.value:.3g}")
        physical = length(rounded) if rounded >= 0 else f"−{length(-rounded)}"
        ends.append((physical, f"{number(at.value / scale.rms_height, 3)} {scale.height_symbol}"))
    return Both(*(span(*own) for own in zip(*ends, strict=True)))


def collected_warnings(inputs: Inputs) -> list[str]:
    """Differences between the studies, and what each model warned of."""
    notes = list(inputs.notes)
    for kind in inputs.paths:
        text = str(inputs.groups[kind][""].attrs.get("warnings", ""))
        notes += [f"{_whose(inputs, kind)}: {line}" for line in text.splitlines() if line]
    return notes


def _provenance(inputs: Inputs) -> list[dict[str, str]]:
    rows = []
    for kind, path in inputs.paths.items():
        attrs = inputs.groups[kind][""].attrs
        when, _, command = str(attrs.get("history", "")).partition(": ")
        rows.append({"model": _whose(inputs, kind), "file": path.name, "version": str(attrs.get("version", ""))})
        rows[-1] |= {"when": when[:16].replace("T", " "), "command": command.partition("\n")[0]}
        rows[-1]["commit"] = str(attrs.get("git_commit", "unknown"))[:12]
    return rows


def _whose(inputs: Inputs, file: str) -> str:
    """The models of a file: the one, or all together."""
    labels = [entry_of(name).label for name in inputs.models if entry_of(name).file == file]
    return labels[0] if len(labels) == 1 else "theories" + "".join(f" ({tail})" for tail in file.split(":")[1:])


def _related(inputs: Inputs) -> list[tuple[str, str]]:
    """Describe each model, once for several datasets of it."""
    texts = {}
    adhesive, hard = any(law.attracts for law in inputs.laws), not all(law.attracts for law in inputs.laws)
    for entry in (entry_of(kind_of(name)) for name in inputs.models):
        words = [entry.about, entry.about_adhesion if adhesive else "", entry.about_hard_wall if hard else ""]
        words.append(f"Status: {entry.status}." if entry.status else "")
        texts[capitalised(entry.label)] = " ".join(filter(None, words))
    return list(texts.items())


def settings(inputs: Inputs) -> list[tuple[str, str]]:
    """Keys of the studies that differ from their defaults, each with its values over all cases."""
    known = {f"{section}.{name}": (declared.kind, default) for section, name, declared, default in all_keys()}
    sections = [name for name in SECTIONS if name not in ("study", "output")]
    found: dict[str, list[Any]] = {}
    for case in (case for study in inputs.studies.values() for case in study.cases):
        for key, value in key_values(case, sections):
            found.setdefault(key, []).append(value)
    return [
        (key, wording.varied(_shown(key, value, _unit(inputs, key, known[key][0])) for value in values))
        for key, values in found.items()
        if any(value not in (None, known[key][1]) for value in values)
    ]


def _unit(inputs: Inputs, key: str, kind: str) -> str:
    if key in ("loading.path", "loading.amplitude"):
        return "Pa" if inputs.control == "pressure" else "m"
    return "m" if kind in ("m", "m or [y, x]", "list of m") else _UNITS.get(kind.removeprefix("list of "), "1")


def _shown(key: str, value: Any, units: str) -> str:
    if value is None:
        return "not given"
    if isinstance(value, tuple | list):
        between = " × " if key in ("surface.size", "surface.shape") else ", "
        return between.join(few([_shown(key, one, units) for one in value]))
    return wording.key_value(key.partition(".")[2], value, units) if not isinstance(value, dict) else str(value)


def starts(inputs: Inputs) -> list[str]:
    """Starting configurations of the models, those of the simulations that start others first."""
    # A dataset joined of parts names the predictor of each, a line each.
    lines = {name: str(inputs.models[name].attrs.get("predictor", "")).splitlines() for name in inputs.simulations}
    fields = {name: listed(line.partition(" ")[0] for line in own) if own else "" for name, own in lines.items()}
    found = [
        (entry_of(name).start_predicted if fields[name] else entry_of(name).start).format(predictor=fields[name])
        for name in sorted(fields, key=lambda name: bool(fields[name]))
    ]
    adhesive = any(law.attracts for law in inputs.laws)
    return found + [entry_of(name).start for name in inputs.models if adhesive and name not in inputs.simulations]


def _uses_target(inputs: Inputs) -> bool:
    """Whether a theory beside simulations is fed with the spectrum that surfaces are made from."""
    theories = [name for name in inputs.models if not entry_of(name).simulation]
    cases = {name: inputs.studies[entry_of(name).file].cases for name in theories}
    simulated = [case for name in inputs.simulations for case in inputs.studies[entry_of(name).file].cases]
    return any(case.geometry.realisation is not None for case in simulated) and any(
        (spectrum_of(name) or case.spectra[0]) == TARGET for name, own in cases.items() for case in own
    )
