"""Adhesion with a hardness beside the public code Adhesion: the same law, surface and loads, up and down and up again.

Its plastic system continues the law below the gap where the pressure reaches the hardness, and moves the surface after
each step. The states should agree to the tolerances of both solvers.

    python -m scripts.validate_plasticity --table data/adhesion_plastic.csv     # runs Adhesion (extra peers)
    python -m scripts.validate_plasticity --from data/adhesion_plastic.csv
"""

import argparse
import sys
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pandas as pd

from bem_adhesion import HalfSpace, LennardJones, rough_contact
from scripts.harness import head, row, tabulated

POINTS, SIZE = 32, 50.0  # side (nm)
MODULUS, HARDNESS = 1.0, 0.25  # GPa, so that forces are in nN
WORK, LENGTH = 0.03, 0.6  # J/m², nm
OFFSETS = (0.5, 1.5, 3.0, 2.0, 1.0, 3.0, 3.5)  # of the body, in Adhesion's convention (nm)


@dataclass(frozen=True)
class LennardJones93Potential(LennardJones):
    """The law whose potential has the powers 9 and 3, as that of Adhesion."""

    exponent: ClassVar[int] = 4


def heights() -> np.ndarray:
    """Two waves (nm)."""
    x = 2 * np.pi * np.arange(POINTS) / POINTS
    return np.outer(np.cos(x), np.cos(x)) + 0.3 * np.outer(np.cos(3 * x), np.cos(2 * x))


def theirs(given: argparse.Namespace) -> Iterator[dict[str, float]]:
    """States of Adhesion's plastic system along the offsets."""
    from Adhesion.Interactions import LJ93
    from Adhesion.System import PlasticSmoothContactSystem
    from ContactMechanics import PeriodicFFTElasticHalfSpace
    from SurfaceTopography import PlasticTopography, Topography

    law = LJ93(WORK / (np.sqrt(2.5) * 2 / 3), LENGTH * 2.5 ** (1 / 6))
    surface = PlasticTopography(Topography(heights(), (SIZE, SIZE), periodic=True), HARDNESS)
    body = PeriodicFFTElasticHalfSpace((POINTS, POINTS), MODULUS, (SIZE, SIZE))
    system, start = PlasticSmoothContactSystem(body, law, surface), None
    options = {"maxiter": 20_000, "maxfun": 40_000, "gtol": 1e-9, "ftol": 1e-18}
    for offset in OFFSETS:
        system.minimize_proxy(offset=offset, initial_displacements=start, method="L-BFGS-B", options=options)
        start = system.disp.copy()
        gap, moved = system.compute_gap(system.disp, offset), np.asarray(surface.plastic_displ)
        yield {
            "pressure": system.compute_normal_force() / SIZE**2,
            "mean_gap": float(gap.mean()),
            "yielded": float((moved < 0).mean()),
            "indentation": abs(float(moved.mean())),
        }


def ours(pressures: np.ndarray) -> Iterator[tuple[float, float, float]]:
    """Mean gap (nm), share of yielded points and mean indentation (nm) at mean pressures (GPa)."""
    warnings.filterwarnings("ignore", message="grid too coarse")  # the comparison needs no finer one
    law = LennardJones93Potential(WORK, 1e-9 * LENGTH)
    contact = rough_contact(1e-9 * heights(), 1e-9 * SIZE, HalfSpace(1e9 * MODULUS), law, hardness=1e9 * HARDNESS)
    state = contact.separated()
    for pressure in pressures:
        state = contact.step(state, 1e9 * pressure)
        indentation = state.plastic_indentation
        yield 1e9 * state.gap.mean(), float(np.mean(indentation > 0)), 1e9 * indentation.mean()


def lines(table: pd.DataFrame) -> Iterator[str]:
    yield head("p (GPa)", "mean gap (nm)", "Adhesion", "yielded", "Adhesion", "mean indentation (nm)", "Adhesion")
    for one, found in zip(table.itertuples(), ours(table.pressure.values), strict=True):
        pairs = zip(found, (one.mean_gap, one.yielded, one.indentation), strict=True)
        yield row(f"{one.pressure:.4f}", *(f"{value:.4f}" for pair in pairs for value in pair))


main = tabulated(theirs, lines)

if __name__ == "__main__":
    sys.exit(main())
