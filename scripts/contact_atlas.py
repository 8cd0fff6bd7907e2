"""The contact atlas: a design of adhesive rough contacts, their loops, and one dataset with theories beside them.

python -m scripts.contact_atlas run --first 25         # what the folder lacks; again to resume
python -m scripts.contact_atlas collect --surfaces 1 -o data/contact_atlas.nc
python -m scripts.contact_atlas validate data/contact_atlas.nc
python -m scripts.contact_atlas join data/contact_atlas.nc --others yours.nc -o wide.nc

Without --first it is the whole design, for which its beginning stands.
"""

import argparse
import sys
import time
from pathlib import Path

import xarray as xr

from contact_study.atlas.collection import collect
from contact_study.atlas.design import JUMPING, LEAST_JUMP, SURFACES, WHOLE, Condition, design
from contact_study.atlas.joining import join
from contact_study.atlas.loops import PRELOADS, REFINEMENTS, run_condition
from contact_study.atlas.validation import problems
from contact_study.campaign.store.files import write_aside
from contact_study.inputs.errors import InputError
from scripts.atlas_tables import DATA, by_number, read
from scripts.harness import Option, program

SMALL_GRID = 128  # points a side up to which a condition is refined


def run(given: argparse.Namespace) -> int:
    return ACTIONS[given.action](given)


def compute(given: argparse.Namespace) -> int:
    """Run the conditions, those of small grids first; --minutes ends before the next one."""
    began = time.monotonic()
    if not 1 <= given.first_surface <= given.surfaces:
        raise InputError(f"--first-surface {given.first_surface}: expected 1 to {given.surfaces}, the --surfaces")
    every = _conditions(given)
    refined = _refined(every, len(every) // 10 if given.refined is None else given.refined)
    conditions = _part(sorted(every, key=lambda one: one.points), given.part)
    for number, one in enumerate(conditions, 1):
        if given.minutes and time.monotonic() - began > 60 * given.minutes:
            print(f"{len(conditions) - number + 1} conditions are left; run again to resume", file=sys.stderr)
            return 2
        factors = REFINEMENTS if one.number in refined else ()
        run_condition(
            one, Path(given.folder), given.surfaces, factors, given.workers, given.preloads, given.first_surface
        )
        seconds = time.monotonic() - began
        words = f"{number} of {len(conditions)}: condition {one.number}, {one.points}², {seconds:.0f} s so far"
        print(words, file=sys.stderr, flush=True)
    return 0


def _part(conditions: list[Condition], words: str) -> list[Condition]:
    """Choose every n-th condition, so that parts take about the same time."""
    try:
        place, count = map(int, words.split("/"))
    except ValueError:
        place = count = 0
    if not 1 <= place <= count:
        raise InputError(f"--part {words}: expected K/N with 1 <= K <= N, such as 2/8")
    return conditions[place - 1 :: count]


def write(given: argparse.Namespace) -> int:
    """Write the folder's conditions as one dataset."""
    conditions = _conditions(given)
    dataset = collect(conditions, Path(given.folder), given.surfaces)
    print(f"{dataset.sizes['condition']} conditions of {len(conditions)}", file=sys.stderr)
    return _save(dataset, given)


def widen(given: argparse.Namespace) -> int:
    """Join a dataset with others, all of which must be sound."""
    if given.others is None:
        raise InputError("join: missing --others FILE.nc")
    parts = []
    for path in (given.file, *given.others):
        parts.append(read(path))
        if found := problems(parts[-1]):
            raise InputError(f"{path}: {found[0]}; validate it for all {len(found)} problems")
    return _save(join(parts), given)


def _save(dataset: xr.Dataset, given: argparse.Namespace) -> int:
    if given.output is None:
        raise InputError(f"{given.action}: missing -o FILE.nc")
    coded = {
        name: {"zlib": True, "complevel": 9, "shuffle": True}
        for name, variable in dataset.variables.items()
        if variable.dtype.kind in "fi" and variable.ndim > 1
    }
    write_aside(given.output, lambda partial: dataset.to_netcdf(partial, encoding=coded))
    print(given.output)
    return 0


def check(given: argparse.Namespace) -> int:
    found = problems(read(given.file))
    for line in found:
        print(line)
    print(f"{given.file}: {len(found)} problems", file=sys.stderr)
    return 1 if found else 0


def _conditions(given: argparse.Namespace) -> list[Condition]:
    """Return the first conditions of the design, the jumping ones, or those of some numbers."""
    found = design(JUMPING, least_jump=LEAST_JUMP)[0] if given.jumping else design(given.first)[0]
    return found if given.numbers is None else by_number(found, given.numbers)


def _refined(conditions: list[Condition], count: int) -> set[int]:
    """Choose conditions of small grids for finer ones: of each law those of the largest Tabor numbers.

    There grids matter most.
    """
    places: dict[str, int] = {}
    ranked = []
    for one in sorted(conditions, key=lambda one: -one.tabor_number):
        if one.points <= SMALL_GRID:
            place = places[one.law] = places.get(one.law, 0) + 1
            ranked.append((place, one.number))
    return {number for _, number in sorted(ranked)[:count]}


ACTIONS = {
    "run": compute,
    "collect": write,
    "join": widen,
    "validate": check,
}

main = program(
    run,
    Option("action", str, "step", choices=tuple(ACTIONS)),
    Option("file", DATA, "dataset to validate or widen", type=Path),
    Option("--first", WHOLE, "conditions of the design"),
    Option("--jumping", False, "further conditions whose mean asperity jumps"),
    Option("--numbers", int, "conditions by their numbers in the design", nargs="+"),
    Option("--preloads", list(PRELOADS), "of the loops, over E* h'/2"),
    Option("--folder", "build/atlas", "folder of the runs"),
    Option("--surfaces", SURFACES, "surfaces of each condition"),
    Option("--first-surface", 1, "first surface that is run, in a folder of its own, where a dataset has those before"),
    Option("--part", "1/1", "K/N: every N-th condition from the K-th on, for job arrays"),
    Option("--workers", 1, "processes for loops of a condition"),
    Option("--refined", int, "conditions that run on half and twice the points, too; default: a tenth"),
    Option("--minutes", 0.0, "time after which no further condition begins; 0: none"),
    Option("--others", Path, "datasets that join adds to the first", nargs="+"),
    Option("-o, --output", Path, "dataset that collect or join writes"),
    interrupted="finished states are kept; run again to resume",
)

if __name__ == "__main__":
    sys.exit(main())
