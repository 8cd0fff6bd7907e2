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
import multiprocessing
import resource
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bem_adhesion import HardWall, rough_contact
from contact_study.campaign.memory import require_memory
from contact_study.study.case import Case, realise
from contact_study.study.study import read_study

STUDY = Path(__file__).resolve().parent.parent / "data" / "yang2008.toml"
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
    (whole, *_) = read_study(STUDY, changes).cases
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
    held = _peak()
    contact = rough_contact(height, *given)
    began, state, found = time.process_time(), contact.separated(), []
    for pressure in PRESSURES:
        solution = contact.step(state, pressure)
        touching = law.in_contact(solution.gap, solution.pressure, case.contact_distance)
        state, area = solution.state, float(np.mean(touching))
        found.append((solution.fft_pairs, solution.converged))
        del solution, touching  # a path goes on from the state alone
    seconds, held = time.process_time() - began, _peak() - held
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


def _peak() -> float:
    """Largest memory of this process so far (bytes).

    Of ``getrusage`` it would be at least what the parent held when this process was made.
    """
    status = Path("/proc/self/status")
    if not status.exists():  # not Linux
        return 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    (line,) = [line for line in status.read_text().splitlines() if line.startswith("VmHWM:")]
    return 1024.0 * float(line.split()[1])


def rows(table: pd.DataFrame) -> list[str]:
    """The table's lines."""
    lines = ["| | points | A/A₀ at 1 GPa | first | second | second anew | bytes a point | s |", "|---" * 8 + "|"]
    for row in table.itertuples():
        flag = "" if row.converged else " (not converged)"
        lines.append(
            f"| {row.kind} | {row.points}² | {row.area:.5f} | {row.first:.0f} | {row.second:.0f}{flag} "
            f"| {row.anew:.0f} | {row.bytes:.0f} | {row.seconds:.3g} |"
        )
    return lines


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--points", type=int, nargs="+", default=[256, 512, 1024], help="points along each side")
    made.add_argument("--only", default="", metavar="WORDS", help="kinds that have these words")
    made.add_argument("--table", type=Path, help="CSV to write the rows to")
    made.add_argument("--from", type=Path, dest="source", help="CSV to read them from, in place of a run")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    given = parser().parse_args(arguments)
    found = pd.read_csv(given.source) if given.source is not None else run(given)
    print("\n".join(rows(found)))
    return 0


def run(given: argparse.Namespace) -> pd.DataFrame:
    """Every kind on every grid; the file is written after each."""
    require_memory(max(given.points) ** 2 * BYTES_PER_POINT, f"--points {max(given.points)}", "fewer points")
    found = []
    with tempfile.TemporaryDirectory() as folder:
        heights = Path(folder) / "heights.npy"
        for kind in KINDS:
            for points in given.points:
                if given.only not in kind:
                    continue
                np.save(heights, realise(case_of(kind, points)).sampled)
                # A process that is new has held nothing yet.
                with multiprocessing.get_context("spawn").Pool(1) as pool:
                    found.append(pool.apply(cost, (kind, points, heights)))
                print(found[-1], file=sys.stderr, flush=True)
                if given.table is not None:
                    pd.DataFrame(found).to_csv(given.table, index=False, float_format="%.6g")
    return pd.DataFrame(found)


if __name__ == "__main__":
    sys.exit(main())
