"""At how many grid points in the process zone slow motion and equilibria end in the same state, and by how much not.

The contact-mechanics challenge's recipe on a small cell: one load from separation, once in one step to the equilibrium
and once in slow motion against friction. The law's length changes at constant work of adhesion, and with it the process
zone E*Δγ/σ_max² over the fixed grid spacing. Rows that the file has already are not computed again.

    python -m research.trapped_edges -o data/trapped_edges.csv
    python -m research.trapped_edges --from data/trapped_edges.csv --figure docs/images/trapped_edges.png
"""

import argparse
import itertools
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

import contact_study
from contact_study.inputs.errors import InputError
from contact_study.physics.laws import make_law
from contact_study.plots.style import COLOURS, SINGLE, styled
from scripts.harness import Option, head, program, read_rows, row, save, write_rows

MODULUS, WORK, SPACING, PRESSURE = 25e6, 0.05, 48.8e-9, 250e3
RMS_HEIGHT = 0.04  # over the cell; an rms slope of about one
RATIOS = (0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0)
NAMES = {"exponential": "exponential", "lennard_jones_10_4": "10-4", "dugdale": "Dugdale"}
WAYS = {"steps": "quasi_static", "flow": "overdamped"}
KEYS = ["law", "points", "ratio", "seed"]


def run(given: argparse.Namespace) -> None:
    known = read_rows(given.source or given.output, KEYS)
    wanted = itertools.product(given.laws, [given.points], given.ratios, given.seeds) if given.source is None else ()
    for one in wanted:
        if not (known[KEYS] == list(one)).all(axis=1).any():
            known = pd.concat([known, pd.DataFrame([loaded(*one)])])
            write_rows(known, given.output)
    if known.empty:
        raise InputError("nothing to print: no run has been made")
    print("\n".join(lines(known)))
    if given.figure is not None:
        save(drawn(known), given.figure)


def study(law: str, points: int, ratio: float, seed: int) -> dict[str, Any]:
    """One load on a surface, under a law whose process zone has so many grid spacings."""
    # σ_max is Δγ / length times a number of the law.
    length = make_law(law, 1.0, 1.0).peak_tensile_stress * np.sqrt(ratio * SPACING * WORK / MODULUS)
    size = points * SPACING
    return {
        "surface": {
            "kind": "self_affine",
            "size": size,
            "shape": [points, points],
            "hurst_exponent": 0.8,
            "rms_height": RMS_HEIGHT * size,
            "roll_off_mode": 1,
            "cutoff_mode": points // 4,
            "seed": seed,
        },
        "material": {"youngs_modulus": MODULUS, "poissons_ratio": 0.0},
        "interaction": {"law": law, "work_of_adhesion": WORK, "length": length},
        "loading": {"path": [PRESSURE]},
    }


def loaded(law: str, points: int, ratio: float, seed: int) -> dict[str, Any]:
    """The contact area by each way."""
    table = study(law, points, ratio, seed)
    found: dict[str, Any] = {"law": law, "points": points, "ratio": ratio, "seed": seed}
    for way, path in WAYS.items():
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="grid too coarse")  # that is what is looked at
            state = contact_study.run(table | {"solver": {"path": path, "max_iterations": 20000}}).isel(step=0)
        found[way] = state.relative_contact_area.item()
        found[f"{way}_converged"] = state.converged.item()
    return found


def lines(table: pd.DataFrame) -> Iterator[str]:
    """The table as Markdown: mean areas, how much less the flow has, and from which ratio on no surface has."""
    areas = "A, one step", "A, slow flow"
    yield head("law", "points", "process zone / spacing", *areas, "less by (mean, most)")
    table = table.assign(less=less(table)).sort_values(KEYS)
    for (law, points, ratio), rows in table.groupby(["law", "points", "ratio"]):
        lost = "=" if same(rows).all() else f"{100 * rows.less.mean():.1f} %, {100 * rows.less.max():.1f} %"
        moving = "" if (rows.steps_converged * rows.flow_converged == 1).all() else " (moving)"
        areas = f"{rows.steps.mean():.4f}", f"{rows.flow.mean():.4f}"
        yield row(NAMES[law], f"{points}²", f"{ratio:g}", *areas, lost + moving)
    yield ""
    for (law, points), rows in table.groupby(["law", "points"]):
        parted = rows.ratio[~same(rows)]
        whole = rows.ratio[rows.ratio > parted.max()] if parted.size else rows.ratio
        said = f"the same states from {whole.min():g} on" if whole.size else "other states up to the largest ratio"
        yield f"- {NAMES[law]}, {points}²: {said}; at most {100 * rows.less.max():.0f} % less contact."


def less(table: pd.DataFrame) -> pd.Series:
    """Share of the contact of one step that the flow does not have."""
    return 1 - table.flow / table.steps


def same(table: pd.DataFrame) -> pd.Series:
    """Whether areas differ by less than one grid point."""
    return (table.flow - table.steps).abs() < 0.5 / table.points.astype(float) ** 2


@styled
def drawn(table: pd.DataFrame) -> Figure:
    """How much less contact slow motion leaves."""
    figure = Figure(figsize=(SINGLE, 2.6), layout="constrained")
    axes = figure.subplots()
    for number, ((law, points), rows) in enumerate(table.assign(less=100 * less(table)).groupby(["law", "points"])):
        by_ratio = rows.groupby("ratio").less
        mean, least, most = by_ratio.mean(), by_ratio.min(), by_ratio.max()
        axes.semilogx(mean.index, mean, COLOURS[number], marker="o", label=f"{NAMES[law]}, {points}²")
        axes.fill_between(mean.index, least, most, color=COLOURS[number], alpha=0.2, linewidth=0)
    axes.axvline(1, color="k", linestyle=":")
    axes.set(xlabel="process zone / grid spacing", ylabel="less contact by slow flow (%)")
    axes.legend()
    return figure


main = program(
    run,
    Option("--laws", list(NAMES), "interactions", choices=tuple(NAMES)),
    Option("--points", 64, "points along each side"),
    Option("--ratios", list(RATIOS), "process zones over grid spacing"),
    Option("--seeds", [1, 2, 3], "surfaces"),
    Option("-o, --output", Path, "CSV to add to"),
    Option("--from", Path, "CSV to print, in place of a run"),
    Option("--figure", Path, "draw the loss of contact, too"),
    interrupted="finished rows are kept",
)

if __name__ == "__main__":
    sys.exit(main())
