"""The report: one HTML file that needs nothing else."""

from collections.abc import Callable, Mapping
from dataclasses import astuple
from functools import partial
from typing import Any

import xarray as xr

from contact_study.plots.selection import UNLOADING
from contact_study.report import problem_tables, tables
from contact_study.report.align.cases import sweep_points
from contact_study.report.align.deviations import split_pair
from contact_study.report.align.scales import scales
from contact_study.report.facts import overview
from contact_study.report.facts.differences import differences
from contact_study.report.facts.findings import Findings, relative_errors
from contact_study.report.facts.loops import loops
from contact_study.report.facts.method import settings, starts, uses_target
from contact_study.report.facts.ranking import rank_models
from contact_study.report.figures import Figures
from contact_study.report.models import FIGURE_TITLES, entry_of, kind_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.text.rendering import Both, render
from contact_study.report.text.wording import PRESCRIBED, control_unit, length, number, pressure, span

# Sections of figures: what each holds, in its order.
_SECTIONS = {
    "loading": ("mean_gap",),
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
    references = (
        [] if deviations is None else list(dict.fromkeys(split_pair(str(p))[1] for p in deviations["pair"].values))
    )
    ranked = {
        name: rank_models(inputs.models, deviations, regime, name) for name in references if deviations is not None
    }
    ranked = {name: own for name, own in ranked.items() if own}
    found_loops = loops(shown)
    moduli = {point.label: scales(models, point).contact_modulus for point in sweep_points(models)}
    changes = differences(models, inputs.control)
    return render(
        "report.html.j2",
        attrs=attrs,
        created=str(attrs["created"])[:16].replace("T", " "),
        problem=_problem(shown),
        problem_points=len(moduli),
        lead=entry_of(lead),
        area=overview.extent(models, lead, "relative_contact_area", inputs.control),
        gap=overview.extent(models, lead, "mean_gap", inputs.control),
        extent_of=lambda extent: _prescribed_range(shown, extent),
        gaps_of=lambda extent: _gap_range(shown, extent),
        prescribed=lambda value: _prescribed(shown, value),
        agreement=overview.agreement(shown, deviations),
        nearest=overview.mean_distances(findings.rankings),
        reference=entry_of(references[0]) if references else None,
        pulled=[(one, tables.pull_off_words(one, moduli[one.at])) for one in found_loops if one.model == lead],
        errors=relative_errors(models, lead) if inputs.samples > 1 else [],
        samples=inputs.samples,
        averaged=inputs.average.replace("_", " "),
        loop=any(bool((own["branch"] == UNLOADING).any()) for own in models.values()),
        steps=overview.steps(inputs.models),
        grid=overview.grid_check(shown, regime),
        regime_range={name: overview.overall(regime, name) for name in regime.data_vars},
        summary=tables.agreement_table(shown, findings.rankings) if findings.rankings else None,
        agreements=[
            (entry_of(name), tables.agreement_table(inputs, own), tables.agreement_table(inputs, own, gaps=True))
            for name, own in ranked.items()
        ],
        findings=findings.sentences(),
        target=uses_target(inputs),
        changes=tables.difference_table(inputs, changes) if changes else None,
        loops=tables.loop_table(shown, found_loops) if found_loops else None,
        figures=figures.pages,
        captions=figures.captions,
        titles=FIGURE_TITLES,
        sections=_SECTIONS,
        numbers=tables.all_numbers(inputs, deviations),
        regime=problem_tables.regime_table(inputs.models, regime),
        constants=problem_tables.constants_table(inputs.models),
        effort=problem_tables.effort_table(inputs.models),
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
    words: list[str | Both] = []
    if all(sizes):
        words.append(" × ".join(_values(own, length) for own in sizes))
    kinds: list[tuple[str, str, Callable[[float], str]]] = [
        ("contact_modulus", "E*", partial(pressure, digits=3)),
        ("work_of_adhesion", "Δγ", lambda value: f"{number(value, 3)} J/m²"),
    ]
    if any(case.surface.periodic for case in inputs.cases):
        kinds = [("rms_height", "h_rms", length), ("rms_slope", "rms gradient", partial(number, digits=3)), *kinds]
    radii = sorted({getattr(case.surface, "radius", 0.0) for case in inputs.cases} - {0.0})
    words += [f"sphere of radius {_values(radii, length)}"] if radii else []
    for name, symbol, show in kinds:
        values = [value for value in overview.constants_of(models, name) if value]
        if values:
            words.append(f"{symbol} {_values(values, show)}")
    count = len({kind_of(name) for name in models})
    steps = max(overview.effort(own)[0] // own.sizes.get(inputs.average, 1) for own in models.values())
    words.append(f"{steps} load step{'s' if steps != 1 else ''}")
    if inputs.samples > 1:
        words.append(f"{inputs.samples} {'surfaces' if inputs.average == 'seed' else 'values of ' + inputs.average}")
    words.append(f"{count} models" if count > 1 else entry_of(next(iter(models))).label)
    return words


def _values(values: list[float], show: Callable[[float], str]) -> str:
    """Up to four values with their unit once, or the first and the last."""
    shown = list(dict.fromkeys(show(value) for value in values))
    if len(shown) > 4:
        return span(show(min(values)), show(max(values)))
    units = {words.partition(" ")[2] for words in shown}
    if len(units) == 1 and len(shown) > 1:
        return f"{' / '.join(words.partition(' ')[0] for words in shown)} {units.pop()}".strip()
    return " / ".join(shown)


def _prescribed_range(inputs: Inputs, extent: overview.Extent) -> Both:
    """Pressures or gaps between which a quantity has its extremes."""
    low, high = sorted((extent.low_at, extent.high_at), key=lambda at: at[1])
    words = [_prescribed(inputs, at[1]) for at in (low, high)]
    head = "" if inputs.control == "pressure" else f"{PRESCRIBED[inputs.control]} = "
    ranges = (span(*(own.removeprefix(head) for own in ends)) for ends in zip(*map(astuple, words), strict=True))
    return Both(*(head + ends for ends in ranges))


def _prescribed(inputs: Inputs, value: float) -> Both:
    """A pressure or gap of the path."""
    scale, unit = scales(inputs.models, sweep_points(inputs.models)[0]), control_unit(inputs.models, inputs.control)
    physical = f"{number(value / unit.size, 4)} {unit.name}"
    if inputs.control == "pressure":
        return Both(physical, f"{number(value / scale.contact_modulus, 3)} E*")
    symbol = PRESCRIBED[inputs.control]
    reduced = f"{number(value / scale.rms_height, 3)} {scale.height_symbol}"
    return Both(f"{symbol} = {physical}", f"{symbol} = {reduced}")


def _gap_range(inputs: Inputs, extent: overview.Extent) -> Both:
    ends = []
    for value, (point, _) in ((extent.low, extent.low_at), (extent.high, extent.high_at)):
        scale = scales(inputs.models, point)
        ends.append((_length(value), f"{number(value / scale.rms_height, 3)} {scale.height_symbol}"))
    return Both(span(ends[0][0], ends[1][0]), span(ends[0][1], ends[1][1]))


def _length(value: float) -> str:
    return length(float(f"{value:.3g}")) if value >= 0 else f"−{length(float(f'{-value:.3g}'))}"


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
        rows.append(
            {
                "model": _whose(inputs, kind),
                "file": path.name,
                "version": str(attrs.get("version", "")),
                "commit": str(attrs.get("git_commit", "unknown"))[:12],
                "when": when[:16].replace("T", " "),
                "command": command.partition("\n")[0],
            }
        )
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
        texts[entry.label[0].upper() + entry.label[1:]] = " ".join(filter(None, words))
    return list(texts.items())
