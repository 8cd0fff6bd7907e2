"""Charts of the documentation: numbers of a table as bars and lines, and boxes with arrows between them."""

import csv
import re
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from contact_study.plots.style import COLOURS

ROOT = Path(__file__).resolve().parent.parent
SOLID = "#cfe3f5"


def row_of_axes(width: float = 7.0, height: float = 2.8, columns: int = 1) -> tuple[Figure, np.ndarray]:
    """Make a figure with panels side by side, its size in inches."""
    made = Figure(figsize=(width, height), layout="constrained")
    return made, made.subplots(1, columns, squeeze=False)[0]


def waterfall() -> Figure:
    """Changes of the contact area from the continuum to the atoms, from the table of the notes."""
    text = (ROOT / "research" / "notes" / "continuum_against_atoms.md").read_text(encoding="utf-8")
    block = text[text.index("\n1 GPa\n") :]
    names, changes = [], []
    for line in block[: block.index("| **atoms")].splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        found = [re.search(r"\(([-+][\d.]+) %\)", cell) for cell in cells[1:4]]
        if len(cells) == 7 and all(found):
            names.append(cells[0])
            changes.append([float(one[1]) for one in found])
    short = ("modulus", "cut-off", "dispersion", "minimiser", "tilt", "pairs", "lateral freedom")
    made, (axes,) = row_of_axes(width=5.6, height=2.8)
    table = np.array(changes)
    for number, (name, colour) in enumerate(zip(("ε₀", "4 ε₀", "8 ε₀"), COLOURS, strict=False)):
        below = np.concatenate([[0], np.cumsum(table[:, number])])
        place = np.arange(len(table)) + 0.26 * (number - 1)
        axes.bar(place, table[:, number], 0.24, bottom=below[:-1], color=colour, label=name)
    axes.set_xticks(range(len(table)), short[: len(table)], rotation=25, ha="right")
    axes.axhline(0, color="black", linewidth=0.6)
    axes.set_ylabel("change of contact area (%)")
    axes.set_title("continuum → atoms, 1 GPa, cumulative")
    axes.legend()
    return made


def performance() -> Figure:
    with (ROOT / "data" / "benchmark_grids.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    made, (left, right) = row_of_axes(columns=2)
    for kind, colour in zip(dict.fromkeys(row["kind"] for row in rows), COLOURS, strict=False):
        own = [row for row in rows if row["kind"] == kind]
        points = [int(row["points"]) for row in own]
        left.loglog(points, [float(row["seconds"]) for row in own], "o-", color=colour, markersize=3, label=kind)
        memory = [float(row["bytes"]) * int(row["points"]) ** 2 / 1e9 for row in own]
        right.loglog(points, memory, "o-", color=colour, markersize=3)
    for axes in (left, right):
        axes.set_xticks(points, [str(number) for number in points])
        axes.minorticks_off()
    left.set(xlabel="points a side", ylabel="two load steps, one core (s)")
    right.set(xlabel="points a side", ylabel="memory (GB)")
    left.legend()
    return made


def _chart(
    boxes: dict[str, tuple[float, float, str]], ways: list[tuple[str, str, str]], size: tuple[float, float]
) -> Figure:
    """Boxes by name with their centres and texts, and arrows between them with a word each."""
    made, (axes,) = row_of_axes(*size)
    axes.set(xlim=(0, 10), ylim=(0, 10))
    axes.axis("off")
    drawn = {}
    for name, (x, y, text) in boxes.items():
        colour = "#fff3d6" if text.endswith("?") else SOLID
        style = {"boxstyle": "round,pad=0.45", "facecolor": colour, "edgecolor": "0.5", "linewidth": 0.6}
        drawn[name] = axes.text(x, y, text, ha="center", va="center", bbox=style).get_bbox_patch()
    for start, end, word in ways:
        (x, y, _), (to_x, to_y, _) = boxes[start], boxes[end]
        bend = 0.9 if (end, start) in [way[:2] for way in ways] and y < to_y else 0.0
        arrow = {"arrowstyle": "->", "color": "0.4", "patchA": drawn[start], "patchB": drawn[end], "shrinkA": 1}
        arrow |= {"shrinkB": 1, "connectionstyle": f"arc3,rad={bend}"}
        axes.annotate("", (to_x, to_y), (x, y), arrowprops=arrow)
        place = {"fontsize": 7, "color": "0.3", "ha": "center", "va": "center"}
        beside = 0.45 * bend * (to_y - y)
        axes.text((x + to_x) / 2 + beside, (y + to_y) / 2, word, **place, backgroundcolor="white" if word else "none")
    return made


def choosing_tree() -> Figure:
    """Questions that lead to a model."""
    boxes = {
        "spectrum": (1.6, 9.0, "spectrum only?"),
        "theory": (1.6, 6.2, "persson-theory"),
        "lattice": (4.4, 9.0, "lattice or\ntemperature?"),
        "atoms": (4.4, 6.2, "md-reference"),
        "adhesion": (7.2, 9.0, "adhesion?"),
        "wall": (9.1, 6.2, 'law =\n"hard_wall"'),
        "soft": (6.6, 4.0, "soft or large\nbody?"),
        "auto": (4.2, 1.2, 'law = "exponential"\nlength = "auto"'),
        "atomic": (8.4, 1.2, "law and range of\nthe interaction"),
    }
    ways = [
        ("spectrum", "theory", "yes"),
        ("spectrum", "lattice", "no"),
        ("lattice", "atoms", "yes"),
        ("lattice", "adhesion", "no"),
        ("adhesion", "wall", "no"),
        ("adhesion", "soft", "yes"),
        ("soft", "auto", "yes"),
        ("soft", "atomic", "no"),
    ]
    return _chart(boxes, ways, (6.4, 3.6))


def load_step() -> Figure:
    """States of a load step of the adhesive solver."""
    boxes = {
        "guess": (1.3, 8.8, "coarse grids\npredict"),
        "newton": (5.0, 8.8, "Newton step"),
        "balance": (5.0, 5.6, "in balance?"),
        "saddle": (5.0, 2.4, "negative\ncurvature?"),
        "done": (8.8, 2.4, "converged"),
        "apart": (8.8, 8.8, "detached"),
        "flag": (8.8, 5.6, "not converged"),
        "leave": (1.3, 2.4, "leave the\nsaddle downhill"),
    }
    ways = [
        ("guess", "newton", ""),
        ("newton", "balance", ""),
        ("balance", "newton", "no"),
        ("balance", "saddle", "yes"),
        ("balance", "flag", "limit reached"),
        ("saddle", "done", "no"),
        ("saddle", "leave", "yes"),
        ("leave", "newton", ""),
        ("newton", "apart", "all past the peak"),
    ]
    return _chart(boxes, ways, (6.4, 3.2))
