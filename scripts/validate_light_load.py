"""The edge flow at light load against adhesive contacts of many surfaces, as Markdown.

Each surface has its theory, fed with its own spectrum. Errors are of means over surfaces, with the standard error of
the paired differences.

python -m scripts.validate_light_load
"""

import argparse
import sys

import numpy as np

from bem_adhesion import rough_contact
from contact_study.physics.laws import LennardJones104
from contact_study.physics.process_zone import process_zone, resolving_shape
from contact_study.physics.solids import HalfSpace
from contact_study.physics.spheres.numbers import tabor_parameter
from contact_study.physics.surfaces.surface import Surface
from contact_study.study.schema.modes import spectrum_of_modes
from scripts.harness import Option, minus, program, rough_surface, show, walk
from theory import edge_flow

SIZE, HEIGHT, MODULUS = 1e-6, 1e-9, 1e9  # m, m, Pa
HURST, RATIO = 0.5, 8.0  # Hurst exponent, cutoff over roll-off
CONDITIONS = tuple((roll_off, adhesion) for roll_off in (2.0, 4.0) for adhesion in (0.1, 0.3))  # modes; θ
TABOR = 0.3  # of the mean asperity: without hysteresis
PRESSURES = 0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.6  # over half of the modulus times the rms slope


def run(given: argparse.Namespace) -> None:
    rows = []
    for roll_off, adhesion in CONDITIONS:
        modes = (1.0, roll_off, RATIO * roll_off)
        law, points = law_and_grid(modes, adhesion)
        pairs = []
        for seed in range(1, given.surfaces + 1):
            keys = dict(zip(("low_mode", "roll_off_mode", "cutoff_mode"), modes, strict=True))
            surface = rough_surface(SIZE, points, HEIGHT, hurst_exponent=HURST, seed=seed, **keys)
            pressures = [0.5 * share * MODULUS * surface.rms_slope for share in PRESSURES]
            pairs.append((simulated(surface, law, pressures), of_edge_flow(surface, law, pressures)))
        truth, theory = np.moveaxis(np.array(pairs), 1, 0)  # shapes (surfaces, pressures, quantities)
        for place, pressure in list(enumerate(PRESSURES))[::2]:
            cells = f"{truth[:, place, 0].mean():.3f}", *differences(truth[:, place], theory[:, place])
            rows.append((f"{roll_off:g}", f"{adhesion:g}", f"{pressure:g}", *cells))
    show(("q₀L/2π", "θ", "p/(E*h′/2)", "area", "edge flow: error of the area", "of ū/h_rms"), rows)


def law_and_grid(modes: tuple[float, float, float], adhesion: float) -> tuple[LennardJones104, int]:
    """Return the law of a relative adhesion θ, and points a side of a grid that resolves its process zone."""
    spectrum = spectrum_of_modes(HURST, HEIGHT, modes, (SIZE, SIZE))
    work = adhesion * float(spectrum.full_contact_energy(HalfSpace(MODULUS).stiffness))
    length = float(tabor_parameter(2 / spectrum.rms_laplacian, MODULUS, work, 1.0)) / TABOR
    law = LennardJones104(work, length)
    return law, resolving_shape((SIZE, SIZE), min(process_zone(MODULUS, law), SIZE / modes[-1]))[0]


def simulated(surface: Surface, law: LennardJones104, pressures: list[float]) -> list[tuple[float, float]]:
    """Return area, and mean gap over the rms height, by pressure."""
    found = []
    for state in walk(rough_contact(surface.sampled, SIZE, MODULUS, law), pressures):
        area = float(np.mean(state.gap < law.contact_distance))
        found.append((area, (float(state.gap.mean()) - law.equilibrium_distance) / HEIGHT))
    return found


def of_edge_flow(surface: Surface, law: LennardJones104, pressures: list[float]) -> list[tuple[float, float]]:
    flow = edge_flow(surface.measured_spectrum(), MODULUS, law, 1.1 * max(pressures))
    states = [flow.at_pressure(pressure) for pressure in pressures]
    return [
        (state.fraction_below(law.contact_distance), (state.mean_gap - law.equilibrium_distance) / HEIGHT)
        for state in states
    ]


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
