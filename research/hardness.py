"""Contact that yields: area and work against load by hardness, and the solver's work by grid.

The paper's surface on a hard wall with a hardness; `docs/hardness.md` explains the columns.

    python -m research.hardness --figure hardness.png
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from bem_adhesion import Contact, HardWall, Solution, rough_contact
from contact_study.campaign.command_line.command import Parser, guarded
from contact_study.physics.surfaces.surface import Surface
from contact_study.plots.style import COLOURS, DOUBLE, RESOLUTION, readable_decades, styled
from contact_study.study.case import realise
from contact_study.study.study import read_study

MODULUS = 1.0
HARDNESSES = (np.inf, 0.2, 0.1, 0.05, 0.02, 0.01)  # over E*
SHARES = (0.1, 0.3, 0.6, 0.9, 0.99)  # of the hardness
LOADS = (0.001, 0.003, 0.005, 0.008)  # over E*


def main(arguments: Sequence[str] | None = None) -> int:
    return guarded("hardness", lambda: _main(arguments), interrupted="nothing is written")


def parser() -> Parser:
    made = Parser(
        description=__doc__.splitlines()[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter, allow_abbrev=False
    )
    made.add_argument("study", type=Path, nargs="?", default=Path("data/yang2008.toml"), help="study of the surface")
    made.add_argument("--points", type=int, nargs="+", default=[128, 256, 512], help="points along each side")
    made.add_argument("--figure", type=Path, help="draw loading and unloading, too")
    return made


def _main(arguments: Sequence[str] | None) -> int:
    given = parser().parse_args(arguments)
    surface = realise(read_study(given.study).cases[0])
    middle = sorted(given.points)[len(given.points) // 2]
    print("| H/E* | " + " | ".join(f"A at {load:g} E*" for load in LOADS) + f" | yielded at {LOADS[-1]:g} E* |")
    print("|---" * (2 + len(LOADS)) + "|")
    for hardness in HARDNESSES:
        path = loaded(contact_of(surface, middle, hardness), LOADS)
        cells = [f"{np.mean(found.pressure > 0):.4f}" for found in path]
        yielded = path[-1].plastic_indentation
        cells.append("" if yielded is None else f"{np.mean(yielded > 0):.4f}")
        print(f"| {'elastic' if np.isinf(hardness) else f'{hardness:g}'} | " + " | ".join(cells) + " |")
    print("\n| points | " + " | ".join(f"p = {share:g} H" for share in SHARES) + " |\n" + "|---" * 6 + "|")
    for points in given.points:
        cells = []
        for share in SHARES:
            [found] = loaded(contact_of(surface, points, 0.05), [0.05 * share])
            cells.append(f"{found.fft_pairs:.0f}" if found.converged else found.outcome.name)
        print(f"| {points}² | " + " | ".join(cells) + " |")
    if given.figure is not None:
        _draw(given.figure, surface, middle)
        print(given.figure, file=sys.stderr)
    return 0


def contact_of(surface: Surface, points: int, hardness: float) -> Contact:
    """The surface against a half-space of modulus one, with a hardness unless it is infinite."""
    limit = None if np.isinf(hardness) else hardness * MODULUS
    return rough_contact(surface.heights((points, points)), surface.size, MODULUS, HardWall(), hardness=limit)


def loaded(contact: Contact, path: Sequence[float]) -> list[Solution]:
    """The states along a path."""
    state, found = contact.separated(), []
    for pressure in path:
        found.append(contact.step(state, pressure))
        state = found[-1].state
    return found


@styled
def _draw(path: Path, surface: Surface, points: int) -> None:
    figure = Figure(figsize=(DOUBLE, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    up = np.linspace(0.0005, 0.008, 16)
    for number, hardness in enumerate((np.inf, 0.1, 0.05, 0.02)):
        name = "elastic" if np.isinf(hardness) else f"H = {hardness:g} E*"
        there = loaded(contact_of(surface, points, hardness), [*up, *up[-2::-1]])
        areas = [np.mean(found.pressure > 0) for found in there]
        gaps = [np.mean(found.gap) / surface.rms_height for found in there]
        for panel, values in ((left, areas), (right, gaps)):
            panel.plot(up, values[: len(up)], color=COLOURS[number], label=name)
            panel.plot(up[::-1], values[len(up) - 1 :], "--", color=COLOURS[number])
    left.set(xlabel="p/E*", ylabel="relative contact area", ylim=(0, 0.55))
    right.set(xlabel="p/E*", ylabel="mean gap over rms height", yscale="log")
    readable_decades(right.yaxis)
    left.legend(title="dashed: unloading", loc="upper left", ncols=2)
    figure.savefig(path, dpi=RESOLUTION)


if __name__ == "__main__":
    sys.exit(main())
