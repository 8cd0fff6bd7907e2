"""Approach and pull-off at a given speed: hysteresis of the atoms at zero temperature and warm.

The rigid plane on top of the explicit block comes down at one speed, turns, and goes up until nothing is in reach. The
stress and the work are those of the interface over the whole motion, frame by frame. Loops that the table on disk has
already are not run again. `research/notes/temperature.md` shows figure and table.

    python -m research.driven_loops data/yang2008.toml --fraction 0.5 --highest 28 --table data/driven_loops.csv
    python -m research.driven_loops --from data/driven_loops.csv -o docs/images/driven_loops_200.png
"""

import argparse
import itertools
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from scipy.integrate import trapezoid

import contact_study
from contact_study.campaign.store.files import writable_output
from contact_study.inputs.errors import InputError
from contact_study.plots.style import COLOURS, DOUBLE, styled
from contact_study.study.study import read_study
from scripts.harness import PAPER, Option, program, save, show, shrunk, write_rows

DAMPING = "0.3 ps^-1"  # of motion against the plane; near the critical one of the block's slowest wave
FRAMES = 5  # of each step of the path
ANGSTROM = 1e-10


@dataclass(frozen=True)
class Loop:
    """A motion: ε over ε₀, distances of the driven plane less r0 (m), mean stresses (Pa), which go down, time steps."""

    ratio: float
    distance: np.ndarray
    stress: np.ndarray
    down: np.ndarray
    steps: int

    @property
    def words(self) -> str:
        """ε in words."""
        return f"{self.ratio:g} ε₀"

    @property
    def pull_off(self) -> float:
        """Largest tension on the way up (Pa)."""
        return float(-np.min(self.stress[~self.down], initial=0.0))

    @property
    def dissipated(self) -> float:
        """Work that the motion leaves behind, per area (J/m²)."""
        return float(-trapezoid(self.stress, self.distance))

    def contact(self, down: bool) -> float:
        """Where tension above a tenth of the largest begins on the way down, or ends on the way up (m)."""
        side = self.down == down
        touching = np.flatnonzero(self.stress[side] < -0.1 * self.pull_off)
        if not touching.size:
            return np.nan
        return float(self.distance[side][touching[0 if down else -1]])


def run(given: argparse.Namespace) -> None:
    if given.output is not None:
        writable_output(given.output)
    loops = read(given.source) if given.source is not None else moved(given)
    names = sorted({loop.ratio: loop.words for of in loops.values() for loop in of}.items())
    quantities = (
        ("attracted from (Å)", lambda loop: f"{loop.contact(True) / ANGSTROM:.1f}"),
        ("held up to (Å)", lambda loop: f"{loop.contact(False) / ANGSTROM:.1f}"),
        ("pull-off stress (GPa)", lambda loop: f"{loop.pull_off / 1e9:.2f}"),
        ("work left behind (J/m²)", lambda loop: f"{loop.dissipated:.3f}"),
        ("time steps", lambda loop: f"{loop.steps}"),
    )
    rows = []
    for (words, value), (temperature, of) in itertools.product(quantities, loops.items()):
        cells = {loop.ratio: value(loop) for loop in of}
        rows.append((words, temperature, *(cells.get(ratio, "") for ratio, _ in names)))
    show(("", "T", *(words for _, words in names)), rows)
    if given.output is not None:
        save(picture(loops), given.output)


def moved(given: argparse.Namespace) -> dict[str, list[Loop]]:
    """The motions of each temperature; those that the table on disk has are read, each new one is added to it."""
    table = driven(given)
    ratios = table["sweep"].pop("interaction.well_depth_ratio")
    loops = read(given.table) if given.table is not None and given.table.exists() else {}
    for temperature in given.temperatures:
        table["atomistic"]["temperature"] = temperature
        of = loops.setdefault(temperature, [])
        for ratio in ratios:
            if ratio in [loop.ratio for loop in of]:
                continue
            table["sweep"]["interaction.well_depth_ratio"] = [ratio]
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "md.nc"
                contact_study.run(table, "atomistic", output=path)
                with xr.open_datatree(path, decode_timedelta=False) as tree:
                    of += loops_of(tree["/"].to_dataset(), tree["/trajectory"].to_dataset())
            of.sort(key=lambda loop: loop.ratio)
            if given.table is not None:
                write(loops, given.table)
    return loops


def write(loops: dict[str, list[Loop]], path: Path) -> None:
    """Store motions, a row a frame."""
    rows = [
        pd.DataFrame(
            {
                "temperature": temperature,
                "ratio": loop.ratio,
                "steps": loop.steps,
                "down": loop.down.astype(int),
                "distance_A": loop.distance / ANGSTROM,
                "stress_GPa": loop.stress / 1e9,
            }
        )
        for temperature, of in loops.items()
        for loop in of
    ]
    write_rows(pd.concat(rows), path)


