"""Work of the adhesive solver along the loading path of a study, over grids and surfaces, as a Markdown table.

For each grid and adhesion: the median transform pairs of every load step (as float64 pairs on the finest grid, a count
that does not depend on the machine's speed), and the costliest step. ``--times`` adds the share of time in transforms
and the seconds of a step, which do. Where adhesion is strong the counts depend on rounding: another plan of the
transforms changes them by some per cent.

``--anew`` takes every load but the first from separation, too, in one step, and sets its pairs beside those of the step
from the state before: sums over the path, how many steps were dearer than anew, by how many pairs at most, and in how
many steps anew ends in another state (gaps that differ by a thousandth of the law's length).

    python -m scripts.benchmark_adhesive data/yang2008.toml --points 256 400 --surfaces 6 4
    python -m scripts.benchmark_adhesive data/yang2008.toml --points 256 512 --surfaces 2 --anew
"""

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

from bem_adhesion.adhesive.contact import AdhesiveContact
from contact_study.inputs.errors import InputError
from contact_study.study.case import Case, realise
from contact_study.study.study import read_study
from scripts.benchmark_hard_wall import PhaseTimes
from scripts.harness import STUDY, Option, head, program, row, walk

PRESSURES = np.array([0.1, 0.2, 0.5, 1, 2, 5, 10]) * 1e9
# Gaps that differ by less, in units of the law's length, are those of one state: residuals over the softest stiffness.
SAME = 1e-3
HEAD_ANEW = ("points (seeds)", "adhesion", "steps", "pairs a path", "anew", "dearer than anew", "by (median, most)")
HEAD_ANEW += ("other state",)


@dataclass(frozen=True)
class PathCost:
    """Transform pairs and convergence of each step; seconds of the path, and of its transforms."""

    pairs: np.ndarray
    converged: bool
    seconds: float
    transform_seconds: float


def contact_of(case: Case, trace: PhaseTimes | None = None) -> AdhesiveContact:
    """The contact that a case is about."""
    surface = realise(case)
    return AdhesiveContact(surface.sampled, surface.grid, case.material.contact_modulus, case.law, trace=trace)


def cost_of_path(case: Case, pressures: np.ndarray) -> PathCost:
    """Load one case from separation through the pressures (Pa)."""
    contact_of(case).step(contact_of(case).separated(), pressures[0])  # compiles
    times = PhaseTimes()
    contact, began = contact_of(case, times), time.perf_counter()
    steps = list(walk(contact, pressures))
    pairs, converged = [step.fft_pairs for step in steps], all(step.converged for step in steps)
    return PathCost(np.array(pairs), converged, time.perf_counter() - began, times.seconds["transform"])


@dataclass(frozen=True)
class BesideAnew:
    """Transform pairs of each step but the first, from the state before and from separation; whether states differ."""

    pairs: np.ndarray
    anew: np.ndarray
    differs: np.ndarray


def beside_anew(case: Case, pressures: np.ndarray) -> BesideAnew:
    """Load one case through the pressures (Pa), and to each of them from separation."""
    contact = contact_of(case)
    state = contact.step(contact.separated(), pressures[0]).state
    found = []
    for pressure in pressures[1:]:
        step, anew = contact.step(state, pressure), contact.step(contact.separated(), pressure)
        state = step.state
        difference = np.abs(anew.gap - step.gap).max()
        found.append((step.fft_pairs, anew.fft_pairs, difference > SAME * case.law.length))
    pairs, pairs_anew, differs = np.array(found).T
    return BesideAnew(pairs, pairs_anew, differs.astype(bool))


def line_beside_anew(points: int, surfaces: int, ratio: float, paths: Sequence[BesideAnew]) -> str:
    """One grid's and one adhesion's row of the other table."""
    pairs, anew, differs = (np.concatenate(parts) for parts in zip(*map(astuple, paths), strict=True))
    dearer = (pairs - anew)[pairs > anew]
    return row(
        f"{points}² ({_seeds(surfaces)})",
        f"{ratio:g} ε₀",
        pairs.size,
        f"{pairs.sum() / len(paths):.0f}",
        f"{anew.sum() / len(paths):.0f}",
        dearer.size,
        f"{np.median(dearer):.0f}, {dearer.max():.0f}" if dearer.size else "–",
        np.count_nonzero(differs),
    )


def _seeds(surfaces: int) -> str:
    return f"1{f'–{surfaces}' if surfaces > 1 else ''}"


def run(given: argparse.Namespace) -> None:
    counts = given.surfaces * len(given.points) if len(given.surfaces) == 1 else given.surfaces
    if len(counts) != len(given.points):
        raise InputError(f"--surfaces: {len(counts)} numbers for {len(given.points)} grids; give one, or one for each")
    costs = (f"{ratio:g} ε₀ | worst" for ratio in given.ratios)
    heads = (
        HEAD_ANEW if given.anew else ("points (seeds)", *costs, *(("transforms", "s a step") if given.times else ()))
    )
    print(head(*" | ".join(heads).split(" | ")), flush=True)
    for points, surfaces in zip(given.points, counts, strict=True):
        cases = {
            ratio: [one_case(given.study, points, seed, ratio) for seed in range(1, surfaces + 1)]
            for ratio in given.ratios
        }
        if given.anew:
            for ratio, each in cases.items():
                paths = [beside_anew(case, PRESSURES) for case in each]
                print(line_beside_anew(points, surfaces, ratio, paths), flush=True)
        else:
            found = {ratio: [cost_of_path(case, PRESSURES) for case in each] for ratio, each in cases.items()}
            print(line(points, surfaces, found, given.times), flush=True)


def one_case(study: Path, points: int, seed: int, ratio: float) -> Case:
    """One surface of a study, at one adhesion."""
    overrides = {"surface.shape": [points, points], "surface.seed": seed, "interaction.well_depth_ratio": ratio}
    (case,) = read_study(study, overrides).cases
    return case


def line(points: int, surfaces: int, costs: dict[float, list[PathCost]], times: bool) -> str:
    """One grid's row of the table."""
    cells = [f"{points}² ({_seeds(surfaces)})"]
    for paths in costs.values():
        pairs = np.array([path.pairs for path in paths])
        medians = " ".join(f"{value:.0f}" for value in np.median(pairs, axis=0))
        cells += [medians, f"{pairs.max():.0f}" + ("" if all(path.converged for path in paths) else " (not converged)")]
    if times:
        every = [path for paths in costs.values() for path in paths]
        seconds = sum(path.seconds for path in every)
        share = sum(path.transform_seconds for path in every) / seconds
        cells += [f"{100 * share:.0f} %", f"{seconds / sum(path.pairs.size for path in every):.3f}"]
    return row(*cells)


main = program(
    run,
    STUDY,
    Option("--points", [256, 400, 512], "points along each side"),
    Option("--surfaces", [3], "how many for each grid, or one number for all; seeds from 1"),
    Option("--ratios", [1.0, 4.0, 8.0], "multiples of the well depth"),
    Option("--times", False, "add columns that depend on the machine"),
    Option("--anew", False, "every step beside one from separation, in another table"),
)

if __name__ == "__main__":
    sys.exit(main())
