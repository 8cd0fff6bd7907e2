"""A large block in motion, stopped on its way and gone on with: cost, memory, and whether the bits are the same.

The study's block of `--atoms` a side comes down at 300 m/s for `--frames` times `--steps` steps: once in one go, once
interrupted as by Ctrl-C, after what is put aside every half minute, and resumed. `research/notes/temperature.md` has
the table.

    python -m research.stopped_motion data/yang2008.toml --atoms 400
"""

import argparse
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import tomli_w
import xarray as xr

from contact_study.study.study import Study, make_study, read_study
from md_reference.study.dynamics import build_block, time_step
from scripts.harness import RUN, Option, program, show, shrunk

_LONG = 10**5  # time steps of a long run
_OF_THE_RUN = ("wall_time",)  # differs from run to run, as nothing else may


def run(given: argparse.Namespace) -> int:
    table = motion_of(read_study(given.study), given.atoms)
    case = make_study(table).cases[0]
    table["dynamics"] |= {"frames": given.frames, "duration": 1.001 * given.frames * given.steps * time_step(case)}
    block = build_block(case)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        study = folder / "study.toml"
        study.write_text(tomli_w.dumps(table), encoding="utf-8")
        command = [*RUN, str(study), "--model", "atoms", "-o"]
        run_quietly([*command, str(folder / "whole.nc")])
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = stopped([*command, str(folder / "stopped.nc")], folder)
        run_quietly([*command, str(folder / "stopped.nc"), "--resume"])
        same = identical(folder / "whole.nc", folder / "stopped.nc")
    steps, memory = given.frames * given.steps, 1024 * used.ru_maxrss / (block.freedoms / 3)
    hours = used.ru_utime / steps * _LONG / 3600
    heads = "atoms", "nodes that move", "steps", "s a step", "hours for 10⁵", "bytes a node, of the whole process"
    costs = steps, f"{used.ru_utime / steps:.2f}", f"{hours:.1f}", f"{memory:.0f}"
    bits = "the same bits" if same else "other bits"
    show((*heads, "stopped", "resumed"), [(f"{given.atoms}²", block.freedoms // 3, *costs, done, bits)])
    return 0 if same else 1


def motion_of(whole: Study, atoms: int) -> dict[str, Any]:
    """The study's first case with so many atoms a side, in motion."""
    case = whole.cases[0]
    constant = case.material.lattice_constant
    table = shrunk(whole, atoms * constant / case.surface.size[0])
    table = {name: content for name, content in table.items() if name not in ("override", "sweep")}
    table["surface"] |= {"size": atoms * constant, "shape": [atoms, atoms]}
    return {
        **table,
        "loading": {"path": ["1 GPa"]},
        "atomistic": {"method": "dynamics", "temperature": "300 K"},
        "dynamics": {"damping": "0.1 ps^-1", "approach_speed": "300 m/s"},
        "output": {},
    }


def run_quietly(command: Sequence[str]) -> None:
    """Run a command of the project quietly; a step that is still moving is no failure."""
    status = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    if status.returncode not in (0, 2):
        raise RuntimeError(status.stderr)


def stopped(command: Sequence[str], folder: Path) -> str:
    """Interrupt a command once a part of its only point is on disk; what was done by then."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None:
        if list(folder.rglob("partial-*.npz")):
            process.send_signal(signal.SIGINT)
            process.wait()
            return "within the point"
        time.sleep(0.2)
    return "not before it ended"


def identical(one: Path, other: Path) -> bool:
    """Whether two datasets hold the same bits, but for the time they took."""
    with (
        xr.open_datatree(one, decode_timedelta=False) as first,
        xr.open_datatree(other, decode_timedelta=False) as second,
    ):
        return set(first.groups) == set(second.groups) and all(
            _same(first[group].to_dataset(), second[group].to_dataset()) for group in first.groups
        )


def _same(one: Mapping[str, xr.DataArray], other: Mapping[str, xr.DataArray]) -> bool:
    names = [name for name in one.variables if name not in _OF_THE_RUN]
    return set(one.variables) == set(other.variables) and all(one[name].identical(other[name]) for name in names)


main = program(
    run,
    Option("study", Path, "study of a self-affine surface with lattice constant and atom mass"),
    Option("--atoms", 400, "of the block along each side, at the study's slopes"),
    Option("--frames", 20, "states that are looked at"),
    Option("--steps", 10, "time steps from one to the next"),
)

if __name__ == "__main__":
    sys.exit(main())
