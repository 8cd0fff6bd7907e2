"""What an adhesive loop costs on a viscoelastic half-space: dissipation and pull against its duration.

A small self-affine surface under a Lennard-Jones law comes down and goes up again, the mean gap changing evenly; then
the order of the steps of time. `research/notes/viscoelasticity.md` explains the columns.

    python -m research.viscoelastic_loop --figure viscoelastic_loop.png
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from bem_adhesion import LennardJones93, Viscoelastic, ViscoelasticContact, rough_contact
from bem_adhesion.study.path_in_time import TimeState, steps_in_time
from contact_study.physics.surfaces.surface import Surface
from contact_study.plots.style import COLOURS, DOUBLE, styled
from contact_study.study.case import realise
from contact_study.study.study import read_study
from scripts.harness import STUDY, Option, per_cent, program, save, show, walk

RELAXED, BRANCH, TIME = 1e9, 9e9, 1.0
LAW = LennardJones93(work_of_adhesion=0.02, length=1e-9)
# Mean gaps above the law's distance, from next to no contact to a fifth of the rms height.
OUT, IN = 3.5e-9, 0.2e-9
DURATIONS = (1e-3, 1e-2, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0, 1000.0)


@dataclass(frozen=True)
class Loop:
    """Gaps (m) and mean pressures (Pa) on the way in and out, and energies per area (J/m²)."""

    gaps: np.ndarray
    pressures: np.ndarray
    dissipated: float

    @property
    def work(self) -> float:
        """−∮ p du by the trapezoidal rule."""
        return float(-np.sum(0.5 * (self.pressures[1:] + self.pressures[:-1]) * np.diff(self.gaps)))


def run(given: argparse.Namespace) -> None:
    surface = realise(read_study(given.study).cases[0])
    heights = surface.heights((given.points, given.points))
    loops = {f"{duration:g}": loop(heights, surface, duration, given.steps) for duration in DURATIONS}
    limits = {name: elastic(heights, surface, modulus, given.steps) for name, modulus in (("E0", 1e10), ("E∞", 1e9))}
    rows = []
    for name, found in {"elastic, E0": limits["E0"], **loops, "elastic, E∞": limits["E∞"]}.items():
        lost = "" if name.startswith("elastic") else f"{1e3 * found.dissipated:.3f}"
        extremes = f"{found.pressures.max() / 1e6:.1f}", f"{found.pressures.min() / 1e6:.2f}"
        rows.append((name, lost, f"{1e3 * found.work:.3f}", *extremes))
    show(("T/τ", "dissipated", "−∮ p du", "most pressed", "most pulled"), rows)
    finest = loop(heights, surface, TIME, 8 * given.steps).dissipated
    rows = []
    for steps in (given.steps // 4, given.steps // 2, given.steps, 2 * given.steps):
        found = loop(heights, surface, TIME, steps).dissipated
        rows.append((steps, f"{1e3 * found:.4f}", per_cent(found, finest, 2)))
    print()
    show(("steps on each way", "dissipated", "difference"), rows)
    if given.figure is not None:
        save(drawn(loops, limits), given.figure)


def way(steps: int) -> np.ndarray:
    """Mean gaps in and out (m)."""
    down = np.linspace(OUT, IN, steps + 1)
    return np.concatenate([down[1:], down[-2::-1]])


def loop(heights: np.ndarray, surface: Surface, duration: float, steps: int) -> Loop:
    """The loop whose way in takes ``duration`` times τ, from rest."""
    solid = Viscoelastic(RELAXED, (BRANCH,), (TIME,))
    contact = ViscoelasticContact(heights, surface.size, solid, LAW, control="gap")
    # The start is come to so slowly that it is at rest.
    first = TimeState(contact.first_gap - LAW.equilibrium_distance)
    *_, (solution, now) = steps_in_time(contact, contact.separated(), first, OUT, 1e6 * TIME, 1)
    start, gaps, pressures = now.dissipated, [OUT], [float(solution.pressure.mean())]
    for gap in way(steps):
        *_, (solution, now) = steps_in_time(contact, solution.state, now, gap, duration * TIME / steps, 1)
        if not solution.converged:
            raise RuntimeError(f"T/τ = {duration:g}, gap {gap:.3g} m: {solution.message}")
        gaps.append(gap)
        pressures.append(float(solution.pressure.mean()))
    return Loop(np.array(gaps), np.array(pressures), now.dissipated - start)


def elastic(heights: np.ndarray, surface: Surface, modulus: float, steps: int) -> Loop:
    """The same path on an elastic half-space."""
    contact = rough_contact(heights, surface.size, modulus, LAW, control="gap")
    pressures = [float(solution.pressure.mean()) for solution in walk(contact, [OUT, *way(steps)])]
    return Loop(np.concatenate([[OUT], way(steps)]), np.array(pressures), 0.0)


@styled
def drawn(loops: dict[str, Loop], limits: dict[str, Loop]) -> Figure:
    """Dissipation against duration, and loops between those of the elastic limits."""
    figure = Figure(figsize=(DOUBLE, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    times = [float(name) for name in loops]
    left.loglog(times, [1e3 * found.dissipated for found in loops.values()], "o-", color=COLOURS[0])
    left.set(xlabel="duration of each way over τ", ylabel="dissipated (mJ/m²)")
    for name, style in (("E∞", "k:"), ("E0", "k--")):
        right.plot(1e9 * limits[name].gaps, limits[name].pressures / 1e6, style, label=f"elastic, {name}")
    for name, colour in zip(("0.1", "1", "10"), COLOURS, strict=False):
        right.plot(1e9 * loops[name].gaps, loops[name].pressures / 1e6, color=colour, label=f"T = {name} τ")
    right.set(xlabel="mean gap (nm)", ylabel="mean pressure (MPa)", ylim=(-12, 60))
    right.legend()
    return figure


main = program(
    run,
    STUDY,
    Option("--points", 32, "points along each side"),
    Option("--steps", 32, "steps of time on each way"),
    Option("--figure", Path, "draw dissipation and loops, too"),
)

if __name__ == "__main__":
    sys.exit(main())
