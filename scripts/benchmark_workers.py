"""Cases of a study on two workers against one: how much sooner they are done, and what that costs.

Whole commands of the project, interleaved; medians. The first ratio is 2 at best, less what a command does before and
after its cases; the second is 1 where no process waits for another in a busy loop. Every worker solves with one thread.
Options of the command follow the study.

    python -m scripts.benchmark_workers data/yang2008.toml --surface.seed 1,2,3,4
    python -m scripts.benchmark_workers --model atoms data/yang2008_quick.toml
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from scripts.harness import RUN, Option, children_time, program, show


def run(options: argparse.Namespace) -> None:
    command = [*RUN, str(options.study), "--model", options.model, *options.keys]
    (alone, of_one), (together, of_two) = measured(
        [*command, "--output.fields", "false", "--solver.threads", "1"], options.repeats
    )
    heads = ("", "one worker", "time of one over that of two", "processor time of two over that of one")
    show(heads, [(options.model, f"{alone:.0f} s", f"{alone / together:.2f}", f"{of_two / of_one:.2f}")])


def measured(command: Sequence[str], repeats: int) -> list[tuple[float, float]]:
    """Medians of time and processor time (s), of one worker and of two; a first run of each does not count."""
    found: dict[int, list[tuple[float, float]]] = {1: [], 2: []}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(repeats + 1):
            for workers, times in found.items():
                output = ["-o", str(Path(folder) / "out.nc"), "--overwrite", "--workers", str(workers)]
                before, began = children_time(), time.perf_counter()
                subprocess.run([*command, *output], capture_output=True, check=True)
                times.append((time.perf_counter() - began, children_time() - before))
    return [(statistics.median(t for t, _ in of[1:]), statistics.median(c for _, c in of[1:])) for of in found.values()]


main = program(
    run,
    Option("--model", "continuum", "", choices=("continuum", "atoms", "theory")),
    Option("--repeats", 3, "runs of each (default 3)"),
    Option("study", Path, "a study of several cases"),
    Option("keys", str, "options of the command", nargs=argparse.REMAINDER, metavar="--section.key VALUE"),
)

if __name__ == "__main__":
    sys.exit(main())
