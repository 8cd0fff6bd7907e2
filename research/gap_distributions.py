"""Gap distributions of the theories against the hard wall on an ensemble of surfaces, as Markdown.

The surfaces are the paper's, of realised rms height; the theories know each surface's own spectrum. The edge flow has
no wall and gets a repulsion of one ångström in its place, whose gap is counted from where it begins. Shares of the area
whose gap is up to a distance, as means over the surfaces.

python -m research.gap_distributions --table data/gap_distributions.csv      # twelve surfaces, 256 × 256 points
python -m research.gap_distributions --from data/gap_distributions.csv
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bem_adhesion import rough_contact
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import HardWall, Repulsive
from contact_study.study.case import Case, realise
from contact_study.study.study import make_study
from theory import edge_flow, gap_distribution

PRESSURES = (1.0, 5.0)  # GPa
DISTANCES = (0.0, 1.0, 3.0, 6.0, 10.0, 20.0)  # Å
MODELS = ("continuum", "Almqvist et al.", "narrowed", "edge flow")
SOFT_WALL = Repulsive(0.0, 1e-10, repulsion=2.0)


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--surfaces", type=int, default=12, help="number of surfaces")
    made.add_argument("--points", type=int, default=256, help="points along each side")
    made.add_argument("--table", type=Path, help="CSV to write the ensemble's means to")
    made.add_argument("--from", type=Path, dest="source", help="CSV to read them from, in place of a run")
    return made


def cases(surfaces: int, points: int) -> tuple[Case, ...]:
    """The surfaces of the paper's statistics."""
    study = {
        "surface": {
            "kind": "self_affine",
            "size": "1040 angstrom",
            "shape": [points, points],
            "rms_height": "10 angstrom",
            "low_mode": 1,
            "roll_off_mode": 3,
            "cutoff_mode": 12,
            "hurst_exponent": 0.8,
            "normalisation": "realised",
        },
        "material": {"youngs_modulus": "77.2 GPa", "poissons_ratio": 0.42},
        "interaction": {"law": "hard_wall"},
        "loading": {"path": [f"{pressure} GPa" for pressure in PRESSURES]},
        "sweep": {"surface.seed": list(range(1, surfaces + 1))},
    }
    return make_study(study).cases


def shares(case: Case) -> Iterator[tuple[str, float, float, float]]:
    """Model, pressure (GPa), distance (Å), share of the area up to it, on one surface."""
    sample, apart = realise(case), 1e-10 * np.array(DISTANCES)
    size = Grid(sample.shape, sample.size).size
    contact = rough_contact(sample.heights(sample.shape), size, case.solid, HardWall(0, 0))
    state, spectrum = contact.separated(), sample.measured_spectrum()
    flow = edge_flow(spectrum, case.solid, SOFT_WALL, 1.1e9 * max(PRESSURES))
    for pressure in PRESSURES:
        solution = contact.step(state, 1e9 * pressure)
        state = solution.state
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


def ensemble(surfaces: int, points: int) -> pd.DataFrame:
    """Mean and standard error of every share: a model, a pressure and a distance a row."""
    rows = [row for case in cases(surfaces, points) for row in shares(case)]
    keys = ["model", "pressure_GPa", "distance_angstrom"]
    groups = pd.DataFrame(rows, columns=[*keys, "share"]).groupby(keys, sort=False)["share"]
    table = pd.DataFrame({"mean": groups.mean(), "standard_error": groups.sem(), "surfaces": groups.count()})
    return table.reset_index()


def lines(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: the error at each distance in per cent, the truth and its own error first."""
    yield f"| p (GPa) | gap up to (Å) | continuum | standard error | {' | '.join(MODELS[1:])} |"
    yield "|---" * (3 + len(MODELS)) + "|"
    for (pressure, distance), here in table.groupby(["pressure_GPa", "distance_angstrom"], sort=False):
        own = here.set_index("model")
        truth = own.loc["continuum", "mean"]
        errors = [f"{100 * (own.loc[model, 'mean'] / truth - 1):+.1f} %" for model in MODELS[1:]]
        error = 100 * own.loc["continuum", "standard_error"] / truth
        row = [f"{pressure:g}", f"{distance:g}", f"{truth:.4f}", f"{error:.1f} %", *errors]
        yield f"| {' | '.join(row).replace('-', '−')} |"


def main(arguments: Sequence[str] | None = None) -> int:
    given = parser().parse_args(arguments)
    table = pd.read_csv(given.source) if given.source is not None else ensemble(given.surfaces, given.points)
    if given.table:
        table.to_csv(given.table, index=False, float_format="%.6g")
    for line in lines(table):
        print(line)
    return 0


if __name__ == "__main__":
    sys.exit(main())
