"""The edge flow at light load against adhesive contacts of many surfaces, as Markdown.

Each surface has its theory, fed with its own spectrum. Errors are of means over surfaces, with the standard error of
the paired differences.

python -m scripts.validate_light_load
"""

import argparse
import sys

import numpy as np

from bem_adhesion import rough_contact
from contact_study.atlas.design import MODULUS, SIZE, Condition
from contact_study.physics.laws import TractionLaw
from contact_study.physics.surfaces.surface import Surface
from scripts.harness import Option, minus, program, rough_surface, show, walk
from theory import edge_flow

CONDITIONS = tuple(  # of a Tabor number without hysteresis
    Condition(0, 0.5, 8.0, adhesion, 0.3, "lennard_jones_10_4", "half_space", roll_off)
    for roll_off in (2.0, 4.0)
    for adhesion in (0.1, 0.3)
)
PRESSURES = 0.01, 0.04, 0.15, 0.6  # over half of the modulus times the rms slope


def run(given: argparse.Namespace) -> None:
    rows = []
    for one in CONDITIONS:
        law, height = one.traction_law, one.spectrum.rms_height
        keys = dict(zip(("low_mode", "roll_off_mode", "cutoff_mode"), one.modes, strict=True))
        pairs = []
        for seed in range(1, given.surfaces + 1):
            surface = rough_surface(SIZE, one.points, height, hurst_exponent=one.hurst_exponent, seed=seed, **keys)
            pressures = [0.5 * share * MODULUS * surface.rms_slope for share in PRESSURES]
            pairs.append((simulated(surface, law, pressures), of_edge_flow(surface, law, pressures)))
        # Shapes (pressures, surfaces, quantities); gaps over the rms height.
        truth, theory = np.moveaxis(np.array(pairs), (1, 2), (0, 1)) / (1, height)
        for pressure, *both in zip(PRESSURES, truth, theory, strict=True):
            cells = f"{both[0][:, 0].mean():.3f}", *differences(*both)
            rows.append((f"{one.roll_off_mode:g}", f"{one.relative_adhesion:g}", f"{pressure:g}", *cells))
    show(("q₀L/2π", "θ", "p/(E*h′/2)", "area", "edge flow: error of the area", "of ū/h_rms"), rows)


def simulated(surface: Surface, law: TractionLaw, pressures: list[float]) -> list[tuple[float, float]]:
    """Return area and mean gap (m) by pressure."""
    found = []
    for state in walk(rough_contact(surface.sampled, SIZE, MODULUS, law), pressures):
        area = float(np.mean(state.gap < law.contact_distance))
        found.append((area, float(state.gap.mean()) - law.equilibrium_distance))
    return found


def of_edge_flow(surface: Surface, law: TractionLaw, pressures: list[float]) -> list[tuple[float, float]]:
    flow = edge_flow(surface.measured_spectrum(), MODULUS, law, 1.1 * max(pressures))
    states = [flow.at_pressure(pressure) for pressure in pressures]
    return [(state.fraction_below(law.contact_distance), state.mean_gap - law.equilibrium_distance) for state in states]


def differences(truth: np.ndarray, theory: np.ndarray) -> tuple[str, str]:
    """Write errors of mean area, relative, and of mean gap, from values of shape (surfaces, 2)."""
    errors, scatter = (theory - truth).mean(axis=0), (theory - truth).std(axis=0, ddof=1) / np.sqrt(len(truth))
    area = 100 / truth[:, 0].mean()
    return (
        minus(f"{area * errors[0]:+.1f} ± {area * scatter[0]:.1f} %"),
        minus(f"{errors[1]:+.3f} ± {scatter[1]:.3f}"),
    )


main = program(run, Option("--surfaces", 40, "of each spectrum"))

if __name__ == "__main__":
    sys.exit(main())
