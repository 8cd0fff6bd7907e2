"""Contact that yields: area and work against load by hardness, and the solver's work by grid.

The paper's surface on a hard wall with a hardness; `research/notes/hardness.md` explains the columns.

    python -m research.hardness --figure hardness.png
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from bem_adhesion import Contact, HardWall, rough_contact
from contact_study.physics.surfaces.surface import Surface
from contact_study.plots.style import COLOURS, DOUBLE, plain_decades, styled
from contact_study.study.case import realise
from contact_study.study.study import read_study
from scripts.harness import STUDY, Option, program, save, show, walk

MODULUS = 1.0
HARDNESSES = (np.inf, 0.2, 0.1, 0.05, 0.02, 0.01)  # over E*
SHARES = (0.1, 0.3, 0.6, 0.9, 0.99)  # of the hardness
LOADS = (0.001, 0.003, 0.005, 0.008)  # over E*


def run(given: argparse.Namespace) -> None:
    surface = realise(read_study(given.study).cases[0])
    middle = sorted(given.points)[len(given.points) // 2]
    rows = []
    for hardness in HARDNESSES:
        path = list(walk(contact_of(surface, middle, hardness), LOADS))
        yielded = path[-1].plastic_indentation
        last = "" if yielded is None else f"{np.mean(yielded > 0):.4f}"
        areas = (f"{np.mean(found.pressure > 0):.4f}" for found in path)
        rows.append(("elastic" if np.isinf(hardness) else f"{hardness:g}", *areas, last))
    show(("H/E*", *(f"A at {load:g} E*" for load in LOADS), f"yielded at {LOADS[-1]:g} E*"), rows)
    rows = []
    for points in given.points:
        states = [next(walk(contact_of(surface, points, 0.05), [0.05 * share])) for share in SHARES]
        rows.append((f"{points}²", *(f"{s.fft_pairs:.0f}" if s.converged else s.outcome.name for s in states)))
    print()
    show(("points", *(f"p = {share:g} H" for share in SHARES)), rows)
    if given.figure is not None:
        save(drawn(surface, middle), given.figure)


def contact_of(surface: Surface, points: int, hardness: float) -> Contact:
    """The surface against a half-space of modulus one, with a hardness unless it is infinite."""
    limit = None if np.isinf(hardness) else hardness * MODULUS
    return rough_contact(surface.heights((points, points)), surface.size, MODULUS, HardWall(), hardness=limit)


@styled
def drawn(surface: Surface, points: int) -> Figure:
    """Area and mean gap on the way in and out."""
    figure = Figure(figsize=(DOUBLE, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    up = np.linspace(0.0005, 0.008, 16)
    for number, hardness in enumerate((np.inf, 0.1, 0.05, 0.02)):
        name = "elastic" if np.isinf(hardness) else f"H = {hardness:g} E*"
        there = list(walk(contact_of(surface, points, hardness), [*up, *up[-2::-1]]))
        areas = [np.mean(found.pressure > 0) for found in there]
        gaps = [np.mean(found.gap) / surface.rms_height for found in there]
        for panel, values in ((left, areas), (right, gaps)):
            panel.plot(up, values[: len(up)], color=COLOURS[number], label=name)
            panel.plot(up[::-1], values[len(up) - 1 :], "--", color=COLOURS[number])
    left.set(xlabel="pressure p/E*", ylabel="relative contact area", ylim=(0, 0.55))
    right.set(xlabel="pressure p/E*", ylabel="mean gap / rms height", yscale="log")
    for panel in (left, right):
        panel.locator_params(axis="x", nbins=5)
    plain_decades(right.yaxis, few=True)
    left.legend(title="dashed: unloading", loc="upper left", ncols=2)
    return figure


main = program(
    run,
    STUDY,
    Option("--points", [128, 256, 512], "points along each side"),
    Option("--figure", Path, "draw loading and unloading, too"),
)

if __name__ == "__main__":
    sys.exit(main())
