"""Contact area and mean gap of every model in one comparison, and what they amount to, as Markdown.

Theories stand with the first spectrum that their study names.

python -m scripts.result_table results/yang2008-paper/comparison.nc --pressures "0.1 GPa" "1 GPa" "10 GPa"
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import xarray as xr

from contact_study.report.compute.deviations import split_pair
from contact_study.report.facts.findings import find
from contact_study.report.models import entry_of, file_kinds, spectrum_of
from contact_study.report.read.files import models_in
from contact_study.report.text.result_tables import results_tables
from contact_study.report.wording import number
from contact_study.units import quantity


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("comparison", type=Path, help="dataset that contact-compare wrote")
    made.add_argument("--pressures", nargs="+", required=True, help="pressures of the path to show")
    made.add_argument("--brief", action="store_true", help="below the table only the order of the models")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    given = parser().parse_args(arguments)
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
    return 0


def table(models: Mapping[str, xr.Dataset], pressures: Sequence[float]) -> str:
    """Markdown: a state a row, "A; ū" of each model a column."""
    names = [entry_of(name).words.removeprefix("the ") for name in models]
    found = results_tables(models, "pressure")
    unit = found[0].header[0]
    lines = [f"| | {unit} | {' | '.join(names)} |", "|---" * (2 + len(names)) + "|"]
    sizes = {"GPa": 1e9, "MPa": 1e6, "kPa": 1e3, "Pa": 1.0}
    wanted = [number(pressure / sizes[unit[3:-1]], 5) for pressure in pressures]
    for point in found:
        for row in point.rows:
            if row[0] in wanted:
                areas, gaps = row[2 : 2 + len(names)], row[2 + len(names) :]
                cells = [f"{area}; {gap}" for area, gap in zip(areas, gaps, strict=True)]
                lines.append(f"| {point.title} | {row[0]} | {' | '.join(cells)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
