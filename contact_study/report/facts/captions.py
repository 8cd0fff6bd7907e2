"""Facts for the captions of the figures."""

from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr

from contact_study.physics.laws import TractionLaw
from contact_study.plots.paths import Curve
from contact_study.report.align.cases import SweepPoint, case_points, select, sweep_points
from contact_study.report.align.curves import PathCurves, Strips, density_at
from contact_study.report.align.scales import scales
from contact_study.report.align.states import resolving
from contact_study.report.facts.shown_states import PanelPoints, common_label, point_label, state_label
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.text.rendering import paragraphs
from contact_study.report.text.wording import listed, listed_points
from contact_study.study.load_steps import PathPoint

_ROUNDING = 1e-6  # of h_rms: what a gap prescribed as zero may differ from it
_BALANCED = 0.01  # difference from one of a balance of stress that a caption does not mention


def captions(
    inputs: Inputs,
    shown: PanelPoints,
    curves: PathCurves,
    sample: Any,
    banded: Collection[str],
    strips: Strips | None = None,
) -> dict[str, str]:
    """Captions of the figures, by figure name."""
    models, units = inputs.models, scales(inputs.models, shown.case)
    labels = [point_label(named, units, inputs.control).partition(" = ") for named in (shown.common, *shown.several)]
    resolved = resolving(inputs)
    made = paragraphs(
        "captions.j2",
        entries=[entry_of(name) for name in models],
        laws=sorted(inputs.laws, key=lambda law: law.has_wall),
        own_laws=_laws_at(inputs, shown.case),
        shown=shown,
        common=common_label(models, shown.common, inputs.control),
        state=state_label(shown.case, point_label(shown.common, units, inputs.control)),
        symbol=labels[0][0],
        values=[value for _, _, value in labels[1:]],
        unit=units.height_symbol,
        average=inputs.average.replace("_", " "),
        sample=sample,
        averaging=inputs.samples > 1,
        compressed=curves.in_compression,
        gap_panels=curves.gap_panels,
        below_zero=list(_below_zero(curves.linear_gaps)),
        banded=[entry_of(name) for name in banded],
        strips=strips,
        absent={name: _absent(inputs, shown, name) for name in ("pressure_pdf", "gap_pdf")},
        resolving=entry_of(resolved) if resolved else None,
        balances=list(_balances(models)),
        mapped=any("pressure_pdf_at" in dataset for dataset in models.values()),
        simulations=[entry_of(name) for name in inputs.simulations],
    )
    return {name: text for name, _, text in (paragraph.partition(": ") for paragraph in made)}


def _laws_at(inputs: Inputs, point: SweepPoint) -> list[type[TractionLaw]]:
    found = dict.fromkeys(type(case.law) for case in inputs.cases_at(point.selection))
    return sorted(found, key=lambda law: law.has_wall)


def _below_zero(curves: Collection[Curve]) -> Iterator[tuple[str, str]]:
    """Models and points with a negative mean gap, and its meaning, for each kind of model that has one."""
    negative = [curve for curve in curves if (curve.x[np.isfinite(curve.y)] < -_ROUNDING).any()]
    for meaning in dict.fromkeys(entry_of(curve.model).negative_gap for curve in curves):
        own = [curve for curve in negative if entry_of(curve.model).negative_gap == meaning]
        if own:
            words = listed(entry_of(curve.model).words for curve in own), listed_points(curve.label for curve in own)
            yield "; ".join(filter(None, words)), meaning


def _balances(models: Mapping[str, xr.Dataset]) -> Iterator[tuple[str, float, float]]:
    """Models whose distribution of stress does not carry the pressure: least and largest share that it carries."""
    for name, dataset in models.items():
        shares = dataset["stress_balance"].values if "stress_balance" in dataset else np.array([])
        shares = shares[np.isfinite(shares)]
        if shares.size and np.abs(shares - 1).max() > _BALANCED:
            yield entry_of(name).words, float(shares.min()), float(shares.max())


def _absent(inputs: Inputs, shown: PanelPoints, name: str) -> dict[str, list[str]]:
    """States without a distribution, by reason."""
    states = [(point, shown.common) for point in sweep_points(inputs.models)]
    states += [(shown.case, named) for named in shown.several]
    missing: dict[str, list[str]] = {}
    for model, dataset in inputs.models.items():
        for point, named in states:
            reason = _why_absent(inputs, dataset, name, point, named)
            if reason:
                label = state_label(point, point_label(named, scales(inputs.models, point), inputs.control))
                missing.setdefault(reason, []).append(f"{entry_of(model).words} at {label}")
    return {reason: list(dict.fromkeys(words)) for reason, words in missing.items()}


def _why_absent(inputs: Inputs, dataset: xr.Dataset, name: str, point: SweepPoint, named: PathPoint) -> str:
    """Why a model shows no distribution at a state; empty where it does, or where it has none at all."""
    part = select(dataset, point)
    if name not in dataset or part is None:
        return ""
    path = case_points(part, inputs.control)
    if named not in path:
        return "Not on the loading path"
    if density_at(dataset, point, name, named, inputs.control) is not None:
        return ""
    state = part.isel(step=path.index(named))
    flags = (("detached", 1), ("converged", 0))
    if any(flag in state and bool((state[flag] == value).any()) for flag, value in flags):
        return "Not shown, being detached or not converged"
    return "Without a result"
