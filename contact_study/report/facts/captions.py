"""Facts for the captions of the figures."""

from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr

from contact_study.plots.selection import UNLOADING
from contact_study.report.align.cases import sweep_points
from contact_study.report.align.scales import scales
from contact_study.report.align.states import resolving
from contact_study.report.facts.shown_states import PanelPoints, common_label, point_label, state_label
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.scatter import Scatter
from contact_study.report.text.rendering import paragraphs

_ROUNDING = 1e-6  # of h_rms: deviation from zero of a gap prescribed as zero
_BALANCED = 0.01  # difference from one of a balance of stress that a caption does not mention


def captions(
    inputs: Inputs, shown: PanelPoints, sample: Any, banded: Collection[str], scatter: Scatter | None = None
) -> dict[str, str]:
    """Captions of the figures, by figure name; ``banded`` are labels of the theories with a band."""
    models, units = inputs.models, scales(inputs.models, shown.case)
    resolved = resolving(inputs)
    own_laws = dict.fromkeys(type(case.law) for case in inputs.cases_at(shown.case.selection))
    made = paragraphs(
        "captions.j2",
        entries=[entry_of(name) for name in models],
        laws=sorted(inputs.laws, key=lambda law: law.has_wall),
        own_laws=sorted(own_laws, key=lambda law: law.has_wall),
        shown=shown,
        common=common_label(models, shown.common, inputs.control),
        several=[point_label(named, units, inputs.control) for named in shown.several],
        state=state_label(shown.case, point_label(shown.common, units, inputs.control)),
        average=inputs.average.replace("_", " "),
        sample=sample,
        averaging=inputs.samples > 1,
        compressed=any((own["mean_pressure"] > 0).any() for own in models.values()),
        unloads=any((own["branch"] == UNLOADING).any() for own in models.values()),
        left_out=any((own["detached"] == 1).any() for own in models.values() if "detached" in own),
        below_zero=list(_below_zero(models)),
        banded=[entry_of(name) for name in models if entry_of(name).label in banded],
        scatter=scatter,
        resolving=entry_of(resolved) if resolved else None,
        balances=list(_balances(models)),
        mapped=any("pressure_pdf_at" in dataset for dataset in models.values()),
        simulations=[entry_of(name) for name in inputs.simulations],
    )
    return {name: text for name, _, text in (paragraph.partition(": ") for paragraph in made)}


def _below_zero(models: Mapping[str, xr.Dataset]) -> Iterator[tuple[list[str], str]]:
    """Models with a negative mean gap, and its meaning, for each kind of model that has one."""
    height = scales(models, sweep_points(models)[0]).rms_height
    lowest = {name: own["mean_gap"].min() for name, own in models.items() if "mean_gap" in own}
    negative = [entry_of(name) for name, value in lowest.items() if value < -_ROUNDING * height]
    for meaning in dict.fromkeys(entry.negative_gap for entry in negative):
        yield [entry.words for entry in negative if entry.negative_gap == meaning], meaning


def _balances(models: Mapping[str, xr.Dataset]) -> Iterator[tuple[str, float, float]]:
    """Models whose distribution of stress does not carry the pressure: least and largest share that it carries."""
    for name, dataset in models.items():
        shares = dataset["stress_balance"].values if "stress_balance" in dataset else np.array([])
        shares = shares[np.isfinite(shares)]
        if shares.size and np.abs(shares - 1).max() > _BALANCED:
            yield entry_of(name).words, float(shares.min()), float(shares.max())
