"""Contact area and mean gap of every model in one comparison, and what they amount to, as Markdown.

Theories stand with the first spectrum that their study names.

python -m scripts.result_table results/yang2008-paper/comparison.nc --pressures "0.1 GPa" "1 GPa" "10 GPa"
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from contact_study.inputs.units import quantity
from contact_study.report.align.cases import case_points, mean_unit, scales, select, series, sweep_points
from contact_study.report.align.deviations import split_pair
from contact_study.report.facts.ranking import find
from contact_study.report.models import entry_of, file_kinds, spectrum_of
from contact_study.report.read.files import models_in
from contact_study.report.text.wording import fixed, number
from scripts.harness import Option, head, program, row


def run(given: argparse.Namespace) -> None:
    pressures = [quantity(text, "Pa", "--pressures") for text in given.pressures]
    with xr.open_datatree(given.comparison, decode_timedelta=False) as tree:
        there = {node.path.strip("/") for node in tree.subtree}
        roots = [tree[kind].to_dataset().load() for kind in file_kinds() if kind in there]
        deviations, regime = (tree[name].to_dataset().load() for name in ("deviations", "regime"))
        beside = tree["scatter"].children if "scatter" in there else {}
        scatter = {name: node.to_dataset().load() for name, node in beside.items()}
    models = {name: dataset for root in roots for name, dataset in models_in(root).items()}
    models = {name: dataset for name, dataset in models.items() if not spectrum_of(name)}
    print(table(models, pressures))
    print()
    first = split_pair(deviations["pair"].values[0])[1]
    pairs = [pair for pair in deviations["pair"].values if split_pair(pair)[1] == first]
    from_surfaces = scatter.pop("deviations", None)
    findings = find(models, deviations.sel(pair=pairs), regime, scatter, from_surfaces)
    print("\n".join(f"- {sentence}" for sentence in findings.sentences()))


def table(models: Mapping[str, xr.Dataset], pressures: Sequence[float]) -> str:
    """Markdown: a state a row, "A; ū" of each model a column."""
    names = [entry_of(name).words.removeprefix("the ") for name in models]
    unit = mean_unit(models, "mean_pressure")
    lines = [head("", f"p ({unit.name})", *names)]
    for point in sweep_points(models):
        height = scales(models, point).rms_height
        parts = {name: part for name, own in models.items() if (part := select(own, point)) is not None}
        for pressure in pressures:
            cells = []
            for part in parts.values():
                named = [one for one in case_points(part) if one is not None and one[1:] == (0, 0)]
                step = next((step for step, one in enumerate(named) if np.isclose(float(one[0]), pressure)), None)
                area, gap = series(part, "relative_contact_area"), series(part, "mean_gap")
                shown = "–" if step is None else f"{fixed(area.values[step], 4)}; {_gap(gap.values[step] / height)}"
                cells.append(shown)
            if set(cells) != {"–"}:
                lines.append(row(point.label, number(pressure / unit.size, 5), *cells))
    return "\n".join(lines)


def _gap(value: float) -> str:
    return fixed(value, 3) if np.isfinite(value) else "–"


main = program(
    run,
    Option("comparison", Path, "dataset that contact-compare wrote"),
    Option("--pressures", str, "pressures of the path to show", nargs="+", required=True),
)

if __name__ == "__main__":
    sys.exit(main())
