"""Processor time of starting up and of small whole commands, as a Markdown table: the least of several runs.

The help of each command, importing the library, a study of 32² points under one load with compiled kernels and with
none, and all theories at 3 adhesion strengths and 60 pressures. A first run of each, which may compile, does not count.

    python -m scripts.benchmark_startup
    python -m scripts.benchmark_startup --repeat 1 --only help
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import tomli_w

from scripts.benchmark_storage import many_points
from scripts.harness import PAPER, Option, children_time, program, show

COMMANDS = ("bem-adhesion", "md-reference", "persson-theory", "contact-compare", "contact-merge")
SMALL = ["--surface.shape", "32, 32", "--interaction.well_depth_ratio", "1", "--loading.path", "1 GPa"]


def works(folder: Path) -> Iterator[tuple[str, Sequence[str], Mapping[str, str]]]:
    """Words, command and variables of what is timed."""
    programs = {name: str(Path(sys.executable).with_name(name)) for name in COMMANDS}
    for name, path in programs.items():
        yield f"`{name} --help`", [path, "--help"], {}
    yield "`import bem_adhesion`", [sys.executable, "-c", "import bem_adhesion"], {}
    out = ["-o", str(folder / "out.nc"), "--overwrite", "--workers", "1"]
    small = [programs["bem-adhesion"], str(PAPER), *SMALL, *out]
    yield "a study of 32² points, one load", small, {}
    yield "the same, nothing compiled", small, {"NUMBA_CACHE_DIR": "empty"}
    theories = folder / "theories.toml"
    theories.write_text(tomli_w.dumps(many_points(PAPER).table))
    yield "all theories, 3 strengths × 60 pressures", [programs["persson-theory"], str(theories), *out], {}


def seconds(command: Sequence[str], variables: Mapping[str, str], repeat: int) -> float:
    """Least processor time of a command and its children (s)."""
    found = []
    for _ in range(repeat + (not variables)):
        with tempfile.TemporaryDirectory() as empty:
            fresh = dict.fromkeys(variables, empty)
            before = children_time()
            subprocess.run(command, env=os.environ | fresh, capture_output=True, check=True)
            found.append(children_time() - before)
    return min(found[not variables :])


def run(given: argparse.Namespace) -> None:
    with tempfile.TemporaryDirectory() as name:
        chosen = [work for work in works(Path(name)) if given.only in work[0]]
        times = ((words, f"{seconds(command, more, given.repeat):.2f}") for words, command, more in chosen)
        show(("what", "processor time (s)"), times)


main = program(
    run, Option("--repeat", 3, "runs of each, the least is shown"), Option("--only", "", "works that have these words")
)


if __name__ == "__main__":
    sys.exit(main())
