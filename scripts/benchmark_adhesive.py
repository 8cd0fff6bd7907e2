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

import bem_adhesion.operators.fourier
from bem_adhesion.adhesive.contact import AdhesiveContact
from contact_study.numerics.fourier import RealTransform
from contact_study.study.case import Case, realise
from contact_study.study.study import read_study

PRESSURES = np.array([0.1, 0.2, 0.5, 1, 2, 5, 10]) * 1e9
# Gaps that differ by less, in units of the law's length, are those of one state: residuals over the softest stiffness.
SAME = 1e-3
HEAD_ANEW = (
    "| points (seeds) | adhesion | steps | pairs a path | anew | dearer than anew | by (median, most) | other state |"
)


class TimedTransform(RealTransform):
    """A transform that adds up its time over all instances (s)."""

    seconds = 0.0

    def forward(self):
        began = time.perf_counter()
        result = super().forward()
        TimedTransform.seconds += time.perf_counter() - began
        return result

    def backward(self):
        began = time.perf_counter()
        result = super().backward()
        TimedTransform.seconds += time.perf_counter() - began
        return result


@dataclass(frozen=True)
class PathCost:
    """Transform pairs and convergence of each step; seconds of the path, and of its transforms."""

    pairs: np.ndarray
    converged: bool
    seconds: float
    transform_seconds: float


def contact_of(case: Case) -> AdhesiveContact:
    """The contact that a case is about."""
    surface = realise(case)
    return AdhesiveContact(surface.sampled, surface.grid, case.material.contact_modulus, case.law)


def cost_of_path(case: Case, pressures: np.ndarray) -> PathCost:
    """Load one case from separation through the pressures (Pa)."""
    contact = contact_of(case)
    state = contact.step(contact.separated(), pressures[0]).displacement  # compiles
    state, pairs, converged = contact.separated(), [], True
    TimedTransform.seconds, began = 0.0, time.perf_counter()
    for pressure in pressures:
        solution = contact.step(state, pressure)
        state = solution.displacement
        pairs.append(solution.fft_pairs)
        converged &= solution.converged
    return PathCost(np.array(pairs), converged, time.perf_counter() - began, TimedTransform.seconds)


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
    cells = [
        f"{points}² ({_seeds(surfaces)})",
        f"{ratio:g} ε₀",
        f"{pairs.size}",
        f"{pairs.sum() / len(paths):.0f}",
        f"{anew.sum() / len(paths):.0f}",
        f"{dearer.size}",
        f"{np.median(dearer):.0f}, {dearer.max():.0f}" if dearer.size else "–",
        f"{np.count_nonzero(differs)}",
    ]
    return f"| {' | '.join(cells)} |"


def _seeds(surfaces: int) -> str:
    return f"1{f'–{surfaces}' if surfaces > 1 else ''}"


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("study", type=Path, nargs="?", default=Path("data/yang2008.toml"), help="study file")
    made.add_argument("--points", type=int, nargs="+", default=[256, 400, 512], help="points along each side")
    made.add_argument(
        "--surfaces",
        type=int,
        nargs="+",
        default=[3],
        help="how many for each grid, or one number for all; seeds from 1",
    )
    made.add_argument("--ratios", type=float, nargs="+", default=[1, 4, 8], help="multiples of the well depth")
    made.add_argument("--times", action="store_true", help="add columns that depend on the machine")
    made.add_argument("--anew", action="store_true", help="every step beside one from separation, in another table")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    given = parser().parse_args(arguments)
    counts = given.surfaces * len(given.points) if len(given.surfaces) == 1 else given.surfaces
    if len(counts) != len(given.points):
        parser().error(f"--surfaces: {len(counts)} numbers for {len(given.points)} grids; give one, or one for each")
    if given.anew:
        print_beside_anew(given, counts)
        return 0
    head = " | ".join(f"{ratio:g} ε₀ | worst" for ratio in given.ratios)
    print(f"| points (seeds) | {head} |" + (" transforms | s a step |" if given.times else ""))
    print("|---" * (1 + 2 * len(given.ratios) + (2 if given.times else 0)) + "|")
    bem_adhesion.operators.fourier.RealTransform = TimedTransform  # type: ignore[misc]
    try:
        for points, surfaces in zip(given.points, counts, strict=True):
            seeds = range(1, surfaces + 1)
            costs = {ratio: [cost(given.study, points, seed, ratio) for seed in seeds] for ratio in given.ratios}
            print(line(points, surfaces, costs, given.times), flush=True)
    finally:
        bem_adhesion.operators.fourier.RealTransform = RealTransform  # type: ignore[misc]
    return 0


def print_beside_anew(given: argparse.Namespace, counts: Sequence[int]) -> None:
    """The table of steps beside ones from separation."""
    print(HEAD_ANEW + "\n" + "|---" * 8 + "|")
    for points, surfaces in zip(given.points, counts, strict=True):
        for ratio in given.ratios:
            cases = [one_case(given.study, points, seed, ratio) for seed in range(1, surfaces + 1)]
            paths = [beside_anew(case, PRESSURES) for case in cases]
            print(line_beside_anew(points, surfaces, ratio, paths), flush=True)


def cost(study: Path, points: int, seed: int, ratio: float) -> PathCost:
    """Cost of the path on one surface of a study, at one adhesion."""
    return cost_of_path(one_case(study, points, seed, ratio), PRESSURES)


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
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    sys.exit(main())
