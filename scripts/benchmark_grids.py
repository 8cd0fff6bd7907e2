"""Work and memory of the continuum solvers as the grid is refined, as a Markdown table.

One surface of the paper's kind, 104 nm, under 0.5 GPa and then 1 GPa: on a hard wall with the paper's twelve waves
(smooth) and with a shortest wave of eight points, another surface on every grid (broadband); and under the paper's
adhesion. "first" and "second" are transform pairs of the two steps, as float64 pairs on that grid; "second anew" those
of 1 GPa from separation; A/A₀ is the contact area as in datasets; the memory is the largest of a process less what it
held with the heights alone, in bytes a point (8 are one array), the fields of one solution and the state it starts from
in it. Each line is a process of its own.

    python -m scripts.benchmark_grids --points 256 512 1024
    python -m scripts.benchmark_grids --points 256 512 1024 2048 4096 --table data/benchmark_grids.csv
    python -m scripts.benchmark_grids --points 8192 --table more.csv     # 9 GB, ten minutes
    python -m scripts.benchmark_grids --from data/benchmark_grids.csv
"""

import argparse
import itertools
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd

from bem_adhesion import HardWall, rough_contact
from contact_study.campaign.memory import Need, require
from contact_study.study.case import Case, realise
from contact_study.study.study import read_study
from scripts.harness import PAPER, Option, head, peak_memory, tabulated
from scripts.harness import row as markdown_row

PRESSURES = (0.5e9, 1e9)
POINTS_PER_WAVE = 8  # the shortest of the broadband surface
KINDS = ("hard wall, smooth", "hard wall, broadband", "adhesion, smooth")
BYTES_PER_POINT = 130
SMALL = 64  # points of a first solve


def case_of(kind: str, points: int) -> Case:
    """The study's first case on another grid, with the kind's waves and law."""
    changes: dict[str, object] = {"surface.shape": [points, points]}
    if kind.endswith("broadband"):
        changes["surface.cutoff_mode"] = points // POINTS_PER_WAVE
    (whole, *_) = read_study(PAPER, changes).cases
    return whole


def cost(kind: str, points: int, heights: Path) -> dict[str, str | float]:
    """Pairs and memory of one kind on one grid; to be called in a process of its own."""
    case = case_of(kind, points)
    height = np.load(heights)
    law = HardWall() if kind.startswith("hard wall") else case.law
    given = case.surface.size, case.material.contact_modulus, law
    every = points // SMALL
    small = rough_contact(np.ascontiguousarray(height[::every, ::every]), *given)
    small.step(small.separated(), PRESSURES[0])  # compiles
    held = peak_memory()
    contact = rough_contact(height, *given)
    began, state, found = time.process_time(), contact.separated(), []
    for pressure in PRESSURES:
        solution = contact.step(state, pressure)
        touching = law.in_contact(solution.gap, solution.pressure, case.contact_distance)
        state, area = solution.state, float(np.mean(touching))
        found.append((solution.fft_pairs, solution.converged))
        del solution, touching  # a path goes on from the state alone
    seconds, held = time.process_time() - began, peak_memory() - held
    del state
    anew = contact.step(contact.separated(), PRESSURES[-1])
    return {
        "kind": kind,
        "points": points,
        "first": found[0][0],
        "second": found[1][0],
        "anew": anew.fft_pairs,
        "area": area,
        "converged": all(converged for _, converged in found) and anew.converged,
        "bytes": held / points**2,
        "seconds": seconds,
    }


def rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines."""
    yield head("", "points", "A/A₀ at 1 GPa", "first", "second", "second anew", "bytes a point", "s")
    for row in table.itertuples():
        flag = "" if row.converged else " (not converged)"
        work = f"{row.first:.0f}", f"{row.second:.0f}{flag}", f"{row.anew:.0f}"
        yield markdown_row(
            row.kind, f"{row.points}²", f"{row.area:.5f}", *work, f"{row.bytes:.0f}", f"{row.seconds:.3g}"
        )


def measured(given: argparse.Namespace) -> Iterator[dict[str, str | float]]:
    """Every kind on every grid."""
    require(Need(max(given.points) ** 2 * BYTES_PER_POINT, f"--points {max(given.points)}", "fewer points"))
    with tempfile.TemporaryDirectory() as folder:
        heights = Path(folder) / "heights.npy"
        for kind, points in itertools.product(KINDS, given.points):
            if given.only in kind:
                np.save(heights, realise(case_of(kind, points)).sampled)
                # A process that is new has held nothing yet.
                with multiprocessing.get_context("spawn").Pool(1) as pool:
                    yield pool.apply(cost, (kind, points, heights))


main = tabulated(
    measured,
    rows,
    Option("--points", [256, 512, 1024], "points along each side"),
    Option("--only", "", "kinds that have these words", metavar="WORDS"),
)


if __name__ == "__main__":
    sys.exit(main())
