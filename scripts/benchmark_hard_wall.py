"""Work and time of the hard-wall solver over grids, pressures and kinds of surface, as a Markdown table.

Transform pairs (as float64 pairs on the finest grid, a count that does not depend on the machine) and where the time
goes. Other codes are in benchmark_peers.py.

    python -m scripts.benchmark_hard_wall --points 256 512 1024 -o results/benchmark_hard_wall.nc
"""

import argparse
import sys
import time
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from bem_adhesion.hard_wall.contact import HardWallContact
from bem_adhesion.operators import Phase, Progress
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from scripts.harness import Option, head, program, rough_surface, row

SIZE, RMS_HEIGHT, CONTACT_MODULUS = 104e-9, 1e-9, 93.7348e9
TOLERANCE = 1e-10


def surface(points: int, cutoff_mode: int, seed: int) -> tuple[np.ndarray, Grid]:
    """Heights of the paper's kind of surface with another short-wave cutoff, and their grid."""
    keys = {"roll_off_mode": 3, "cutoff_mode": cutoff_mode, "normalisation": "realised"}
    made = rough_surface(SIZE, points, RMS_HEIGHT, seed=seed, **keys)
    return made.sampled, made.grid


# Phases of a solve, by the names of the columns.
PARTS: Mapping[str, Sequence[Phase]] = {
    "transforms": ("transform",),
    "kernels": ("spectrum",),
    "extension": ("extension",),
    "contact_set": ("points", "iteration"),
}


class PhaseTimes:
    """A trace that adds up the time of every phase (s)."""

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """Count from now on, with no phase under way."""
        self.seconds: dict[str, float] = defaultdict(float)
        self._phase, self._began = "", time.perf_counter()

    def __call__(self, progress: Progress) -> None:
        now = time.perf_counter()
        self.seconds[self._phase] += now - self._began
        self._phase, self._began = progress.phase, now


def measure(height: np.ndarray, grid: Grid, relative_pressure: float, repeat: int) -> dict[str, float]:
    """One line of the table: medians over the runs.

    ``relative_pressure`` is the mean pressure over √<p²>, the root-mean-square stress of full contact.
    """
    slope_power = grid.wavenumber**2 * grid.variances(fourier.transform(height))
    mean_pressure = relative_pressure * 0.5 * CONTACT_MODULUS * np.sqrt(slope_power.sum())
    times = PhaseTimes()
    contact = HardWallContact(height, grid, CONTACT_MODULUS, tolerance=TOLERANCE, trace=times)
    contact.step(contact.separated(), mean_pressure)  # compiles and plans
    seconds, shares = [], []
    for _ in range(repeat):
        times.restart()
        began = time.perf_counter()
        found = contact.step(contact.separated(), mean_pressure)
        seconds.append(time.perf_counter() - began)
        shares.append([sum(times.seconds[phase] for phase in phases) / seconds[-1] for phases in PARTS.values()])
    medians = dict(zip(PARTS, np.median(shares, axis=0).tolist(), strict=True))
    return {
        "mean_pressure": mean_pressure,
        "relative_contact_area": float(np.mean(found.pressure > 0)),
        "residual": found.residual,
        "iterations": found.iterations,
        "fft_pairs": found.fft_pairs,
        "wall_time": float(np.median(seconds)),
        **{f"share_of_{part}": share for part, share in medians.items()},
    }


UNITS = {"mean_pressure": "Pa", "wall_time": "s"}


def run(options: argparse.Namespace) -> None:
    kinds = ["smooth", "broadband"]  # cutoff at 12 waves a side, and at eight points a wave
    table: dict[str, list] = {}
    parts = (part.replace("_", " ") for part in PARTS)
    print(head("surface", "points", "p/p_rms", "A/A₀", "pairs", "s", *parts, "the rest"), flush=True)
    for kind in kinds:
        for points in options.points:
            height, grid = surface(points, 12 if kind == "smooth" else points // 8, options.seed)
            for pressure in options.pressures:
                found = measure(height, grid, pressure, options.repeat)
                for name, value in found.items():
                    table.setdefault(name, []).append(value)
                shares = [found[f"share_of_{part}"] for part in PARTS]
                cells = [
                    f"{found['relative_contact_area']:.5f}",
                    f"{found['fft_pairs']:.0f}",
                    f"{found['wall_time']:.3g}",
                ]
                cells += [f"{share:.2f}" for share in [*shares, 1 - sum(shares)]]
                print(row(kind, f"{points}²", f"{pressure:g}", *cells), flush=True)
    if options.output is not None:
        _write(table, kinds, options)


def _write(table: dict[str, list], kinds: Sequence[str], options: argparse.Namespace) -> None:
    shape = (len(kinds), len(options.points), len(options.pressures))
    dimensions = ("surface", "points", "relative_pressure")
    dataset = xr.Dataset(
        {
            name: (dimensions, np.reshape(values, shape), {"units": UNITS.get(name, "1")})
            for name, values in table.items()
        },
        coords={"surface": kinds, "points": options.points, "relative_pressure": options.pressures},
        attrs={"title": "Hard-wall solver: work and time", "tolerance": TOLERANCE},
    )
    options.output.parent.mkdir(parents=True, exist_ok=True)
    dataset.to_netcdf(options.output)


main = program(
    run,
    Option("--points", [128, 256], "points along each side"),
    Option("--pressures", [0.01, 0.15, 0.5, 2.0, 3.0], "mean pressures over the rms stress of full contact"),
    Option("--seed", 1, "surface"),
    Option("--repeat", 3, "runs of each solve; medians are shown"),
    Option("-o, --output", Path, "NetCDF file to write as well"),
)

if __name__ == "__main__":
    sys.exit(main())
