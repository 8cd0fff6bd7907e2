"""Short-ranged adhesion outside a wall from two starts: one state, or two, as a Markdown table.

The case of R. Bugnicourt et al., Tribol. Lett. 66, 29 (2018), doi:10.1007/s11249-017-0980-z, as the tests of the code
Adhesion set it up (long_tests/test_bugnicourt_bench_reduced.py): a cell of 4 µm, H = 0.8, waves from 1 µm to 0.1 µm, a
rms radius of curvature of 60 nm, E* = 25 MPa, Δγ = 5 mJ/m², attraction (Δγ/ρ) exp(−u/ρ) of a Tabor parameter of 3, and
a load under which about a fifth touches. The process zone is half a spacing at 2048²: edges are held by the points,
there are many states, and two minimisers that converge need not agree. From separation the surfaces approach; from the
hard wall the state begins as that of the same load without adhesion.

    python -m research.two_starts_with_adhesion --points 512 1024
    python -m research.two_starts_with_adhesion --points 2048     # two minutes
"""

import argparse
import sys

import numpy as np

from bem_adhesion import Exponential, HardWall, rough_contact
from scripts.harness import Option, head, program, rough_surface, row

CELL, RADIUS, MODULUS, WORK, TABOR = 4e-6, 60e-9, 25e6, 5e-3, 3.0
LONGEST, SHORTEST = 4, 40  # waves to the cell
PRESSURE = 0.075 * MODULUS
# Opening of the hard wall's gaps where it begins, over ρ: none may be shut but those that touch.
OPENING = 1e-3


def surface(points: int, seed: int) -> np.ndarray:
    """Heights (m) whose curvature, half the Laplacian, is 1/RADIUS in the mean square."""
    waves = {"roll_off_mode": LONGEST, "low_mode": LONGEST, "cutoff_mode": SHORTEST}
    height = rough_surface(CELL, points, 50e-9, seed=seed, **waves).sampled
    return height / (rms_curvature(height) * RADIUS)


def rms_curvature(height: np.ndarray) -> float:
    """Half the Laplacian in the mean square (1/m)."""
    points = len(height)
    q = 2 * np.pi / CELL * np.hypot(np.fft.fftfreq(points, 1 / points)[:, None], np.arange(points // 2 + 1))
    return float(np.std(np.fft.irfft2(q**2 * np.fft.rfft2(height), s=height.shape))) / 2


def run(given: argparse.Namespace) -> int:
    length = (RADIUS * (WORK / MODULUS) ** 2) ** (1 / 3) / TABOR
    law = Exponential(WORK, length)
    print(head("points", "per zone", "start", "A/A₀", "without adhesion", "energy (mJ/m²)", "residual", "pairs"))
    failed = 0
    for points in given.points:
        height = surface(points, given.seed)
        hard = rough_contact(height, CELL, MODULUS, HardWall())
        bare = hard.step(hard.separated(), PRESSURE)
        contact = rough_contact(height, CELL, MODULUS, law)
        opened = height + np.where(bare.gap > 0, bare.gap + OPENING * length, 0.0)
        zone = MODULUS * length**2 / WORK * points / CELL
        for start, state in (("separation", contact.separated()), ("the hard wall", opened)):
            found = contact.step(state, PRESSURE)
            failed += not found.converged
            energy = found.elastic_energy + found.interaction_energy + PRESSURE * float(np.mean(found.gap))
            area, bare_area = np.mean(found.gap == 0), np.mean(bare.pressure > 0)
            cells = f"{area:.4f}", f"{bare_area:.4f}", f"{1e3 * energy:.4f}", f"{found.residual:.0e}"
            print(row(f"{points}²", f"{zone:.2g}", start, *cells, f"{found.fft_pairs:.0f}"), flush=True)
    return 2 if failed else 0


main = program(run, Option("--points", [512], "points along each side"), Option("--seed", 1, "sample of the recipe"))

if __name__ == "__main__":
    sys.exit(main())
