"""The contact-mechanics challenge: area against load, gap and stress tails, each with what the grid still changes.

M. H. Müser et al., Meeting the contact-mechanics challenge, Tribol. Lett. 65, 118 (2017): a cell of 100 µm, roughness
of Hurst exponent 0.8 between a roll-off at 20 µm and a cutoff at 0.1 µm with an rms slope of 1, E* = 25 MPa, attraction
(Δγ/ρ) exp(−u/ρ) outside a hard wall with Δγ = 50 mJ/m² and ρ = 2.071 nm, 250 kPa. The surface is another sample of that
recipe, scaled to its slope, not the published one. It has two points to its shortest wave at 2048².

Every load is solved on each grid, on the same surface, and the results are extrapolated to an infinitely fine one: by
the order of convergence that the last three grids show, or by first order, that of an edge counted in points. A
smaller cell has the same shortest waves, and so nearly the same error, on fewer points.

    python -m research.contact_challenge --points 2048 4096
    python -m research.contact_challenge --size "12.5 um" --points 256 512 1024
    python -m research.contact_challenge --points 2048 4096 8192 --table data/contact_challenge.csv
"""

import argparse
import itertools
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bem_adhesion import rough_contact
from bem_adhesion.solution import Solution
from contact_study.campaign.memory import Need, require
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import quantity
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import Exponential, HardWall
from contact_study.physics.process_zone import POINTS_FOR_ONE_STATE, process_zone
from contact_study.physics.surfaces.surface import Surface
from scripts.harness import ROOT, Option, head, peak_memory, program, rough_surface, row, walk
from theory.non_adhesive.closed_forms import relative_contact_area

CELL, ROLL_OFF, CUTOFF = 100e-6, 20e-6, 0.1e-6
MODULUS, WORK, RANGE = 25e6, 0.05, 2.071e-9
PRESSURES = (50e3, 250e3, 1e6, 4e6)
# Stresses above which the tail is counted, in units of the deviation in full contact, E*/2 at a slope of 1.
TAILS = (1.0, 2.0, 3.0)
# Of convergence, that three grids can show; outside they are too coarse to tell, and first order is taken.
_ORDERS = (0.5, 2.1)
_BYTES_PER_POINT = 200
TRAPPED_EDGES = ROOT / "data" / "trapped_edges.csv"


def run(given: argparse.Namespace) -> int:
    size = quantity(given.size, "m", "--size")
    pressures = [quantity(p, "Pa", "--pressures") for p in given.pressures]
    grids = given.points
    if any(fine <= coarse for coarse, fine in itertools.pairwise(grids)):
        raise InputError(f"--points {' '.join(map(str, grids))}: must increase")
    law = HardWall() if given.no_adhesion else Exponential(WORK, RANGE)
    questions = [
        {"adhesion": not given.no_adhesion, "size": size, "seed": given.seed, "points": points} for points in grids
    ]
    known = [_known(given.table, question, pressures) for question in questions]
    for points in (points for points, rows in zip(grids, known, strict=True) if rows is None):
        require(Need(points**2 * _BYTES_PER_POINT, f"--points {points}", "fewer points"))
    sample = surface(size, grids[0], given.seed)
    found = []
    for question, points, rows in zip(questions, grids, known, strict=True):
        if rows is None:
            solved = path(sample, points, law, pressures, given.threads)
            rows = [numbers(pressure, solution) for pressure, solution in zip(pressures, solved, strict=True)]
            if given.table:
                _add(given.table, [question | each for each in rows])
        found.append(rows)
        print(f"{points}²: {sum(each['pairs'] for each in rows):.0f} pairs", file=sys.stderr)
    kind = "no adhesion" if given.no_adhesion else "with adhesion"
    print(
        f"Cell {size * 1e6:g} µm, seed {given.seed}, {kind}: rms height {sample.rms_height * 1e6:.3f} µm, rms slope "
        f"{sample.rms_slope:.3f}, points {size / grids[-1] * 1e9:.3g} nm apart on the finest grid.\n"
    )
    spacing = [size / points for points in grids]
    heads = [f"{points}²" for points in grids] + (["extrapolated", "error of the finest"] if len(grids) > 1 else [])
    names = {
        "area": "A/A₀",
        "gap": "ū (µm)",
        "stress": "mean stress in contact (MPa)",
        **{f"tail {k:g}": f"A/A₀ with σ > {k:g}·E*/2" for k in TAILS},
    }
    print(head("p (kPa)", "", *heads))
    for number, pressure in enumerate(pressures):
        for name, title in names.items():
            values = [rows[number][name] for rows in found]
            cells = [f"{value:.4g}" for value in values]
            if len(grids) > 1:
                limit = extrapolated(values, spacing)
                cells += [f"{limit:.4g}", error_of(values[-1], limit)]
            print(row(f"{pressure / 1e3:g}", title, *cells))
        theory = float(relative_contact_area(pressure, (MODULUS * sample.rms_slope / 2) ** 2))
        print(
            f"| {pressure / 1e3:g} | A/A₀, Persson's theory of the hard wall | {theory:.4g} |{' |' * (len(heads) - 1)}"
        )
    pairs = ", ".join(
        f"{sum(each['pairs'] for each in rows):.0f} on {points}²" for points, rows in zip(grids, found, strict=True)
    )
    memory = max(each["peak_memory"] for rows in found for each in rows)
    print(f"\nPairs of transforms: {pairs}. Peak memory {memory:.1f} GB.")
    share = process_zone(MODULUS, law) / spacing[-1]
    if share < POINTS_FOR_ONE_STATE:
        print(
            f"\nThe process zone has {share:.2g} of the finest spacing: states depend on how they are loaded. "
            f"These are of one step; slow loading ends with less contact, {slow_loading(share)}. "
            "The last two columns say what the grid changes in that one way."
        )
    failed = sum(not each["converged"] for rows in found for each in rows)
    if failed:
        print(f"\n{failed} states did not converge.")
    return 2 if failed else 0


