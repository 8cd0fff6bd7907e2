"""The edge flow against simulated contacts without adhesion, beside Persson's theory and its corrections, as Markdown.

The edge flow has no wall. A soft repulsion of finite reach stands for it, in contact where it repels; area and mean gap
are extrapolated linearly from two lengths of it to none. The simulated area is corrected for its edge cells.

python -m scripts.validate_edge_flow
"""

import argparse
import sys
from typing import NamedTuple

import numpy as np

from bem_adhesion import HardWall, rough_contact
from contact_study.physics.laws import Repulsive
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.observables import corrected_area
from scripts.harness import Option, program, rough_surface, show, walk
from theory import NonAdhesiveTheory, edge_flow
from theory.non_adhesive.corrections import CORRECTIONS

SIZE, HEIGHT, MODULUS = 1e-6, 1e-9, 1e9  # m, m, Pa
SPECTRA = tuple((hurst, 64 // roll_off, roll_off) for hurst in (0.2, 0.5, 0.8) for roll_off in (16, 4))
CUTOFF = 64  # waves a side of the shortest wave
PRESSURES = 0.03, 0.1, 0.3, 0.6  # over the modulus times the rms slope
REACHES = 0.1, 0.2  # of the repulsion, over the rms height
STIFF = 2.0  # strength of the repulsion: pressure at half its reach is about that of full contact


class Contact(NamedTuple):
    """Area over the nominal one, and mean gap over the rms height."""

    area: float
    gap: float


def run(given: argparse.Namespace) -> None:
    """Print κ = A E* h'/p at light load by spectrum, then errors of area and gap up to nearly full contact."""
    kappas, errors = [], []
    for hurst, ratio, roll_off in SPECTRA:
        simulated: list[list[Contact]] = []
        by_theory: list[list[list[Contact]]] = []
        for seed in range(1, given.surfaces + 1):
            keys = {"hurst_exponent": hurst, "roll_off_mode": roll_off, "cutoff_mode": CUTOFF, "seed": seed}
            surface = rough_surface(SIZE, given.points, HEIGHT, **keys)
            pressures = [share * MODULUS * surface.rms_slope for share in PRESSURES]
            simulated.append(of_simulation(surface, pressures))
            corrected = [of_correction(surface, name, pressures) for name in CORRECTIONS]
            by_theory.append([of_edge_flow(surface, pressures), *corrected])
        truth, found = np.mean(simulated, axis=0), np.mean(by_theory, axis=0)
        shown = (f"{areas[0] / PRESSURES[0]:.2f}" for areas in (truth[:, 0], *found[..., 0]))
        kappas.append((f"{hurst:g}", ratio, *shown))
        errors.append(np.stack([found[..., 0] / truth[:, 0] - 1, found[..., 1] - truth[:, 1]], axis=-1))
    names = ["edge flow", *(name.replace("_", "–") for name in CORRECTIONS)]
    show(("H", "q₁/q₀", "κ simulated", *names), kappas)
    print()
    rows = []
    for name, error in zip(names, np.abs(np.moveaxis(errors, 1, 0)), strict=True):
        areas = "/".join(f"{100 * one:.0f}" for one in error[..., 0].max(axis=0))
        rows.append((name, f"{100 * error[..., 0].mean():.1f} %", f"{areas} %", *_sizes(error[..., 1])))
    loads = "/".join(f"{share:g}" for share in PRESSURES)
    show(("theory", "area: mean size", f"worst at p/E*h′ = {loads}", "ū/h_rms: mean size", "worst"), rows)


def _sizes(errors: np.ndarray) -> tuple[str, str]:
    return f"{errors.mean():.3f}", f"{errors.max():.3f}"


def of_simulation(surface: Surface, pressures: list[float]) -> list[Contact]:
    contact = rough_contact(surface.sampled, SIZE, MODULUS, HardWall())
    found = []
    for state in walk(contact, pressures):
        found.append(Contact(corrected_area(state.pressure > 0), float(state.gap.mean()) / HEIGHT))
    return found


def of_edge_flow(surface: Surface, pressures: list[float]) -> list[Contact]:
    near, far = (soft(surface, reach * HEIGHT, pressures) for reach in REACHES)
    share = REACHES[0] / (REACHES[1] - REACHES[0])
    return [Contact(*(np.array(one) + share * (np.array(one) - other))) for one, other in zip(near, far, strict=True)]


def soft(surface: Surface, reach: float, pressures: list[float]) -> list[Contact]:
    """Contacts of the edge flow with a repulsion of a reach (m)."""
    law = Repulsive(0.0, reach, repulsion=STIFF * MODULUS * surface.rms_slope * reach)
    flow = edge_flow(surface.measured_spectrum(), MODULUS, law, 1.1 * max(pressures))
    states = [flow.at_pressure(pressure) for pressure in pressures]
    return [Contact(state.fraction_below(reach), (state.mean_gap - reach) / HEIGHT) for state in states]


def of_correction(surface: Surface, name: str, pressures: list[float]) -> list[Contact]:
    theory = NonAdhesiveTheory(surface.measured_spectrum(), MODULUS, name)
    states = [theory.at_pressure(pressure) for pressure in pressures]
    return [Contact(state.relative_contact_area, state.mean_gap / HEIGHT) for state in states]


main = program(
    run,
    Option("--points", 512, "of the grid along a side"),
    Option("--surfaces", 2, "of each spectrum"),
)

if __name__ == "__main__":
    sys.exit(main())
