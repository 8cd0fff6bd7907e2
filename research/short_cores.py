"""Areas of the edge flow outside a wall, extrapolated from shorter and shorter repulsions, as Markdown.

The contact atlas uses the repulsions of 0.04 and 0.02 of the law's range; the last row of a condition takes three.

python -m research.short_cores        # two minutes
"""

import argparse
import sys
from itertools import pairwise

import numpy as np

from contact_study.atlas.design import STRESS, Condition, design
from contact_study.atlas.loops import AREA_POWER, seeds_of
from scripts.atlas_tables import by_number
from scripts.harness import Option, program, show
from scripts.validate_hysteresis import theory_input
from theory import edge_flow

CORES = 0.04, 0.02, 0.01, 0.005  # decay lengths over the range
PRESSURES = 0.02, 0.05, 0.1, 0.4, 0.8  # over E* h'/2


def run(given: argparse.Namespace) -> None:
    rows = []
    for one in by_number(design()[0], given.numbers):
        areas = np.array([areas_with(one, core, given.nodes) for core in CORES])
        head = one.number, f"{one.length / one.spectrum.rms_height:.2f}"
        for place, (far, near) in enumerate(pairwise(CORES)):
            found = at_wall((far, near), areas[place : place + 2])
            rows.append((*head, f"{far:g}, {near:g}", *(f"{area:.4f}" for area in found)))
        rows.append((*head, "the last three", *(f"{area:.4f}" for area in at_wall(CORES[1:], areas[1:]))))
    show(("condition", "ρ/h_rms", "repulsions over ρ", *(f"A at {share:g}" for share in PRESSURES)), rows)


def areas_with(condition: Condition, core: float, nodes: int) -> list[float]:
    """Areas of the first surface with one repulsion."""
    pressures = STRESS * np.array(PRESSURES)
    case, spectrum = theory_input(condition, seeds_of(condition, 1)[0], pressures, core)
    flow = edge_flow(spectrum, case.solid, case.law, 1.1 * float(pressures.max()), gaps=nodes)
    return [flow.at_pressure(float(each)).fraction_below(case.contact_distance) for each in pressures]


def at_wall(cores: tuple[float, ...], areas: np.ndarray) -> np.ndarray:
    """Extrapolate areas, shape (cores, n), to none by the polynomial of all in the cores' :data:`AREA_POWER`."""
    lengths = np.power(cores, AREA_POWER)
    weights = [np.prod([other / (other - own) for other in lengths if other != own]) for own in lengths]
    return np.array(weights) @ areas


main = program(
    run,
    Option("--numbers", [352, 133], "conditions of the atlas"),
    Option("--nodes", 960, "of the gap"),
)

if __name__ == "__main__":
    sys.exit(main())
