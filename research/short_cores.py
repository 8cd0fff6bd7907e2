"""Areas of the edge flow outside a wall, extrapolated from shorter and shorter repulsions, as Markdown.

The contact atlas uses the repulsions of 0.04 and 0.02 of the law's range; the last row of a condition takes three.

python -m research.short_cores        # two minutes
"""

import argparse
import sys
from itertools import pairwise

import numpy as np

from contact_study.atlas.design import STRESS, Condition, design
from contact_study.atlas.loops import AREA_POWER, seeds_of, without_core
from scripts.atlas_tables import by_number
from scripts.edge_flow_areas import areas_of, theory_input
from scripts.harness import Option, program, show

CORES = 0.04, 0.02, 0.01, 0.005  # decay lengths over the range
PRESSURES = 0.02, 0.05, 0.1, 0.4, 0.8  # over E* h'/2


def run(given: argparse.Namespace) -> None:
    rows = []
    for one in by_number(design()[0], given.numbers):
        areas = {core: areas_with(one, core, given.nodes) for core in CORES}
        for cores in (*pairwise(CORES), CORES[1:]):
            found = without_core([areas[core] for core in cores], AREA_POWER, cores)
            shown = ", ".join(f"{core:g}" for core in cores), *(f"{area:.4f}" for area in found)
            rows.append((one.number, f"{one.length / one.spectrum.rms_height:.2f}", *shown))
    show(("condition", "ρ/h_rms", "repulsions over ρ", *(f"A at {share:g}" for share in PRESSURES)), rows)


def areas_with(condition: Condition, core: float, nodes: int) -> np.ndarray:
    """Areas of the first surface with one repulsion."""
    pressures = STRESS * np.array(PRESSURES)
    case, spectrum = theory_input(condition, seeds_of(condition, 1)[0], pressures, core)
    return np.array(areas_of(case, spectrum, case.law, pressures, nodes))


main = program(
    run,
    Option("--numbers", [352, 133], "conditions of the atlas"),
    Option("--nodes", 960, "of the gap"),
)

if __name__ == "__main__":
    sys.exit(main())
