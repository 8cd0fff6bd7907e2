"""Energies against the work of the load: −∫p d(mean separation) along a branch, by trapezoids, in ever more steps.

`docs/validation.md` explains the columns.

    python -m scripts.validate_energies
"""

import argparse
import sys
from collections.abc import Mapping, Sequence

import numpy as np

from bem_adhesion import Exponential, HalfSpace, HardWall, Layer, LennardJones104, rough_contact
from bem_adhesion.study.state import separation_of
from contact_study.campaign.command_line.command import Parser, guarded
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.solids import Elasticity
from contact_study.study.case import realise
from contact_study.study.study import make_study

MODULUS, WORK, RANGE = 93.7e9, 0.69, 3.28e-10
SURFACE = {
    "kind": "self_affine",
    "size": 5e-8,
    "hurst_exponent": 0.8,
    "rms_height": 1e-9,
    "roll_off_mode": 3,
    "cutoff_mode": 12,
    "seed": 1,
}
LOADS = (1e9, 2e9)
STEPS = (4, 8, 16, 32, 64)
# Of a name, law and solid.
CONTACTS: Mapping[str, tuple[TractionLaw, Elasticity]] = {
    "hard wall": (HardWall(), HalfSpace(MODULUS)),
    "hard wall, layer": (HardWall(), Layer(MODULUS, 0.3, 1e-8)),
    "Lennard-Jones 10-4": (LennardJones104(WORK, RANGE), HalfSpace(MODULUS)),
    "exponential": (Exponential(WORK, RANGE), HalfSpace(MODULUS)),
}


def main(arguments: Sequence[str] | None = None) -> int:
    return guarded("validate_energies", lambda: _main(arguments), interrupted="nothing is written")


def parser() -> Parser:
    made = Parser(
        description=__doc__.splitlines()[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter, allow_abbrev=False
    )
    made.add_argument("--points", type=int, default=64, help="points along each side")
    made.add_argument("--steps", type=int, nargs="+", default=list(STEPS), help="of the branch, each twice the last")
    return made


def _main(arguments: Sequence[str] | None) -> int:
    given = parser().parse_args(arguments)
    print(f"| steps | {' | '.join(CONTACTS)} |\n{'|---' * (1 + len(CONTACTS))}|")
    errors = {name: [error(*chosen, given.points, steps) for steps in given.steps] for name, chosen in CONTACTS.items()}
    for row, steps in enumerate(given.steps):
        print(f"| {steps} | {' | '.join(f'{abs(found[row]):.1e}' for found in errors.values())} |")
    orders = [np.log2(abs(found[0] / found[-1])) / (len(given.steps) - 1) for found in errors.values()]
    print(f"| order | {' | '.join(f'{order:.1f}' for order in orders)} |")
    return 0


def error(law: TractionLaw, solid: Elasticity, points: int, steps: int) -> float:
    """Work of the load between two pressures less the energy stored, over the work."""
    surface = realise(
        make_study(
            {
                "surface": {**SURFACE, "shape": [points, points]},
                "material": {"youngs_modulus": MODULUS, "poissons_ratio": 0.0},
                "interaction": {"law": "hard_wall"},
                "loading": {"path": list(LOADS)},
            }
        ).cases[0]
    )
    contact = rough_contact(surface.sampled, surface.grid.size, solid, law, tolerance=1e-11)
    state = contact.separated()
    pressure, separation, energy = [], [], []
    for load in np.linspace(*LOADS, steps + 1):
        found = contact.step(state, load)
        state = found.state
        pressure.append(float(np.mean(found.pressure)))
        separation.append(separation_of(found, solid))
        energy.append(found.elastic_energy + found.interaction_energy)
    work = -float(np.trapezoid(pressure, separation))
    return (work - (energy[-1] - energy[0])) / work


if __name__ == "__main__":
    sys.exit(main())
