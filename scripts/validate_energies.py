"""Energies against the work of the load: −∫p d(mean separation) along a branch, by trapezoids, in ever more steps.

`docs/validation.md` explains the columns.

    python -m scripts.validate_energies
"""

import argparse
import sys
from collections.abc import Mapping

import numpy as np

from bem_adhesion import Exponential, HalfSpace, HardWall, Layer, LennardJones104, rough_contact
from bem_adhesion.study.interface import separation_of
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.solids import Elasticity
from scripts.harness import Option, program, rough_surface, show, walk

MODULUS, WORK, RANGE = 93.7e9, 0.69, 3.28e-10
LOADS = (1e9, 2e9)
STEPS = (4, 8, 16, 32, 64)
# Of a name, law and solid.
CONTACTS: Mapping[str, tuple[TractionLaw, Elasticity]] = {
    "hard wall": (HardWall(), HalfSpace(MODULUS)),
    "hard wall, layer": (HardWall(), Layer(MODULUS, 0.3, 1e-8)),
    "Lennard-Jones 10-4": (LennardJones104(WORK, RANGE), HalfSpace(MODULUS)),
    "exponential": (Exponential(WORK, RANGE), HalfSpace(MODULUS)),
}


def run(given: argparse.Namespace) -> None:
    errors = {name: [error(*chosen, given.points, steps) for steps in given.steps] for name, chosen in CONTACTS.items()}
    orders = [np.log2(abs(found[0] / found[-1])) / (len(given.steps) - 1) for found in errors.values()]
    rows = [(steps, *(f"{abs(found[i]):.1e}" for found in errors.values())) for i, steps in enumerate(given.steps)]
    show(("steps", *CONTACTS), [*rows, ("order", *(f"{order:.1f}" for order in orders))])


def error(law: TractionLaw, solid: Elasticity, points: int, steps: int) -> float:
    """Work of the load between two pressures less the energy stored, over the work."""
    surface = rough_surface(5e-8, points, 1e-9, roll_off_mode=3, cutoff_mode=12)
    contact = rough_contact(surface.sampled, surface.grid.size, solid, law, tolerance=1e-11)
    states = list(walk(contact, np.linspace(*LOADS, steps + 1)))
    pressure, separation, energy = np.array(
        [
            (found.pressure.mean(), separation_of(found, solid), found.elastic_energy + found.interaction_energy)
            for found in states
        ]
    ).T
    work = -float(np.trapezoid(pressure, separation))
    return (work - (energy[-1] - energy[0])) / work


main = program(
    run,
    Option("--points", 64, "points along each side"),
    Option("--steps", list(STEPS), "of the branch, each twice the last"),
)

if __name__ == "__main__":
    sys.exit(main())
