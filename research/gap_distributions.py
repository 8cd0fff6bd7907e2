"""Gap distributions of the theories against the hard wall on an ensemble of surfaces, as Markdown.

The surfaces are the paper's, of realised rms height; the theories know each surface's own spectrum. The edge flow has
no wall and gets a repulsion of one ångström in its place, whose gap is counted from where it begins. Shares of the area
whose gap is up to a distance, as means over the surfaces.

python -m research.gap_distributions --table data/gap_distributions.csv      # twelve surfaces, 256 × 256 points
python -m research.gap_distributions --from data/gap_distributions.csv
"""

import argparse
import sys
from collections.abc import Iterator

import numpy as np
import pandas as pd

from bem_adhesion import rough_contact
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import HardWall, Repulsive
from contact_study.study.case import Case, realise
from contact_study.study.study import make_study, read_study
from scripts.harness import PAPER, Option, head, minus, per_cent, row, tabulated, walk
from theory import edge_flow, gap_distribution

PRESSURES = (1.0, 5.0)  # GPa
DISTANCES = (0.0, 1.0, 3.0, 6.0, 10.0, 20.0)  # Å
MODELS = ("continuum", "Almqvist et al.", "narrowed", "edge flow")
SOFT_WALL = Repulsive(0.0, 1e-10, repulsion=2.0)


def cases(surfaces: int, points: int) -> tuple[Case, ...]:
    """The surfaces of the paper's statistics."""
    table = {
        **read_study(PAPER).table,
        "interaction": {"law": "hard_wall"},
        "loading": {"path": [f"{pressure} GPa" for pressure in PRESSURES]},
        "sweep": {"surface.seed": list(range(1, surfaces + 1))},
    }
    table["surface"] = table["surface"] | {"shape": [points, points], "normalisation": "realised"}
    return make_study({name: table[name] for name in ("surface", "material", "interaction", "loading", "sweep")}).cases


def shares(case: Case) -> Iterator[tuple[str, float, float, float]]:
    """Model, pressure (GPa), distance (Å), share of the area up to it, on one surface."""
    sample, apart = realise(case), 1e-10 * np.array(DISTANCES)
    size = Grid(sample.shape, sample.size).size
    contact = rough_contact(sample.heights(sample.shape), size, case.solid, HardWall(0, 0))
    spectrum = sample.measured_spectrum()
    flow = edge_flow(spectrum, case.solid, SOFT_WALL, 1.1e9 * max(PRESSURES))
    for pressure, solution in zip(PRESSURES, walk(contact, [1e9 * pressure for pressure in PRESSURES]), strict=True):
        touching = solution.pressure > 0
        found = [
            [np.mean(touching | (solution.gap <= distance)) if distance else touching.mean() for distance in apart],
            gap_distribution(spectrum, case.solid, 1e9 * pressure, regularised=False).fraction_below(apart),
            gap_distribution(spectrum, case.solid, 1e9 * pressure).fraction_below(apart),
            [flow.at_pressure(1e9 * pressure).fraction_below(SOFT_WALL.length + distance) for distance in apart],
        ]
        for model, values in zip(MODELS, found, strict=True):
            for distance, value in zip(DISTANCES, values, strict=True):
                yield model, pressure, distance, float(value)


def ensemble(given: argparse.Namespace) -> pd.DataFrame:
    """Mean and standard error of every share: a model, a pressure and a distance a row."""
    rows = [row for case in cases(given.surfaces, given.points) for row in shares(case)]
    keys = ["model", "pressure_GPa", "distance_angstrom"]
    groups = pd.DataFrame(rows, columns=[*keys, "share"]).groupby(keys, sort=False)["share"]
    table = pd.DataFrame({"mean": groups.mean(), "standard_error": groups.sem(), "surfaces": groups.count()})
    return table.reset_index()


def lines(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: the error at each distance in per cent, the truth and its own error first."""
    yield head("p (GPa)", "gap up to (Å)", "continuum", "standard error", *MODELS[1:])
    for (pressure, distance), here in table.groupby(["pressure_GPa", "distance_angstrom"], sort=False):
        own = here.set_index("model")
        truth = own.loc["continuum", "mean"]
        errors = [per_cent(own.loc[model, "mean"], truth) for model in MODELS[1:]]
        error = 100 * own.loc["continuum", "standard_error"] / truth
        yield minus(row(f"{pressure:g}", f"{distance:g}", f"{truth:.4f}", f"{error:.1f} %", *errors))


main = tabulated(
    ensemble, lines, Option("--surfaces", 12, "number of surfaces"), Option("--points", 256, "points along each side")
)

if __name__ == "__main__":
    sys.exit(main())
