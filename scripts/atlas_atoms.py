"""Conditions of the contact atlas as blocks of atoms at 0 K and at 300 K, and the continuum on the same surfaces.

python -m scripts.atlas_atoms run       # what the folder lacks, then the dataset; again to resume
python -m scripts.atlas_atoms table     # of the dataset
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np
import xarray as xr

from contact_study.atlas.atoms import MODELS, SLOPES, collect_blocks, run_block, tasks
from contact_study.campaign.store.files import write_aside
from scripts.contact_atlas import DATA, read
from scripts.harness import Option, minus, program, show

ATOMS = DATA.with_name("contact_atlas_atoms.nc")
WAYS = "loading", "unloading"
PAIRS = {"0 K − continuum": (MODELS[1], MODELS[0]), "300 K − 0 K": (MODELS[2], MODELS[1])}


def run(given: argparse.Namespace) -> None:
    ACTIONS[given.action](given)


def compute(given: argparse.Namespace) -> None:
    """Run each block and model; --minutes ends before the next run. Then write what there is."""
    began, every = time.monotonic(), tasks()
    for number, (block, model) in enumerate(every):
        if given.minutes and time.monotonic() - began > 60 * given.minutes:
            print(f"{len(every) - number} runs are left; run again to resume", file=sys.stderr)
            break
        run_block(block, given.folder, model)
        words = f"{number + 1} of {len(every)}: condition {block.condition.number}, {block.atoms}² {model}"
        print(f"{words}, {time.monotonic() - began:.0f} s so far", file=sys.stderr, flush=True)
    write_aside(given.file, collect_blocks(given.folder).to_netcdf)
    print(given.file)


def table(given: argparse.Namespace) -> None:
    """Print differences by branch and pressure, and every block at the lightest pressure of both branches."""
    data = read(given.file)
    rows = []
    for words, pair in PAIRS.items():
        for slope in SLOPES:
            some = data.isel(block=np.flatnonzero(np.isclose(data["slope"], slope)))
            rows += [(words, f"{slope:g}", *row) for row in _differences(some, *pair)]
    heads = "difference", "slope", "conditions", "branch", "p/(E*h′/2)", "area: mean", "worst"
    show((*heads, "ū/h_rms: mean", "worst"), rows)
    print()
    names = [f"{what}: {name}" for what in ("A", "ū/h_rms") for name in ("continuum", "0 K", "300 K")]
    lines = [_line(data.isel(block=place)) for place in range(data.sizes["block"])]
    show(("condition", "atoms", "slope", "θ", "μ", *names), lines)


def _differences(data: xr.Dataset, later: str, before: str) -> list[tuple[object, ...]]:
    """Return a row for each branch and pressure that both models have."""
    one, other = data.sel(model=later), data.sel(model=before)
    area = 100 * (one["relative_contact_area"] / other["relative_contact_area"] - 1)
    gap = (one["mean_gap"] - other["mean_gap"]) / data["rms_height"]
    rows = []
    for step in np.flatnonzero(area.notnull().any("block")):
        shifts, lifts = (each.isel(step=step).dropna("block").values for each in (area, gap))
        pressure, way = float(data["prescribed_pressure"][step]), WAYS[int(data["branch"][step])]
        cells = [f"{value(shifts):+.1f} %" for value in (np.mean, _worst)]
        cells += [f"{value(lifts):+.3f}" for value in (np.mean, _worst)]
        rows.append((shifts.size, way, f"{pressure:.2g}", *map(minus, cells)))
    return rows


def _worst(values: np.ndarray) -> float:
    return float(values[np.abs(values).argmax()])


def _line(one: xr.Dataset) -> tuple[object, ...]:
    ends = one.isel(step=[0, -1])
    cells = [
        "/".join("–" if np.isnan(value) else f"{value:.3f}" for value in each.sel(model=model).values)
        for each in (ends["relative_contact_area"], ends["mean_gap"] / one["rms_height"])
        for model in MODELS
    ]
    numbers = (f"{float(one[name]):.2g}" for name in ("slope", "relative_adhesion", "tabor_number"))
    return int(one["condition"]), f"{int(one['atoms'])}²", *numbers, *map(minus, cells)


ACTIONS = {"run": compute, "table": table}

main = program(
    run,
    Option("action", str, "step or table", choices=tuple(ACTIONS)),
    Option("file", ATOMS, "dataset that run writes and table reads", type=Path),
    Option("--folder", Path("build/atlas_atoms"), "folder of the runs", type=Path),
    Option("--minutes", 0.0, "time after which no further run begins; 0: none"),
    interrupted="finished states are kept; run again to resume",
)

if __name__ == "__main__":
    sys.exit(main())
