"""Work and time of the adhesive solver along the loading path of a study, over grids and surfaces.

Prints, for each grid and adhesion, the median transform pairs of every load step (as float64 pairs on the finest grid,
a count that does not depend on the machine), the costliest step, the share of time in transforms and the seconds.

    python scripts/benchmark_adhesive.py data/yang2008.toml --points 256 400 512 1024 --seeds 1 2 3
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bem_adhesion.loading import LoadedContact
from contact_study.fields.fourier import RealTransform
from contact_study.problem.case import Case
from contact_study.problem.laws.base import TractionLaw
from contact_study.problem.study import read_study
from contact_study.problem.surface import realise

PRESSURES = np.array([0.1, 0.2, 0.5, 1, 2, 5, 10]) * 1e9


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


def cost_of_path(case: Case, pressures: np.ndarray) -> PathCost:
    """Load one case from separation through the pressures (Pa)."""
    surface = realise(case)
    assert isinstance(case.law, TractionLaw)
    contact = LoadedContact(surface.heights(surface.shape), surface.grid, case.material.contact_modulus, case.law)
    state = contact.step(contact.separated(), pressures[0]).displacement  # compiles
    state, pairs, converged = contact.separated(), [], True
    TimedTransform.seconds, began = 0.0, time.perf_counter()
    for pressure in pressures:
        solution = contact.step(state, pressure)
        state = solution.displacement
        pairs.append(solution.fft_pairs)
        converged &= solution.converged
    return PathCost(np.array(pairs), converged, time.perf_counter() - began, TimedTransform.seconds)


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=Path)
    parser.add_argument("--points", type=int, nargs="+", default=[256, 400, 512])
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    given = parser.parse_args(arguments)
    import bem_adhesion.elasticity

    bem_adhesion.elasticity.RealTransform = TimedTransform  # type: ignore[misc]
    print("points  ratio  pairs a step at", *(f"{p / 1e9:g}" for p in PRESSURES), "GPa | worst | FFT share | s a step")
    for points in given.points:
        paths: dict[float, list[PathCost]] = {}
        for seed in given.seeds:
            study = read_study(given.study, {"surface.shape": [points, points], "surface.seed": seed})
            for case in study.cases:
                paths.setdefault(case.interaction.well_depth_ratio, []).append(cost_of_path(case, PRESSURES))
        for ratio, costs in paths.items():
            pairs = np.array([cost.pairs for cost in costs])
            seconds = sum(cost.seconds for cost in costs)
            share = sum(cost.transform_seconds for cost in costs) / seconds
            print(
                f"{points:6d} {ratio:6g} ",
                *(f"{value:5.0f}" for value in np.median(pairs, axis=0)),
                f"| {pairs.max():5.0f} | {share:.2f} | {seconds / pairs.size:.3f}",
                "" if all(cost.converged for cost in costs) else "| NOT CONVERGED",
                flush=True,
            )


if __name__ == "__main__":
    main()
