"""Spheres on a free half-space against closed forms: Hertz without adhesion, Maugis from JKR to DMT with it.

`docs/validation.md` explains the columns.

    python -m scripts.validate_spheres hertz --figure docs/images/hertz_sphere.png
    python -m scripts.validate_spheres maugis --tabor 2 3 --ramp 0.2 --most-points 400 --table data/maugis_spheres.csv
    python -m scripts.validate_spheres maugis --from data/maugis_spheres.csv --figure maugis_spheres.png
    python -m scripts.validate_spheres ramp
"""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from bem_adhesion import Dugdale, HardWall, rough_contact
from bem_adhesion.solution import Solution
from contact_study.plots.style import COLOURS, DOUBLE, styled
from scripts.harness import Option, head, per_cent, program, row, save, show
from theory import MaugisDugdale, maugis_of_tabor

TABOR_PARAMETERS = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0)
FORCES = (2.0, 0.0)  # over πwR, at which radius and approach are compared
WORK_OF_ADHESION = 0.02  # in units of E* and of the reach of the tension: a scale, without consequence
RAMP = 0.05
RAMPS = (0.2, 0.1, 0.05, 0.02, 0.01)
POINTS_PER_ZONE = 4
FEWEST_POINTS, MOST_POINTS = 96, 192
FORCE_RESOLUTION = 0.005  # of the pull-off force, over πwR
# Of a sphere, beside its states, in its file.
COLUMNS = ("tabor", "ramp", "points", "points_per_zone", "held", "lost", "pairs", "seconds")
HERTZ_POINTS = (32, 64, 128, 256)
HERTZ_ERRORS = ("radius", "approach", "peak pressure", "rms pressure", "elastic energy")
# Of Hertz' sphere, in units of its radius and of E*.
SPHERE_RADIUS, CONTACT_RADIUS, CELL = 1.0, 0.1, 0.4
HERTZ_FORCE = 4 * CONTACT_RADIUS**3 / (3 * SPHERE_RADIUS)
HERTZ_PEAK = 2 * CONTACT_RADIUS / (np.pi * SPHERE_RADIUS)


def run(given: argparse.Namespace) -> None:
    figure = None
    if given.what == "hertz":
        errors = np.array([hertz_errors(points) for points in HERTZ_POINTS])
        print_hertz(errors)
        figure = hertz_figure
    elif given.what == "maugis":
        spheres = []
        compared = (name for force in FORCES for name in (f"a at {force:g}", f"δ at {force:g}"))
        print(head("μ", "λ", "ramp", "points", "per zone", "pull-off", "Maugis", "difference", *compared), flush=True)
        for each in read(given.source) if given.source else solved_spheres(given):
            spheres.append(each)
            print(maugis_row(each), flush=True)
        if given.source:
            print(f"\nCPU time: {', '.join(f'{each.seconds:.2g}' for each in spheres)} s.")
        figure, errors = maugis_figure, spheres
    else:
        rows = ((f"{ramp:g}", solved(0.5, ramp)) for ramp in RAMPS)
        cells = ((ramp, *pull_off_cells(found), f"{found.pairs:.0f}") for ramp, found in rows)
        show(("ramp", "pull-off", "Maugis", "difference", "pairs"), cells)
    if given.figure and figure:
        save(figure(errors), given.figure)


