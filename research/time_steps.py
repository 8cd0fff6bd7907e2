"""What the time step of atoms in motion does to their temperature, area and mean gap, as a Markdown table.

A study's surface at a fraction of its lengths and its first strength of adhesion, at 300 K under 1 GPa; every mean with
its standard error. A velocity is known at the end of a time step and, half a kick before, in its middle: the dataset's
``temperature`` is that of the middle, its ``kinetic_energy`` that of the end.

    python -m research.time_steps data/yang2008.toml
"""

import argparse
import sys
from pathlib import Path

import xarray as xr
from scipy import constants

import contact_study
from contact_study.study.study import make_study, read_study
from md_reference.study.dynamics import build_block, largest_time_step
from research.temperature import at_rest
from scripts.harness import Option, head, program, row, shrunk

TEMPERATURE = 300.0
MOTION = {"duration": "200 ps", "damping": "0.3 ps^-1", "approach_speed": "300 m/s", "frames": 1200}


def run(given: argparse.Namespace) -> None:
    table = at_rest(shrunk(read_study(given.study), given.fraction), ["1 GPa"])
    table["atomistic"] = {"method": "dynamics", "temperature": TEMPERATURE}
    table["sweep"] = {}
    table["dynamics"] = dict(MOTION)
    case = make_study(table).cases[0]
    # The rigid plane's freedom is in the kinetic energy, too.
    per_kelvin = 0.5 * constants.k * (build_block(case).freedoms + 1) / (case.surface.size[0] * case.surface.size[1])
    print(head("step over the largest", "fs", "T (K)", "T of velocities at the end (K)", "A", "ū (Å)"))
    for share in given.steps:
        step = share * largest_time_step(case)
        found = contact_study.run({**table, "dynamics": {**MOTION, "time_step": step}}, "atomistic").squeeze()
        cells = [
            _cell(found, "temperature", 1.0, 1),
            _cell(found, "kinetic_energy", per_kelvin, 1),
            _cell(found, "relative_contact_area", 1.0, 4),
            _cell(found, "mean_gap", 1e-10, 3),
        ]
        print(row(f"{share:g}", f"{1e15 * step:.1f}", *cells), flush=True)


def _cell(dataset: xr.Dataset, name: str, unit: float, digits: int) -> str:
    value, error = (float(dataset[key]) / unit for key in (name, f"{name}_standard_error"))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


main = program(
    run,
    Option("study", Path, "study with a lattice constant and the mass of its atoms"),
    Option("--fraction", 0.08, "of the study's lengths"),
    Option("--steps", [0.1, 0.2, 0.4], "over the largest stable one"),
)

if __name__ == "__main__":
    sys.exit(main())
