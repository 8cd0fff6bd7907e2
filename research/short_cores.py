"""Areas of the edge flow outside a wall, extrapolated from shorter and shorter repulsions, as Markdown.

The contact atlas uses 0.004 and 0.002 of the rms height, or 0.02 and 0.01 of the range if these are shorter.

python -m research.short_cores        # ten seconds
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

CORES = 0.016, 0.008, 0.004, 0.002, 0.001  # decay lengths over the rms height
PRESSURES = 0.02, 0.05, 0.1, 0.4, 0.8  # over E* h'/2


def run(given: argparse.Namespace) -> None:
    rows = []
    for one in by_number(design()[0], given.numbers):
        areas = {core: areas_with(one, core) for core in CORES}
        for cores in pairwise(CORES):
            found = without_core([areas[core] for core in cores], AREA_POWER, cores)
            shown = ", ".join(f"{core:g}" for core in cores), *(f"{area:.4f}" for area in found)
            rows.append((one.number, f"{one.length / one.spectrum.rms_height:.2f}", *shown))
    show(("condition", "ρ/h_rms", "repulsions over h_rms", *(f"A at {share:g}" for share in PRESSURES)), rows)


def areas_with(condition: Condition, core: float) -> np.ndarray:
    """Areas of the first surface with one repulsion."""
    pressures = STRESS * np.array(PRESSURES)
    over_range = core * condition.spectrum.rms_height / condition.length
    case, spectrum = theory_input(condition, seeds_of(condition, 1)[0], pressures, over_range)
    return np.array(areas_of(case, spectrum, case.law, pressures))


main = program(
    run,
    Option("--numbers", [352, 133], "conditions of the atlas"),
)

if __name__ == "__main__":
    sys.exit(main())
