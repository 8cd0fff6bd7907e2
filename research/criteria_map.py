"""Criteria of sticking for studies, beside one another: a table, and a map of all of them.

Each point of each study's sweep, with its target spectrum, or if it has none that of its surface:

    python -m research.criteria_map data/yang2008.toml data/rubber.toml --figure criteria.png
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from matplotlib.figure import Figure

from contact_study.plots import criteria_map
from contact_study.study.case import realise
from contact_study.study.study import read_study
from scripts.harness import FIGURE, Option, head, program, row, save
from theory import StickinessCriteria, gap_flow, stickiness


def run(given: argparse.Namespace) -> None:
    figure = Figure(figsize=(6.6, 3.4), layout="constrained")
    axes = figure.subplots()
    criteria = ["Persson and Tosatti", "Pastewka and Robbins", "DMT tension", "bearing area"]
    print(head("system", "Tabor parameter", *criteria, "its pull-off (Pa)", "pull-off of the gap flow (Pa)"))
    for path in given.studies:
        for words, found, flow in systems(path):
            ratios = found.persson_tosatti, found.pastewka_robbins, found.dmt_tension, found.bearing_area
            cells = (f"{value:.3g}" for value in (found.tabor_number, *ratios))
            print(row(words, *cells, f"{found.bearing_area_pull_off:.2g}", flow))
            criteria_map(found.to_dataset(), axes, words.replace(", ", "\n"))
    save(figure, given.figure)


def systems(path: Path) -> Iterator[tuple[str, StickinessCriteria, str]]:
    """Every point of a study's sweep by its name, with its criteria, and the pull-off that a theory of the law has."""
    for case in read_study(path).cases:
        spectrum = case.surface.target_spectrum or realise(case).measured_spectrum()
        words = ", ".join(f"{key.replace('_', ' ')} {value:g}" for key, value in case.coordinates.items())
        known = not case.law.has_wall  # the gap flow goes through no wall
        pull = f"{gap_flow(spectrum, case.solid, case.law).pull_off_pressure:.2g}" if known else "–"
        yield ", ".join(filter(None, (path.stem, words))), stickiness(spectrum, case.solid, case.law), pull


main = program(run, Option("studies", Path, "study files", nargs="+"), FIGURE)

if __name__ == "__main__":
    sys.exit(main())
