"""The report: one HTML file that needs nothing else."""

import base64
from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr

from contact_study.report.facts.question import sample_notes, study_paragraphs
from contact_study.report.figures.illustrations import Figures
from contact_study.report.models import FIGURE_TITLES, entry_of, kind_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.tables import results as result_tables
from contact_study.report.tables import settings as setting_tables
from contact_study.report.text.rendering import render

_WIDE = 1000  # pixels: more than one column


def render_report(
    inputs: Inputs,
    deviations: xr.Dataset | None,
    regime: xr.Dataset,
    figures: Figures,
    attrs: Mapping[str, Any],
    findings: Sequence[str] = (),
) -> str:
    """The whole report as HTML."""
    models = inputs.models
    return render(
        "report.html.j2",
        attrs=attrs,
        paragraphs=study_paragraphs(inputs.with_first_spectra),
        findings=findings,
        sample_notes=sample_notes(inputs),
        related=_related(inputs),
        file=next(iter(inputs.paths)),
        created=str(attrs["created"])[:16].replace("T", " "),
        provenance=_provenance(inputs),
        figures=[
            (FIGURE_TITLES[name], base64.b64encode(image).decode(), figures.captions[name], _width(image) < _WIDE)
            for name, image in figures.images.items()
        ],
        summary=None if deviations is None else result_tables.summary_table(models, deviations),
        results=result_tables.results_tables(inputs.models, inputs.control),
        deviations=[] if deviations is None else result_tables.deviation_tables(models, deviations, inputs.control),
        regime=setting_tables.regime_table(inputs.models, regime),
        constants=setting_tables.constants_table(inputs.models),
        effort=setting_tables.effort_table(inputs.models),
        warnings=collected_warnings(inputs),
        study_toml=inputs.study.toml,
        hard_wall=not all(law.attracts for law in inputs.laws),
        adhesive=any(law.attracts for law in inputs.laws),
        wall=any(law.attracts and law.has_wall for law in inputs.laws),
        rough=bool(regime["tabor_parameter"].notnull().any()),
        simulated=bool(inputs.simulations),
        averaged=inputs.average.replace("_", " ") if inputs.samples > 1 else "",
    )


def collected_warnings(inputs: Inputs) -> list[str]:
    """Differences between the studies, and what each model warned of."""
    notes = list(inputs.notes)
    for kind in inputs.paths:
        text = str(inputs.groups[kind][""].attrs.get("warnings", ""))
        notes += [f"{_whose(inputs, kind)}: {line}" for line in text.splitlines() if line]
    return notes


def _width(image: bytes) -> int:
    """Pixels across a PNG file, from its header."""
    return int.from_bytes(image[16:20], "big")


def _provenance(inputs: Inputs) -> list[dict[str, str]]:
    rows = []
    for kind, path in inputs.paths.items():
        attrs = inputs.groups[kind][""].attrs
        when, _, command = str(attrs.get("history", "")).partition(": ")
        rows.append(
            {
                "model": _whose(inputs, kind),
                "file": path.name,
                "commit": str(attrs.get("git_commit", "unknown"))[:12],
                "when": when[:16].replace("T", " "),
                "command": command,
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
