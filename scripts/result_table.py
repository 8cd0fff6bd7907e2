"""Contact area and mean gap of every model in one comparison, and what they amount to, as Markdown.

Theories stand with the first spectrum that their study names.

python -m scripts.result_table results/yang2008-paper/comparison.nc --pressures "0.1 GPa" "1 GPa" "10 GPa"
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import xarray as xr

from contact_study.inputs.units import quantity
from contact_study.report.align.deviations import split_pair
from contact_study.report.facts.findings import find
from contact_study.report.models import entry_of, file_kinds, spectrum_of
from contact_study.report.read.files import models_in
from contact_study.report.tables.results import results_tables
from contact_study.report.text.wording import number
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
    print("\n".join(f"- {sentence}" for sentence in findings.sentences(given.brief)))


def table(models: Mapping[str, xr.Dataset], pressures: Sequence[float]) -> str:
    """Markdown: a state a row, "A; ū" of each model a column."""
    names = [entry_of(name).words.removeprefix("the ") for name in models]
    found = results_tables(models, "pressure")
    unit = found[0].header[0]
    lines = [head("", unit, *names)]
    sizes = {"GPa": 1e9, "MPa": 1e6, "kPa": 1e3, "Pa": 1.0}
    wanted = [number(pressure / sizes[unit[3:-1]], 5) for pressure in pressures]
    for point in found:
        for cells in point.rows:
            if cells[0] in wanted:
                states = zip(cells[2 : 2 + len(names)], cells[2 + len(names) :], strict=True)
                lines.append(row(point.title, cells[0], *(f"{area}; {gap}" for area, gap in states)))
    return "\n".join(lines)


main = program(
    run,
    Option("comparison", Path, "dataset that contact-compare wrote"),
    Option("--pressures", str, "pressures of the path to show", nargs="+", required=True),
    Option("--brief", False, "of the sentences below the table only the first"),
)

if __name__ == "__main__":
    sys.exit(main())
