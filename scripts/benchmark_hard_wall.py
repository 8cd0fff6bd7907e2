"""Work and time of the hard-wall solver over grids, pressures and kinds of surface, as a Markdown table.

Transform pairs (as float64 pairs on the finest grid, a count that does not depend on the machine) and where the time
goes. Other codes are in benchmark_peers.py.

    python -m scripts.benchmark_hard_wall --points 256 512 1024 -o results/benchmark_hard_wall.nc
"""

import argparse
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from unittest import mock

import numpy as np
import xarray as xr

from bem_adhesion.hard_wall import kernels as contact_passes
from bem_adhesion.hard_wall.contact import HardWallContact
from bem_adhesion.hard_wall.preconditioner import Extension
from bem_adhesion.operators import fourier as operator
from bem_adhesion.solution import Solution
from contact_study.numerics import fourier
from contact_study.numerics.fourier import RealTransform
from contact_study.numerics.grid import Grid
from contact_study.study.case import realise
from contact_study.study.study import make_study

SIZE, RMS_HEIGHT, CONTACT_MODULUS = 104e-9, 1e-9, 93.7348e9
TOLERANCE = 1e-10


def surface(points: int, cutoff_mode: int, seed: int) -> tuple[np.ndarray, Grid]:
    """Heights of the paper's kind of surface with another short-wave cutoff, and their grid."""
    study = make_study(
        {
            "surface": {
                "kind": "self_affine",
                "size": SIZE,
                "shape": [points, points],
                "hurst_exponent": 0.8,
                "rms_height": RMS_HEIGHT,
                "roll_off_mode": 3,
                "cutoff_mode": cutoff_mode,
                "seed": seed,
                "normalisation": "realised",
            },
            "material": {"youngs_modulus": 77.2e9, "poissons_ratio": 0.42},
            "interaction": {"law": "hard_wall"},
            "loading": {"path": [1e9]},
        }
    )
    return realise(study.cases[0]).sampled, Grid((points, points), (SIZE, SIZE))


def ours(height: np.ndarray, grid: Grid, mean_pressure: float) -> Solution:
    """The contact from separation."""
    contact = HardWallContact(height, grid, CONTACT_MODULUS, tolerance=TOLERANCE)
    return contact.step(contact.separated(), mean_pressure)


# What the time goes into, by who does it.
PARTS: Mapping[str, Sequence[tuple[object, str]]] = {
    "transforms": [(RealTransform, name) for name in ("forward", "backward")],
    "kernels": [(operator, name) for name in ("_multiply_spectrum", "_multiply_and_sum")],
    "extension": [(Extension, name) for name in ("update", "extend", "transpose")],
    "contact_set": [
        (contact_passes, name)
        for name in ("offset", "enter", "residual", "products", "turn", "advance", "leave", "rescale", "refine")
    ],
}


@contextmanager
def timed_parts() -> Iterator[dict[str, float]]:
    """Add up the durations of all parts of a solve done inside (s)."""
    total = dict.fromkeys(PARTS, 0.0)

    def timed(part: str, call: Callable) -> Callable:
        def timed_call(*arguments, **options):
            began = time.perf_counter()
            result = call(*arguments, **options)
            total[part] += time.perf_counter() - began
            return result

        return timed_call

    with ExitStack() as stack:
        for part, members in PARTS.items():
            for owner, name in members:
                stack.enter_context(mock.patch.object(owner, name, timed(part, getattr(owner, name))))
        yield total


def measure(height: np.ndarray, grid: Grid, relative_pressure: float, repeat: int) -> dict[str, float]:
    """One line of the table: medians over the runs.

    ``relative_pressure`` is the mean pressure over √<p²>, the root-mean-square stress of full contact.
    """
    slope_power = grid.wavenumber**2 * grid.variances(fourier.transform(height))
    mean_pressure = relative_pressure * 0.5 * CONTACT_MODULUS * np.sqrt(slope_power.sum())
    ours(height, grid, mean_pressure)  # compile and plan
    seconds, shares = [], []
    for _ in range(repeat):
        with timed_parts() as durations:
            began = time.perf_counter()
            found = ours(height, grid, mean_pressure)
            seconds.append(time.perf_counter() - began)
        shares.append([duration / seconds[-1] for duration in durations.values()])
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


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter
    )
    parser.add_argument("--points", type=int, nargs="+", default=[128, 256], help="points along each side")
    parser.add_argument(
        "--pressures",
        type=float,
        nargs="+",
        default=[0.01, 0.15, 0.5, 2.0, 3.0],
        help="mean pressures over the rms stress of full contact",
    )
    parser.add_argument("--seed", type=int, default=1, help="surface")
    parser.add_argument("--repeat", type=int, default=3, help="runs of each solve; medians are shown")
    parser.add_argument("-o", "--output", type=Path, help="NetCDF file to write as well")
    options = parser.parse_args(arguments)

    kinds = ["smooth", "broadband"]  # cutoff at 12 waves a side, and at eight points a wave
    table: dict[str, list] = {}
    parts = " | ".join(part.replace("_", " ") for part in PARTS)
    print(f"| surface | points | p/p_rms | A/A₀ | pairs | s | {parts} | the rest |")
    print("|---" * (7 + len(PARTS)) + "|")
    for kind in kinds:
        for points in options.points:
            height, grid = surface(points, 12 if kind == "smooth" else points // 8, options.seed)
            for pressure in options.pressures:
                row = measure(height, grid, pressure, options.repeat)
                for name, value in row.items():
                    table.setdefault(name, []).append(value)
                area, pairs, seconds = row["relative_contact_area"], row["fft_pairs"], row["wall_time"]
                shares = [row[f"share_of_{part}"] for part in PARTS]
                cells = " | ".join(f"{share:.2f}" for share in [*shares, 1 - sum(shares)])
                line = f"{kind} | {points}² | {pressure:g} | {area:.5f} | {pairs:.0f} | {seconds:.3g}"
                print(f"| {line} | {cells} |", flush=True)
    if options.output is not None:
        _write(table, kinds, options)
    return 0


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


if __name__ == "__main__":
    sys.exit(main())
