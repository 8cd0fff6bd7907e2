"""Criteria of sticking for studies, beside one another: a table, and a map of all of them.

Each point of each study's sweep, with its target spectrum, or if it has none that of its surface:

    python -m research.criteria_map data/yang2008.toml data/rubber.toml --figure criteria.png
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from contact_study.campaign.command_line.command import Parser, guarded
from contact_study.campaign.store.files import write_aside
from contact_study.plots import criteria_map
from contact_study.study.case import realise
from contact_study.study.study import read_study
from theory import StickinessCriteria, gap_flow, stickiness


def main(arguments: Sequence[str] | None = None) -> int:
    return guarded("criteria_map", lambda: _main(arguments), interrupted="nothing is written")


def _main(arguments: Sequence[str] | None) -> int:
    parser = Parser(description=__doc__.splitlines()[0], allow_abbrev=False)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("studies", type=Path, nargs="+", help="study files")
    parser.add_argument("--figure", type=Path, help="map to write")
    given = parser.parse_args(arguments)
    figure = Figure(figsize=(6.6, 3.4), layout="constrained")
    axes = figure.subplots()
    criteria = ["Persson and Tosatti", "Pastewka and Robbins", "DMT tension", "bearing area"]
    heads = ["Tabor parameter", *criteria, "its pull-off (Pa)"]
    print(f"| system | {' | '.join(heads)} | pull-off of the gap flow (Pa) |\n|{'---|' * (len(heads) + 2)}")
    for path in given.studies:
        for words, found, flow in systems(path):
            ratios = found.persson_tosatti, found.pastewka_robbins, found.dmt_tension, found.bearing_area
            cells = [words, f"{found.tabor_number:.3g}", *(f"{ratio:.3g}" for ratio in ratios)]
            print(f"| {' | '.join(cells)} | {found.bearing_area_pull_off:.2g} | {flow} |")
            criteria_map(found.to_dataset(), axes, words.replace(", ", "\n"))
    if given.figure:
        write_aside(given.figure, lambda partial: figure.savefig(partial, dpi=150, format=given.figure.suffix[1:]))
    return 0


def systems(path: Path) -> Iterator[tuple[str, StickinessCriteria, str]]:
    """Every point of a study's sweep by its name, with its criteria, and the pull-off that a theory of the law has."""
    for case in read_study(path).cases:
        spectrum = case.surface.target_spectrum or realise(case).measured_spectrum()
        words = ", ".join(f"{key.replace('_', ' ')} {value:g}" for key, value in case.coordinates.items())
        known = not case.law.has_wall  # the gap flow goes through no wall
        pull = f"{gap_flow(spectrum, case.solid, case.law).pull_off_pressure:.2g}" if known else "–"
        yield ", ".join(filter(None, (path.stem, words))), stickiness(spectrum, case.solid, case.law), pull


if __name__ == "__main__":
    raise SystemExit(main())
