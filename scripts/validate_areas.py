"""Areas on both branches against means of many surfaces, whose single loops scatter at light load, as Markdown.

Pressure rises in few steps and falls again, so a surface takes seconds. Each has its theories, fed with its spectrum.

python -m scripts.validate_areas --table data/areas_of_atlas.csv
python -m scripts.validate_areas --from data/areas_of_atlas.csv
"""

import argparse
import itertools
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from contact_study.atlas.collection import THEORIES, WAYS, theory_values
from contact_study.atlas.design import JUMPING, LEAST_JUMP, STRESS, Condition, design
from contact_study.atlas.loops import file_of, run_theories, run_under_pressures, seeds_of
from scripts.atlas_tables import AREA, DATA, MARKERS, NAMES, by_number
from scripts.harness import Option, head, minus, row, tabulated
from scripts.validate_hysteresis import LARGEST, LEAST, STRONG, choosing_half, ratio_of_means

CONDITIONS = [109, 129, 577, 743, 933, 1051, 19, 127, 187, 595, 663, 889, 1125]  # of partial contact under pressure
SURFACES, MANY = 16, {1051: 64}  # of each condition; more where few summits carry
PRESSURES = 0.02, 0.05, 0.1, 0.2, 0.4, 0.8  # over E* h'/2
PRELOAD = 2.0
TABLE = DATA.with_name("areas_of_atlas.csv")


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    chose = choosing_half()
    known = design()[0] + design(JUMPING, least_jump=LEAST_JUMP)[0]
    for one in by_number(known, given.numbers):
        count = given.surfaces or MANY.get(one.number, SURFACES)
        areas = _areas(one, seeds_of(one, count), Path(given.folder), given.workers)
        same = {"condition": one.number, "law": one.law, "relative_adhesion": one.relative_adhesion}
        same |= {"judges": one.number not in chose, "surfaces": count}
        for way, place in itertools.product(range(len(WAYS)), range(len(PRESSURES))):
            simulated, *theories = areas[:, way, :, place]
            found = same | {"branch": WAYS[way], "pressure": PRESSURES[place], "area": float(simulated.mean())}
            for name, theirs in zip(THEORIES, theories, strict=True):
                found[name], found[f"{name}_error"] = ratio_of_means(simulated, theirs)
            yield found


def _areas(condition: Condition, seeds: Sequence[int], folder: Path, workers: int) -> np.ndarray:
    """Areas by simulation and by each theory, shape (1 + theories, ways, surfaces, pressures)."""
    path = [STRESS * share for share in (*PRESSURES, PRELOAD, *PRESSURES[::-1])]
    states = run_under_pressures(condition, file_of(folder, condition, "areas"), seeds, path, workers)
    simulated = states[AREA].where(states["converged"] == 1).transpose("seed", "step").values
    trees = [[*map(xr.load_datatree, run_theories(condition, folder, seed, path))] for seed in seeds]
    pairs = [[simulated, simulated]]
    for label in THEORIES:
        by_surface = (
            [theory_values(tree, label, "relative_contact_area", back) for tree in trees] for back in (False, True)
        )
        pairs.append([np.array(each) for each in by_surface])
    count = len(PRESSURES)
    return np.array([(there[:, :count], back[:, :count:-1]) for there, back in pairs])


def lines(table: pd.DataFrame) -> Iterator[str]:
    partial = table[(table["area"] > LEAST) & (table["area"] < LARGEST)]
    columns = [f"area {way}: mean size, worst" for way in WAYS]
    yield head("condition", "law", "θ", "half", "surfaces", *columns)
    for number, some in partial.groupby("condition"):
        first = some.iloc[0]
        law, half = MARKERS[first["law"]][0], "judges" if first["judges"] else ""
        yield row(number, law, f"{first['relative_adhesion']:.2f}", half, first["surfaces"], *_cells(some, "edge_flow"))
    yield ""
    yield head("theory", "conditions", "number", *columns)
    judging = partial[partial["judges"]]
    strong = judging[judging["relative_adhesion"] >= STRONG]
    for words, some in {"judging": judging, f"judging, θ ≥ {STRONG:g}": strong}.items():
        for name in () if some.empty else THEORIES:
            yield row(NAMES[name], words, some["condition"].nunique(), *_cells(some, name))


def _cells(some: pd.DataFrame, name: str) -> list[str]:
    return [_of_branch(some[some["branch"] == way], name) for way in WAYS]


def _of_branch(some: pd.DataFrame, name: str) -> str:
    """Write the mean size of relative errors, and the worst with its standard error and pressure."""
    known = some.dropna(subset=[name])
    if known.empty:
        return ""
    error, spread = 100 * (known[name] - 1), 100 * known[f"{name}_error"]
    worst = error.abs().idxmax()
    at = f"{error[worst]:+.0f} ± {spread[worst]:.0f} % at {known['pressure'][worst]:g}"
    return f"{error.abs().mean():.1f} %, {minus(at)}"


main = tabulated(
    rows,
    lines,
    Option("--numbers", CONDITIONS, "conditions by their numbers in the design"),
    Option("--surfaces", 0, "of each condition; 0: as published"),
    Option("--folder", "build/areas", "folder of the runs"),
    Option("--workers", 1, "processes for surfaces of a condition"),
)

if __name__ == "__main__":
    sys.exit(main())