def _known(table: Path | None, question: dict[str, float], pressures: Sequence[float]) -> list[dict[str, float]] | None:
    """What a table has of a path on one grid; None if it lacks a state of it."""
    if table is None or not table.exists():
        return None
    rows = pd.read_csv(table)
    for name, value in question.items():
        rows = rows[np.isclose(rows[name].astype(float), value, rtol=1e-12, atol=0)]
    if len(rows) != len(pressures) or not np.allclose(rows["pressure"], pressures, rtol=1e-12, atol=0):
        return None
    return [{str(name): value for name, value in each.items()} for each in rows.to_dict("records")]


def _add(table: Path, rows: list[dict[str, float]]) -> None:
    pd.DataFrame(rows).to_csv(table, mode="a", header=not table.exists(), index=False)


def slow_loading(zone: float) -> str:
    """How much less contact slow loading had at the process zone over spacing next to this one, in words."""
    table = pd.read_csv(TRAPPED_EDGES)
    table = table[table.law == "exponential"].assign(less=lambda rows: 100 * (1 - rows.flow / rows.steps))
    nearest = min(table.ratio, key=lambda ratio: abs(np.log(ratio / zone)))
    means = table[table.ratio == nearest].groupby("points").less.mean()
    return f"at {nearest:g} of a spacing " + " and ".join(f"{less:.0f} % on {n}² points" for n, less in means.items())


def error_of(value: float, limit: float) -> str:
    """How far a value is from its limit, in words."""
    if limit <= 0:
        return "none"
    error = 100 * (value / limit - 1)
    return f"{error:+.1f} %" if abs(error) >= 0.05 else "< 0.1 %"


def surface(size: float, points: int, seed: int) -> Surface:
    """A sample of the challenge's recipe on a cell (m), its rms slope 1."""
    keys = {"roll_off_mode": max(1.0, size / ROLL_OFF), "cutoff_mode": size / CUTOFF, "seed": seed}
    unscaled = rough_surface(size, points, 1e-6, **keys)
    return rough_surface(size, points, 1e-6 / unscaled.rms_slope, **keys)


def path(
    sample: Surface, points: int, law: Exponential | HardWall, pressures: Sequence[float], threads: int
) -> Iterator[Solution]:
    """The states of a loading path on one grid, one at a time."""
    grid = Grid((points, points), sample.size)
    contact = rough_contact(sample.heights(grid.shape), grid.size, MODULUS, law, threads=threads)
    return walk(contact, pressures)


def numbers(pressure: float, solution: Solution) -> dict[str, float]:
    """What is compared of a state: area, mean gap (µm), stress in contact (MPa), tails; what it took (GB)."""
    touching = solution.gap <= 0
    stress = solution.pressure
    return {
        "pressure": pressure,
        "area": float(np.mean(touching)),
        "gap": float(np.mean(solution.gap)) * 1e6,
        "stress": float(np.mean(stress[touching])) / 1e6 if touching.any() else 0.0,
        **{f"tail {k:g}": float(np.mean(stress > k * MODULUS / 2)) for k in TAILS},
        "pairs": solution.fft_pairs,
        "converged": solution.converged,
        "peak_memory": peak_memory() / 1e9,
    }


def extrapolated(values: Sequence[float], spacing: Sequence[float]) -> float:
    """The value at zero spacing, by Richardson, from two grids or more, coarse to fine."""
    ratio = spacing[-2] / spacing[-1]
    last = values[-2] - values[-1]
    order = 1.0
    if len(values) > 2 and last != 0 and np.isclose(spacing[-3] / spacing[-2], ratio):
        before = (values[-3] - values[-2]) / last
        if before > 0:
            shown = float(np.log(before) / np.log(ratio))
            order = shown if _ORDERS[0] <= shown <= _ORDERS[1] else 1.0
    return values[-1] - last / (ratio**order - 1)


main = program(
    run,
    Option("--points", [2048], "points along each side, increasing"),
    Option("--size", "100 um", "side of the cell"),
    Option("--pressures", [f"{p / 1e3:g} kPa" for p in PRESSURES], "in this order"),
    Option("--seed", 1, "sample of the recipe"),
    Option("--no-adhesion", False, "the hard wall alone"),
    Option("--threads", 1, "threads of the transforms"),
    Option("--table", Path, "CSV of results: grids it has are not solved again, others are added"),
)

if __name__ == "__main__":
    sys.exit(main())
