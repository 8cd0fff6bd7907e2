"""What temperature does to the contact: area and mean gap of the atoms at rest and in thermal motion.

`docs/temperature.md` shows the table.

    python scripts/temperature.py data/yang2008.toml --fraction 0.25 --pressures "1 GPa" --temperature "300 K"
"""

import argparse
import copy
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import contact_study
from contact_study.campaign.command import Parser, guarded
from contact_study.problem.errors import InputError
from contact_study.problem.study import Study, read_study

OBSERVABLES = {"relative_contact_area": ("A", 1.0), "mean_gap": ("ū (Å)", 1e-10)}


def main(arguments: Sequence[str] | None = None) -> int:
    return guarded("temperature", lambda: _main(arguments), interrupted="nothing is written")


def parser() -> Parser:
    made = Parser(
        description=__doc__.splitlines()[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter, allow_abbrev=False
    )
    made.add_argument("study", type=Path, help="study with a lattice constant, over interaction.well_depth_ratio")
    made.add_argument("--pressures", nargs="+", default=["1 GPa"], help="points of the path, from separation")
    made.add_argument("--temperature", default="300 K", help="of the atoms that move")
    made.add_argument("--trajectories", type=int, default=150, help="thermal states of each point")
    made.add_argument("--fraction", type=float, default=1.0, help="of the study's lengths: its cell and rms height")
    return made


def _main(arguments: Sequence[str] | None) -> int:
    given = parser().parse_args(arguments)
    table = shrunk(read_study(given.study), given.fraction)
    if "interaction.well_depth_ratio" not in table.get("sweep", {}):
        raise InputError(f"{given.study}: sweeps no interaction.well_depth_ratio")
    cold = contact_study.run(at_rest(table, given.pressures), "atomistic")
    warm = contact_study.run(
        in_motion(at_rest(table, given.pressures), given.temperature, given.trajectories), "atomistic"
    )
    ratios = [f"{ratio:g} ε₀" for ratio in cold.well_depth_ratio.values]
    print("| p (GPa) | | " + " | ".join(ratios) + " |\n" + "|---" * (2 + len(ratios)) + "|")
    for step, pressure in enumerate(cold.applied_pressure.values):
        for name, (symbol, unit) in OBSERVABLES.items():
            rows = {"0 K": cells(cold, name, unit, step), given.temperature: cells(warm, name, unit, step)}
            for temperature, row in rows.items():
                print(f"| {pressure / 1e9:g} | {symbol}, {temperature} | " + " | ".join(row) + " |")
            print(f"| {pressure / 1e9:g} | change | " + " | ".join(changes(cold, warm, name, unit, step)) + " |")
    return 0


def shrunk(study: Study, fraction: float) -> dict[str, Any]:
    """The study with its cell, its grid and its roughness at a fraction of their lengths: its slopes stay."""
    case, table = study.cases[0], copy.deepcopy(dict(study.table))
    if fraction != 1.0:
        surface = case.surface
        if surface.kind != "self_affine":
            raise InputError(f'surface.kind = "{surface.kind}": --fraction is for self-affine surfaces')
        table["surface"] |= {
            "size": [fraction * length for length in surface.size],
            "shape": [round(fraction * points) for points in surface.shape],
            "rms_height": fraction * surface.rms_height,
        }
    return table


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


if __name__ == "__main__":
    sys.exit(main())
