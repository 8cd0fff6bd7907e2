"""What temperature does to the contact, or springs that turn: area and mean gap of two kinds of atoms side by side.

Atoms at rest and in thermal motion; with ``--turning`` the linear explicit block and that of springs that turn with
their atoms, both coming down at one speed and brought to rest by friction. `research/notes/temperature.md` shows the
tables.

    python -m research.temperature data/yang2008.toml --fraction 0.25 --pressures "1 GPa" --temperature "300 K"
    python -m research.temperature data/yang2008.toml --fraction 0.12 --pressures "1 GPa" "10 GPa" --turning
    python -m research.temperature --from results/yang2008-paper/md_0K.nc results/yang2008-paper/md_300K.nc
"""

import argparse
import copy
import sys
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import contact_study
from contact_study.inputs.errors import InputError
from contact_study.study.study import make_study, read_study
from scripts.harness import Option, head, program, shrunk
from scripts.harness import row as markdown_row

# Of atoms that come to rest: what the residual at the end of a point needs to be below 10⁻³ E* at the sizes in use.
AT_REST = {"duration": "50 ps", "damping": "0.3 ps^-1", "approach_speed": "300 m/s", "frames": 4}

OBSERVABLES = {"relative_contact_area": ("A", 1.0), "mean_gap": ("ū (Å)", 1e-10)}


def run(given: argparse.Namespace) -> None:
    if given.source is None:
        if given.study is None:
            raise InputError("STUDY: missing; give a study, or two datasets by --from")
        table = shrunk(read_study(given.study), given.fraction)
        if "interaction.well_depth_ratio" not in table.get("sweep", {}):
            raise InputError(f"{given.study}: sweeps no interaction.well_depth_ratio")
        variants = blocks(table, given.pressures) if given.turning else temperatures(table, given)
    else:
        cold, warm = (xr.load_dataset(path, decode_timedelta=False) for path in given.source)
        variants = {"0 K": cold, _temperature(warm): warm}
    before, after = variants.values()
    ratios = [f"{ratio:g} ε₀" for ratio in before.well_depth_ratio.values]
    print(head("p (GPa)", "", *ratios))
    for step, pressure in enumerate(before.applied_pressure.values):
        rows = []
        for name, (symbol, unit) in OBSERVABLES.items():
            rows += [(f"{symbol}, {word}", cells(dataset, name, unit, step)) for word, dataset in variants.items()]
            rows.append(("change", changes(before, after, name, unit, step)))
        if given.turning:
            moves = largest_move(after.isel(step=step))
            rows.append(("largest lateral move (Å)", [f"{1e10 * move:.2f}" for move in moves]))
            worst = np.maximum(*(dataset.residual.isel(step=step).values for dataset in variants.values()))
            rows.append(("force left over a²E*", [f"{residual:.0e}" for residual in worst]))
        for words, row in rows:
            print(markdown_row(f"{pressure / 1e9:g}", words, *row))


def _temperature(dataset: xr.Dataset) -> str:
    """That a run was asked for, in K."""
    given = make_study(tomllib.loads(dataset.attrs["study_toml"])).cases[0].atomistic.temperature
    return f"{given:g} K"


def temperatures(table: Mapping[str, Any], given: argparse.Namespace) -> dict[str, xr.Dataset]:
    """Atoms at rest, and at a temperature."""
    still = at_rest(table, given.pressures)
    cold = contact_study.run(still, "atomistic")
    return {
        "0 K": cold,
        given.temperature: contact_study.run(in_motion(still, given.temperature, given.trajectories), "atomistic"),
    }


def blocks(table: Mapping[str, Any], pressures: Sequence[str]) -> dict[str, xr.Dataset]:
    """The linear explicit block, and that of turning springs."""
    still = {**at_rest(table, pressures), "dynamics": AT_REST, "output": {"atoms": "surface"}}
    found = {}
    for word, block in (("linear", "isotropic"), ("turning", "nonlinear_springs")):
        atomistic = {**table.get("atomistic", {}), "method": "dynamics", "block": block}
        found[word] = contact_study.run({**still, "atomistic": atomistic}, "atomistic", workers=1)
    return found


def largest_move(states: xr.Dataset) -> np.ndarray:
    """Largest lateral displacement of an atom of each case, against the mean of all (m)."""
    moves = [states[f"lateral_displacement_{axis}"] for axis in "xy"]
    squares = sum((move - move.mean(["y", "x"])) ** 2 for move in moves)
    return np.sqrt(squares.max(["y", "x"])).values


def at_rest(table: Mapping[str, Any], pressures: Sequence[str]) -> dict[str, Any]:
    """The study at these pressures, without exceptions and fields."""
    changed = copy.deepcopy({section: content for section, content in table.items() if section != "override"})
    changed["loading"] = {"path": list(pressures)}
    changed["output"] = {}
    return changed


def in_motion(table: Mapping[str, Any], temperature: str, trajectories: int) -> dict[str, Any]:
    """The same at a temperature."""
    atomistic = {**table.get("atomistic", {}), "method": "sampling", "temperature": temperature}
    return {**table, "atomistic": atomistic, "sampling": {"trajectories": trajectories}}


def cells(dataset: xr.Dataset, name: str, unit: float, step: int) -> list[str]:
    """The values over the swept ratio, with their standard errors where they have some."""
    values = dataset[name].isel(step=step).values / unit
    if f"{name}_standard_error" not in dataset:
        return [f"{value:.4f}" for value in values]
    errors = dataset[f"{name}_standard_error"].isel(step=step).values / unit
    return [f"{value:.4f} ± {error:.4f}" for value, error in zip(values, errors, strict=True)]


def changes(cold: xr.Dataset, warm: xr.Dataset, name: str, unit: float, step: int) -> list[str]:
    """By how much the moving atoms differ: the area in per cent, the gap in its unit."""
    before, after = (dataset[name].isel(step=step).values for dataset in (cold, warm))
    if unit == 1.0:
        return [f"{change:+.1f} %" for change in 100 * (after / before - 1)]
    return [f"{change:+.3f}" for change in (np.asarray(after) - before) / unit]


main = program(
    run,
    Option("study", Path, "study with a lattice constant, over its well_depth_ratio", nargs="?"),
    Option("--pressures", ["1 GPa"], "points of the path, from separation"),
    Option("--temperature", "300 K", "of the atoms that move"),
    Option("--trajectories", 150, "thermal states of each point"),
    Option("--fraction", 1.0, "of the study's lengths: its cell and rms height"),
    Option("--from", Path, "datasets to print, without a run", nargs=2, metavar=("COLD", "WARM")),
    Option("--turning", False, "compare blocks, at zero temperature"),
)

if __name__ == "__main__":
    sys.exit(main())