def sphere(points: int, size: float, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Heights −r²/2R, zero at the apex in the middle, and r."""
    axis = (np.arange(points) - points // 2) * size / points
    r2 = axis[:, None] ** 2 + axis**2
    return -r2 / (2 * radius), np.sqrt(r2)


def hertz(points: int) -> tuple[np.ndarray, Solution]:
    """Distances from the apex and the state of a sphere under the load of Hertz' contact radius."""
    height, r = sphere(points, CELL, SPHERE_RADIUS)
    contact = rough_contact(height, CELL, 1.0, HardWall(), boundary="free")
    return r, contact.step(contact.separated(), HERTZ_FORCE / CELL**2)


def hertz_pressure(r: np.ndarray) -> np.ndarray:
    """Hertz' pressure at distances from the apex, over its largest."""
    return np.sqrt(np.clip(1 - (r / CONTACT_RADIUS) ** 2, 0, None))


def hertz_errors(points: int) -> np.ndarray:
    """Errors of contact radius, approach, peak pressure, rms pressure and elastic energy, in units of Hertz' values."""
    r, found = hertz(points)
    approach = CONTACT_RADIUS**2 / SPHERE_RADIUS
    return np.array(
        [
            np.sqrt(np.mean(found.pressure > 0) * CELL**2 / np.pi) / CONTACT_RADIUS - 1,
            -found.plane / approach - 1,
            found.pressure.max() / HERTZ_PEAK - 1,
            np.sqrt(np.mean((found.pressure / HERTZ_PEAK - hertz_pressure(r)) ** 2)),
            found.elastic_energy * CELL**2 / (0.4 * HERTZ_FORCE * approach) - 1,
        ]
    )


@styled
def hertz_figure(errors: np.ndarray) -> Figure:
    """Pressure over the distance from the apex on the coarsest grids, and how the errors fall."""
    figure = Figure(figsize=(DOUBLE, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    line = np.linspace(0, CONTACT_RADIUS, 300)
    for points, marker, colour in ((HERTZ_POINTS[0], "o", COLOURS[0]), (HERTZ_POINTS[1], "x", COLOURS[1])):
        r, found = hertz(points)
        near = r < 1.2 * CONTACT_RADIUS
        pressures = found.pressure[near] / HERTZ_PEAK
        left.plot(r[near] / CONTACT_RADIUS, pressures, marker, color=colour, ms=3.5, label=f"{points}² points")
    left.plot(line / CONTACT_RADIUS, hertz_pressure(line), "k", lw=0.8, label="Hertz")
    left.set(xlabel="distance from the apex / contact radius", ylabel="pressure / Hertz' largest")
    left.legend()
    spacings = [CELL / CONTACT_RADIUS / points for points in HERTZ_POINTS]
    for name, column, colour in zip(HERTZ_ERRORS, np.abs(errors).T, COLOURS, strict=False):
        right.loglog(spacings, column, "o-", ms=3.5, color=colour, label=name)
    right.set(xlabel="spacing / contact radius", ylabel="relative error")
    right.set_xticks(spacings, [f"1/{round(1 / spacing)}" for spacing in spacings])
    right.minorticks_off()
    right.legend()
    return figure


def print_hertz(errors: np.ndarray) -> None:
    rates = np.log2(np.abs(errors[0] / errors[-1])) / np.log2(HERTZ_POINTS[-1] / HERTZ_POINTS[0])
    rows = [(n, *(f"{100 * error:+.3f} %" for error in each)) for n, each in zip(HERTZ_POINTS, errors, strict=True)]
    show(("points over 4 radii", *HERTZ_ERRORS), [*rows, ("order", *(f"{rate:.1f}" for rate in rates))])


@dataclass(frozen=True)
class Sphere:
    """What was found of one sphere, in Maugis' units."""

    tabor: float
    theory: MaugisDugdale
    ramp: float
    points: int
    points_per_zone: float
    held: float
    lost: float
    states: list[tuple[float, float, float]]
    pairs: float
    seconds: float

    @property
    def pull_off(self) -> float:
        """Between what held and what did not."""
        return 0.5 * (self.held + self.lost)


def theory_of(tabor: float) -> MaugisDugdale:
    """The sphere of a Tabor parameter in Maugis' units, z₀ the range of the tension."""
    return MaugisDugdale.of_parameter(float(maugis_of_tabor(tabor, relative_strength=1.0)))


def solved(
    tabor: float, ramp: float = RAMP, most_points: int = MOST_POINTS, points_per_zone: float = POINTS_PER_ZONE
) -> Sphere:
    """A sphere under Dugdale's law of unit reach, E* = 1: pressed, released, pulled until it lets go."""
    work = WORK_OF_ADHESION
    radius = tabor**3 / work**2
    unit, length = np.pi * work * radius, (3 * np.pi * work * radius**2 / 4) ** (1 / 3)
    theory = theory_of(tabor)
    # Room for the contact, and for the ring that the tension reaches.
    size = 3.4 * max(theory.at_force(2.0)[2] * length, np.sqrt(2 * radius))
    points = int(np.clip(2 * np.ceil(points_per_zone * size * work / 2), FEWEST_POINTS, most_points))
    height, _ = sphere(points, size, radius)
    contact = rough_contact(height, size, 1.0, Dugdale(work, 1.0, ramp), boundary="free")
    state, pairs, states, began = contact.separated(), 0.0, [], time.process_time()

    def at(force: float) -> bool:
        nonlocal state, pairs
        found = contact.step(state, force * unit / size**2)
        pairs += found.fft_pairs
        if not found.converged:
            raise RuntimeError(f"Tabor parameter {tabor:g}, force {force:g}: {found.message}")
        if found.detached:
            return False
        state = found.state
        touching = np.sqrt(np.mean(found.gap == 0) * size**2 / np.pi)
        states.append((force, touching / length, -found.plane / (length**2 / radius)))
        return True

    # Coarse grids hold on for longer: a bracket for all of them.
    held, lost = -0.9 * theory.pull_off_force, -1.6 * theory.pull_off_force
    for force in (*FORCES, -0.5 * held, -held):
        if not at(force):
            raise RuntimeError(f"Tabor parameter {tabor:g}: let go at {force:g} already")
    while lost - held > FORCE_RESOLUTION:
        tried = 0.5 * (held + lost)
        held, lost = (tried, lost) if at(-tried) else (held, tried)
    seconds = time.process_time() - began
    return Sphere(tabor, theory, ramp, points, points / (size * work), held, lost, states, pairs, seconds)


def solved_spheres(given: argparse.Namespace) -> Iterator[Sphere]:
    """A sphere for each Tabor parameter, added to the file as soon as it is there."""
    for tabor in given.tabor:
        found = solved(tabor, given.ramp, given.most_points, given.points_per_zone)
        if given.table:
            written(found).to_csv(
                given.table, mode="a", header=not given.table.exists(), index=False, float_format="%.6g"
            )
        yield found


def written(sphere: Sphere) -> pd.DataFrame:
    """A state a row."""
    table = pd.DataFrame(sphere.states, columns=["force", "radius", "approach"])
    for name in COLUMNS:
        table[name] = getattr(sphere, name)
    return table


def read(path: Path) -> list[Sphere]:
    """The spheres of a file that :func:`solved_spheres` wrote, by Tabor parameter."""
    spheres = []
    for (tabor, _, _), rows in pd.read_csv(path).groupby(["tabor", "ramp", "points"]):
        states = list(rows[["force", "radius", "approach"]].itertuples(index=False, name=None))
        spheres.append(Sphere(theory=theory_of(tabor), states=states, **rows[list(COLUMNS)].iloc[0]))
    return spheres


def pull_off_cells(found: Sphere) -> tuple[str, str, str]:
    """Pull-off force of the solver, of Maugis, and their difference."""
    expected = -found.theory.pull_off_force
    return f"{found.pull_off:.3f}", f"{expected:.3f}", per_cent(found.pull_off, expected)


def maugis_row(found: Sphere) -> str:
    """A sphere's line of the table."""
    cells = []
    for force, radius, approach in found.states[: len(FORCES)]:
        _, own_approach, own_radius = found.theory.at_force(force)
        cells += [per_cent(radius, own_radius), f"{approach - own_approach:+.3f}"]
    first = f"{found.tabor:g}", f"{found.theory.parameter:.3g}", f"{found.ramp:g}", f"{found.points:.0f}²"
    return row(*first, f"{found.points_per_zone:.2g}", *pull_off_cells(found), *cells)


@styled
def maugis_figure(spheres: Sequence[Sphere]) -> Figure:
    """Pull-off over the Tabor parameter, and contact radius over the force, of solver (finest grids) and Maugis."""
    spheres = list({each.tabor: each for each in sorted(spheres, key=lambda each: (each.tabor, each.points))}.values())
    figure = Figure(figsize=(DOUBLE, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    mu = np.geomspace(0.03, 8, 80)
    left.semilogx(mu, [-theory_of(each).pull_off_force for each in mu], "0.5", label="Maugis")
    tabor = [each.tabor for each in spheres]
    left.plot(tabor, [each.pull_off for each in spheres], "o", color=COLOURS[0], ms=4, label="solver")
    for limit, name, at in ((1.5, "JKR", "bottom"), (2.0, "DMT", "top")):
        left.axhline(limit, color="k", linestyle=":", lw=0.8)
        left.text(mu[0] if name == "JKR" else mu[-1], limit, name, va=at, ha="left" if name == "JKR" else "right")
    left.set(xlabel="Tabor parameter μ", ylabel="pull-off force / πwR")
    left.legend()
    drawn = spheres[:: 1 + (len(spheres) - 1) // len(COLOURS)]
    for each, colour in zip(drawn, COLOURS, strict=False):
        points = np.array([state[:2] for state in each.states])
        force, _, radius, _ = each.theory.curve(2.0)
        stable = np.arange(force.size) >= np.argmin(force)
        right.plot(force[stable], radius[stable], color=colour)
        right.plot(*points.T, "o", color=colour, ms=3.2, label=f"μ = {each.tabor:g}")
    right.set(xlabel="force / πwR", ylabel="contact radius / (3πwR²/4E*)$^{1/3}$")
    right.legend()
    return figure


main = program(
    run,
    Option("what", str, "table to print", choices=("hertz", "maugis", "ramp")),
    Option("--tabor", list(TABOR_PARAMETERS), "Tabor parameters"),
    Option("--most-points", MOST_POINTS, "most points along each side"),
    Option("--points-per-zone", POINTS_PER_ZONE, "points to the process zone, as far as these go"),
    Option("--ramp", RAMP, "width of the tension's end, over its reach (maugis)"),
    Option("--table", Path, "CSV to add the spheres' states to (maugis)"),
    Option("--from", Path, "CSV to read them from, in place of a run (maugis)"),
    Option("--figure", Path, "draw pressures and errors (hertz), or pull-off and radius, too"),
)

if __name__ == "__main__":
    sys.exit(main())
