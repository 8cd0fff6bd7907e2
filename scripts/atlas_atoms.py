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
from contact_study.atlas.collection import WAYS
from contact_study.campaign.store.files import write_aside
from scripts.atlas_tables import DATA, read
from scripts.harness import Option, minus, program, show

ATOMS = DATA.with_name("contact_atlas_atoms.nc")
LOOP = 0.002  # relative difference of areas above which there are two branches
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
    """Print differences by pressure, and blocks of two branches at the lightest pressure."""
    data = read(given.file)
    rows = []
    for words, pair in PAIRS.items():
        for slope in SLOPES:
            some = data.isel(block=np.isclose(data["slope"], slope))
            rows += [(words, f"{slope:g}", *row) for row in _differences(some, *pair)]
    heads = [f"{what}, {way}" for what in ("area", "ū/h_rms") for way in WAYS]
    show(("difference", "slope", "conditions", "p/(E*h′/2)", *heads), rows)
    print()
    names = [f"{what}: {name}" for what in ("A", "ū/h_rms") for name in ("continuum", "0 K", "300 K")]
    lines = [_line(one) for one in (data.isel(block=place) for place in range(data.sizes["block"])) if _shown(one)]
    show(("condition", "atoms", "slope", "θ", "μ", *names), lines)


def _differences(data: xr.Dataset, later: str, before: str) -> list[tuple[object, ...]]:
    """Return a row for each pressure that both models have: means and worst values on both branches."""
    one, other = data.sel(model=later), data.sel(model=before)
    area = 100 * (one["relative_contact_area"] / other["relative_contact_area"] - 1)
    gap = (one["mean_gap"] - other["mean_gap"]) / data["rms_height"]
    rows = []
    steps = data.sizes["step"]
    for step in range(steps // 2 + 1):
        ways = [step, steps - 1 - step] if step < steps // 2 else [step]
        shifts, lifts = ([each.isel(step=way).dropna("block").values for way in ways] for each in (area, gap))
        if not shifts[0].size:
            continue
        cells = [[f"{mean:+.1f} ({worst:+.1f}) %" for mean, worst in map(_mean_and_worst, shifts)]]
        cells += [[f"{mean:+.3f} ({worst:+.3f})" for mean, worst in map(_mean_and_worst, lifts)]]
        filled = [minus(cell) for some in cells for cell in [*some, "–"][:2]]
        rows.append((shifts[0].size, f"{float(data['prescribed_pressure'][step]):.2g}", *filled))
    return rows


def _mean_and_worst(values: np.ndarray) -> tuple[float, float]:
    return float(values.mean()), float(values[np.abs(values).argmax()])


def _shown(one: xr.Dataset) -> bool:
    """Tell whether a block has two branches in the continuum or at 0 K."""
    areas = one["relative_contact_area"].isel(step=[0, -1]).values
    return bool((np.abs(areas[:2, 1] / areas[:2, 0] - 1) > LOOP).any())


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
