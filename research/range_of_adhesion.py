"""What the range of adhesion decides in a study of a soft body: the automatic range against half of it.

Both on the study's grid, and the automatic range on one of half the points, for what the grid decides.

    python -m research.range_of_adhesion data/rubber.toml
"""

import argparse
import sys
from dataclasses import replace

import numpy as np

from bem_adhesion import rough_contact
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import length
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import make_law
from contact_study.physics.process_zone import ATOMIC, POINTS_PER_PROCESS_ZONE, process_zone
from contact_study.study.case import Case, realise
from contact_study.study.schema.interaction import AUTO, LENGTH
from contact_study.study.study import read_study
from scripts.harness import STUDY, per_cent, program, show, walk


def run(given: argparse.Namespace) -> None:
    study = read_study(given.study)
    if len(study.cases) != 1 or not study.choices:
        raise InputError(f'{study.title}: expected one case with {LENGTH} = "{AUTO}"')
    case = study.cases[0]
    shape = realise(case).shape
    half = (shape[0] // 2, shape[1] // 2)
    long, short = case.law.length, case.law.length / 2
    zone = process_zone(case.material.contact_modulus, replace(case.law, length=ATOMIC))
    needed = POINTS_PER_PROCESS_ZONE * max(case.surface.size or (0.0,)) / zone
    print(
        f"The automatic range is {length(long)}, on {shape[0]}² points. A range of {length(ATOMIC)} would need "
        f"{needed:.1e} points a side.\n"
    )
    runs = [areas(case, long, shape), areas(case, short, shape), areas(case, long, half)]
    heads = [f"A/A₀, {length(long)}", f"{length(short)}", "change", f"{length(long)}, {half[0]}²", "change"]
    rows = zip(case.path, *runs, strict=True)
    show(
        ("p (kPa)", "branch", *heads),
        (
            (f"{p / 1e3:g}", branch, f"{whole:.4f}", *compared(shorter, whole), *compared(coarse, whole))
            for (p, branch), whole, shorter, coarse in rows
        ),
    )


def areas(case: Case, reach: float, shape: tuple[int, int]) -> list[float]:
    """Contact area along a case's path with another range (m) and grid."""
    sample = realise(case)
    law = make_law(case.interaction.law, case.work_of_adhesion, reach)
    contact = rough_contact(sample.heights(shape), Grid(shape, sample.size).size, case.solid, law)
    found = []
    for solution in walk(contact, (pressure for pressure, _ in case.path)):
        touching = law.in_contact(solution.gap, solution.pressure, law.contact_distance)
        found.append(float(np.mean(touching)) if solution.converged else float("nan"))
    return found


def compared(one: float, other: float) -> tuple[str, str]:
    """An area, and by how much it differs from another."""
    return f"{one:.4f}", per_cent(one, other)


main = program(run, STUDY)

if __name__ == "__main__":
    sys.exit(main())
