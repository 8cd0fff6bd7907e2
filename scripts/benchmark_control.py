"""Work of adhesive load steps at a given gap or approach beside those at a given pressure, as a Markdown table.

For each grid and adhesion: median transform pairs of a load step (as float64 pairs on the finest grid) through the
paper's pressures, then to the same states under another control: their mean gaps, the approaches of a layer a quarter
of the cell thick or of a half-space with free boundaries, or the far end of a spring a hundredth, once and a hundred
times as stiff as the contact midway. The ratio is that of the sums over the path. Strong adhesion jumps at other loads
under each control.

``--curve`` measures a force curve in place of that: a sphere with self-affine roughness on a half-space with free
boundaries, from out of reach into contact and off again, in so many adaptive load steps at given approaches.

    python -m scripts.benchmark_control --points 256 512 --surfaces 2
    python -m scripts.benchmark_control --points 512 --curve 100
"""

import argparse
import sys
import time
from collections.abc import Iterator
from itertools import product

import numpy as np

from bem_adhesion import HalfSpace, LennardJones104, rough_contact
from bem_adhesion.contacts.rough_contact import contact_between
from bem_adhesion.solution import Solution
from bem_adhesion.study.adaptive import adaptive_step, ledger_of
from contact_study.physics.solids import Elasticity, Layer
from contact_study.physics.spheres.numbers import tabor_parameter
from contact_study.study.case import Case, realise
from scripts.benchmark_adhesive import PRESSURES, one_case
from scripts.harness import PAPER, Option, program, rough_surface, show, walk

THICKNESS = 0.25  # of the layer, over the cell
SPRINGS = {"soft spring": 0.01, "matched spring": 1.0, "stiff spring": 100.0}  # over the contact's midway
CONTROLS = {"periodic": ("gap", "approach", *SPRINGS), "free": ("approach", *SPRINGS)}
# Radius, cell, E*, work of adhesion, range and rms roughness of the sphere's curve, and its ends (SI).
RADIUS, CELL, MODULUS, WORK, RANGE, ROUGHNESS = 1e-6, 0.4e-6, 3e9, 0.05, 3e-9, 0.5e-9
OUT, IN, OFF = -2e-9, 6e-9, -12e-9
LEAST_STEP = 1e-3  # over the longer way
NOISE = 1e-6  # of the work of a step, over the work of adhesion


def position(found: Solution, control: str, solid: Elasticity, top: float, compliance: float) -> float:
    """The gap of a state at a given pressure, or its approach behind a spring of a compliance per area (m)."""
    if control == "gap":
        return found.mean_gap
    pressure, plane = float(found.pressure.mean()), found.plane
    if plane is None:
        plane = float(found.displacement.mean()) - solid.compression(pressure)
    return top + found.law.equilibrium_distance - plane + pressure * compliance


def pairs_by_control(case: Case, boundary: str, control: str) -> tuple[list[float], list[float]]:
    """Pairs of each step at given pressures, and at the gaps or approaches of their states."""
    surface, modulus = realise(case), case.material.contact_modulus
    layer = Layer(modulus, case.material.poissons_ratio, THICKNESS * max(surface.size))
    solid = layer if boundary == "periodic" and control == "approach" else HalfSpace(modulus)
    given = surface.sampled, surface.grid, solid, case.law, boundary
    contact = contact_between(*given)
    pressed = list(walk(contact, PRESSURES))
    compliance = 0.0
    if control in SPRINGS:
        compliance = 1 / (SPRINGS[control] * contact.stiffness(pressed[len(pressed) // 2]))
    targets = [position(each, control, solid, float(surface.sampled.max()), compliance) for each in pressed]
    kind = "gap" if control == "gap" else "approach"
    moved = list(walk(contact_between(*given, control=kind, machine_compliance=compliance), targets))
    if not all(each.converged for each in (*pressed, *moved)):
        raise RuntimeError("a load step did not converge")
    return [each.fft_pairs for each in pressed], [each.fft_pairs for each in moved]


def rows(given: argparse.Namespace) -> Iterator[tuple[object, ...]]:
    """Lines of the table of controls."""
    for points, ratio in product(given.points, given.ratios):
        cases = [one_case(PAPER, points, seed, ratio) for seed in range(1, given.surfaces + 1)]
        for boundary, control in ((name, each) for name in CONTROLS for each in CONTROLS[name]):
            found = [pairs_by_control(case, boundary, control) for case in cases]
            pressed, moved = (np.array(part) for part in zip(*found, strict=True))
            medians = (f"{np.median(part):.0f}" for part in (pressed, moved))
            yield f"{points}²", boundary, f"{ratio:g} ε₀", control, *medians, f"{moved.sum() / pressed.sum():.2f}"


def curve(points: int, steps: int) -> tuple[object, ...]:
    """The line of a force curve in so many load steps."""
    solid, law = HalfSpace(MODULUS), LennardJones104(work_of_adhesion=WORK, length=RANGE)
    x = (np.arange(points) + 0.5) * CELL / points - CELL / 2
    height = rough_surface(CELL, points, ROUGHNESS, roll_off_mode=4, cutoff_mode=32).sampled
    height = height - (x[:, None] ** 2 + x**2) / (2 * RADIUS)
    contact = rough_contact(height, CELL, solid, law, control="approach", boundary="free")
    first, *approaches = (*np.linspace(OUT, IN, steps // 2), *np.linspace(IN, OFF, steps - steps // 2 + 1)[1:])
    began = time.process_time()
    found = contact.step(contact.separated(), float(first))
    pairs, ledger, forces = found.fft_pairs, ledger_of(found, float(first), solid), [float(found.pressure.mean())]
    for approach in approaches:
        least, noise = LEAST_STEP * (IN - OFF), NOISE * WORK
        found, (*_, ledger) = adaptive_step(contact, found.state, ledger, float(approach), least, solid, noise)
        if not found.converged:
            raise RuntimeError(found.message)
        pairs += found.fft_pairs
        forces.append(float(found.pressure.mean()))
    seconds = time.process_time() - began
    pull_off = -min(forces) * CELL**2 / (1.5 * np.pi * RADIUS * WORK)
    tabor = tabor_parameter(RADIUS, MODULUS, WORK, RANGE)
    return f"{points}²", f"{tabor:.2f}", steps, f"{pairs:.0f}", f"{seconds:.0f}", f"{pull_off:.3f}"


def run(given: argparse.Namespace) -> None:
    if given.curve:
        names = ("points", "Tabor parameter", "load steps", "pairs", "s", "pull-off force / (3/2)πRw")
        show(names, (curve(points, given.curve) for points in given.points))
    else:
        show(("points", "boundary", "adhesion", "control", "pairs at a pressure", "pairs at it", "ratio"), rows(given))


main = program(
    run,
    Option("--points", [256, 512], "points along each side"),
    Option("--surfaces", 2, "surfaces of each grid; seeds from 1"),
    Option("--ratios", [1.0, 4.0], "multiples of the well depth"),
    Option("--curve", 0, "load steps of a sphere's force curve, in place of the controls"),
)

if __name__ == "__main__":
    sys.exit(main())
