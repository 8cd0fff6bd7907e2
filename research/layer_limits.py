"""Contact of a layer between its limits: the half-space where it is thick, a closed form where it is thin.

The paper's surface on a hard wall, and a sphere on the thinnest layers; `research/notes/elasticity.md` explains the
columns.

    python -m research.layer_limits --figure layer_limits.png
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from bem_adhesion.hard_wall.contact import HardWallContact
from bem_adhesion.solution import Solution
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import Elasticity, HalfSpace, Layer
from contact_study.plots.style import COLOURS, DOUBLE, styled
from contact_study.study.case import realise
from contact_study.study.study import read_study
from scripts.harness import STUDY, Option, program, save, show
from theory.non_adhesive.closed_forms import relative_contact_area

THICKNESSES = (1.0, 0.5, 0.25, 0.1, 0.03, 0.01)  # over the cell
RATIOS = (0.3, 0.5)
PRESSURE = 0.01  # over E*


def run(given: argparse.Namespace) -> int:
    surface = realise(read_study(given.study).cases[0])
    grid = Grid((given.points, given.points), surface.size)
    heights, spectrum = surface.heights(grid.shape), surface.measured_spectrum()

    def areas(solid: Elasticity) -> tuple[float, float]:
        """Contact area of the solver and of Persson's theory without adhesion."""
        found = pressed(heights, grid, solid, PRESSURE)
        variance = spectrum.full_contact_stress_variance(solid.stiffness)
        return float(np.mean(found.pressure > 0)), float(relative_contact_area(PRESSURE, variance))

    rows = {"half-space": [areas(HalfSpace(1.0))] * len(RATIOS)}
    for thickness in THICKNESSES:
        rows[f"{thickness:g}"] = [areas(Layer(1.0, ratio, thickness * max(grid.size))) for ratio in RATIOS]
    names = (name for ratio in RATIOS for name in (f"A, ν = {ratio:g}", "Persson"))
    show(("d/L", *names), ((name, *(f"{area:.4f}" for pair in pairs for area in pair)) for name, pairs in rows.items()))
    print()
    spheres = (
        (
            f"{thickness / 0.25:g}",
            *(f"{100 * error:+.2f} %" for r in (0.2, 0.5) for error in sphere(thickness, r, given.points)),
        )
        for thickness in (0.02, 0.01, 0.005)
    )
    show(("d/a", "peak, ν = 0.2", "radius", "peak, ν = 0.5", "radius"), spheres)
    if given.figure is not None:
        save(drawn(rows), given.figure)


def pressed(heights: np.ndarray, grid: Grid, solid: Elasticity, pressure: float) -> Solution:
    """The contact with a hard wall."""
    contact = HardWallContact(heights, grid, solid)
    return contact.step(contact.separated(), pressure)


def sphere(thickness: float, ratio: float, points: int) -> tuple[float, float]:
    """Errors of peak pressure and contact radius against the thin layer's closed form; cell and E* are one."""
    wanted, radius = 0.25, 100.0
    grid = Grid((points, points), (1.0, 1.0))
    x = grid.coordinates[0] - 0.5
    layer = Layer(1.0, ratio, thickness)
    if ratio < 0.5:
        spring = 1 / layer.mean_compliance
        force, peak = np.pi * spring * wanted**4 / (4 * radius), spring * wanted**2 / (2 * radius)
    else:
        flow = 0.25 / (32 * radius * thickness**3)  # the shear modulus is E*/4
        force, peak = np.pi * flow * wanted**6, 3 * flow * wanted**4
    found = pressed(-(x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius), grid, layer, force)
    reached = np.sqrt(np.mean(found.pressure > 0) / np.pi)
    return float(found.pressure.max() / peak - 1), float(reached / wanted - 1)


@styled
def drawn(rows: dict[str, list[tuple[float, float]]]) -> Figure:
    """K(q) of layers beside its limits, and the areas."""
    figure = Figure(figsize=(DOUBLE, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    x = np.geomspace(0.03, 20, 200)
    for number, ratio in enumerate(RATIOS):
        layer, colour = Layer(1.0, ratio, 1.0), COLOURS[number]
        left.loglog(x, layer.stiffness(x), colour, label=f"layer, ν = {ratio:g}")
        thin = np.full_like(x, 1 / layer.mean_compliance) if ratio < 0.5 else 0.75 / x**2
        left.loglog(x, thin, colour, linestyle=":", label="thin limit")
        area, theory = np.array([rows[f"{d:g}"][number] for d in THICKNESSES]).T
        right.semilogx(THICKNESSES, area, colour, marker="o", label=f"ν = {ratio:g}")
        right.semilogx(THICKNESSES, theory, colour, linestyle="--", label="Persson's theory")
    left.loglog(x, HalfSpace(1.0).stiffness(x), "k--", label="half-space")
    right.axhline(rows["half-space"][0][0], color="k", linestyle=":", label="half-space")
    left.set(xlabel="qd", ylabel="K d/E*", ylim=(0.2, 100))
    right.set(xlabel="d/L", ylabel=f"relative contact area, p = {PRESSURE:g} E*")
    left.legend(loc="upper right")
    right.legend()
    return figure


main = program(
    run,
    STUDY,
    Option("--points", 256, "points along each side"),
    Option("--figure", Path, "draw area and K(q), too"),
)

if __name__ == "__main__":
    sys.exit(main())
