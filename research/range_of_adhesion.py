"""What the range of adhesion decides in a study of a soft body: the automatic range against half of it.

Both on the study's grid, and the automatic range on one of half the points, for what the grid decides.

    python -m research.range_of_adhesion data/rubber.toml
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from bem_adhesion import rough_contact
from bem_adhesion.process_zone import POINTS_PER_PROCESS_ZONE, process_zone
from contact_study.campaign.command_line.command import Parser, guarded
from contact_study.errors import InputError
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import make_law
from contact_study.physics.tabor import ATOMIC
from contact_study.study.case import Case, realise
from contact_study.study.schema.interaction import AUTO, LENGTH
from contact_study.study.study import read_study
from contact_study.units import length


def main(arguments: Sequence[str] | None = None) -> int:
    return guarded("range_of_adhesion", lambda: _main(arguments), interrupted="nothing is written")


def _main(arguments: Sequence[str] | None) -> int:
    parser = Parser(description=__doc__.splitlines()[0], allow_abbrev=False)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("study", type=Path, help="study file of one case")
    study = read_study(parser.parse_args(arguments).study)
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
    print(f"| p (kPa) | branch | {' | '.join(heads)} |\n|{'---|' * (2 + len(heads))}")
    for (pressure, branch), whole, shorter, coarse in zip(case.path, *runs, strict=True):
        cells = [f"{whole:.4f}", f"{shorter:.4f}", change(shorter, whole), f"{coarse:.4f}", change(coarse, whole)]
        print(f"| {pressure / 1e3:g} | {branch} | {' | '.join(cells)} |")
    return 0


def areas(case: Case, reach: float, shape: tuple[int, int]) -> list[float]:
    """Contact area along a case's path with another range (m) and grid."""
    sample = realise(case)
    law = make_law(case.interaction.law, case.work_of_adhesion, reach)
    contact = rough_contact(sample.heights(shape), Grid(shape, sample.size).size, case.solid, law)
    state, found = contact.separated(), []
    for pressure, _ in case.path:
        solution = contact.step(state, pressure)
        state = solution.state
        touching = law.in_contact(solution.gap, solution.pressure, law.contact_distance)
        found.append(float(np.mean(touching)) if solution.converged else float("nan"))
    return found


def change(one: float, other: float) -> str:
    """Relative difference in per cent."""
    return f"{100 * (one / other - 1):+.1f} %"


if __name__ == "__main__":
    raise SystemExit(main())