def read(path: Path) -> dict[str, list[Loop]]:
    """What :func:`write` stored."""
    loops: dict[str, list[Loop]] = {}
    for (temperature, ratio, steps), rows in pd.read_csv(path).groupby(["temperature", "ratio", "steps"]):
        distance, stress = rows.distance_A.to_numpy() * ANGSTROM, rows.stress_GPa.to_numpy() * 1e9
        loop = Loop(float(ratio), distance, stress, rows.down.to_numpy(bool), int(steps))
        loops.setdefault(str(temperature), []).append(loop)
    return loops


def driven(given: argparse.Namespace) -> dict:
    """The study with its lengths at a fraction, driven down and up again."""
    whole = read_study(given.study)
    if "interaction.well_depth_ratio" not in whole.table.get("sweep", {}):
        raise InputError(f"{given.study}: sweeps no interaction.well_depth_ratio")
    if not given.lowest < given.highest or given.step <= 0:
        raise InputError("--lowest must be below --highest, and --step positive")
    table = {name: content for name, content in shrunk(whole, given.fraction).items() if name != "override"}
    if given.ratios is not None:
        table["sweep"] = {"interaction.well_depth_ratio": given.ratios}
    count = round((given.highest - given.lowest) / given.step) + 1
    points = np.linspace(given.highest, given.lowest, max(count, 2)) * ANGSTROM
    return {
        **table,
        "loading": {"control": "gap", "path": points.tolist(), "unload": True},
        "atomistic": {**table.get("atomistic", {}), "method": "dynamics"},
        "dynamics": {
            "damping": DAMPING,
            "approach_speed": given.speed,
            "frames": FRAMES,
            **({} if given.time_step is None else {"time_step": given.time_step}),
        },
        "output": {},
    }


def loops_of(root: xr.Dataset, series: xr.Dataset) -> list[Loop]:
    """The motion of each case, frame by frame."""
    found = []
    for number, ratio in enumerate(root.well_depth_ratio.values):
        case, frames = root.isel(well_depth_ratio=number), series.isel(well_depth_ratio=number)
        end = case.applied_gap.values
        # The first point is reached from out of reach; the plane moves evenly from one point to the next, in time steps
        # that its frames share.
        steps = case.iterations.values[1:, None]
        share = steps * (np.arange(FRAMES) + 1) // FRAMES / steps
        distance = np.append(end[0], end[:-1, None] + np.diff(end)[:, None] * share)
        stress = frames.mean_pressure.values.ravel()[FRAMES - 1 :]
        down = np.append(True, np.repeat(np.diff(end) < 0, FRAMES))
        found.append(Loop(float(ratio), distance, stress, down, int(case.iterations.sum())))
    return found


@styled
def picture(loops: dict[str, list[Loop]]) -> Figure:
    """Stress against the distance of the driven plane, a panel a depth of the well."""
    ratios = sorted({loop.ratio: loop.words for of in loops.values() for loop in of}.items())
    figure = Figure(figsize=(DOUBLE, 2.6), layout="constrained")
    panels = np.atleast_1d(figure.subplots(1, len(ratios)))
    for axes, (ratio, words) in zip(panels, ratios, strict=True):
        drawn = [
            (colour, temperature, loop)
            for colour, (temperature, of) in zip(COLOURS, loops.items(), strict=False)
            for loop in of
            if loop.ratio == ratio
        ]
        for colour, temperature, loop in drawn:
            for side, line in ((loop.down, "-"), (~loop.down, "--")):
                label = f"{temperature}, {'down' if line == '-' else 'up'}"
                axes.plot(
                    loop.distance[side] / ANGSTROM, loop.stress[side] / 1e9, line, color=colour, lw=0.9, label=label
                )
        axes.axhline(0, color="#909090", lw=0.7, zorder=1)
        axes.set_title(words, fontsize=8.5)
        axes.set_xlabel("distance of the plane (Å)")
    panels[0].set_ylabel("mean stress (GPa)")
    max(panels, key=lambda axes: len(axes.lines)).legend()
    return figure


main = program(
    run,
    Option("study", PAPER, "study with lattice constant and atom mass, over well_depth_ratio"),
    Option("-o, --output", Path, "figure to write"),
    Option("--table", Path, "CSV to add the motions to"),
    Option("--from", Path, "CSV to print, in place of runs"),
    Option("--fraction", 1.0, "of the study's lengths: its cell and rms height"),
    Option("--speed", "20 m/s", "of the driven plane"),
    Option("--time-step", str, "of the motion; a fifth of the largest stable one by default"),
    Option("--temperatures", ["0 K", "300 K"], "of the atoms"),
    Option("--ratios", float, "multiples of the well depth; the study's by default", nargs="+"),
    Option("--highest", 18.0, "separation that the way up ends at (Å)"),
    Option("--lowest", -3.0, "separation at which the plane turns (Å)"),
    Option("--step", 1.0, "between points of the path (Å)"),
)

if __name__ == "__main__":
    sys.exit(main())
